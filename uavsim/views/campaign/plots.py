"""All figures of many flights."""

from pathlib import Path

from uavsim.studies.batch import Batch
from uavsim.studies.campaign.many import Many, many
from uavsim.views.campaign import (
    consistency,
    convergence,
    distributions,
    errors,
    latency,
    outcomes,
    overlay,
)
from uavsim.views.figure import save

FIGURES = {
    "outcomes": outcomes.draw,
    "latency": latency.draw,
    "distributions": distributions.draw,
    "airspeed_error": errors.draw,
    "consistency": consistency.draw,
    "flights": overlay.draw,
    "convergence": convergence.draw,
}
"""By the name of the file: what draws it, or returns None where there is nothing to draw."""


def save_many_plots(flown: Batch | Many, folder: Path) -> list[Path]:
    """Draw many flights into a folder, which is made.

    Returns
    -------
    list of Path
        Those of `FIGURES`, as PNG, for which there are data.
    """
    folder.mkdir(parents=True, exist_ok=True)
    drawn = many(flown)
    written = []
    for name, draw in FIGURES.items():
        figure = draw(drawn) if len(drawn) else None
        if figure is not None:
            written.append(save(figure, folder / f"{name}.png"))
    return written
