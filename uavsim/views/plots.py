"""One flight's plots: launch, pressure, airspeed, trajectory, track; of a centrifuge its run.

What a recording or a rig lacks is left out. Equal flights give equal files, byte for byte, with equal versions of
matplotlib.
"""

from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.views import airspeed, centrifuge, launch, pressure, track, trajectory
from uavsim.views.figure import save
from uavsim.views.record import Record

if TYPE_CHECKING:
    from uavsim.flight import Flight

FIGURES = {
    "launch": launch.draw,
    "centrifuge": centrifuge.draw,
    "pressure": pressure.draw,
    "airspeed": airspeed.draw,
    "trajectory": trajectory.draw,
    "track": track.draw,
}


def save_plots(flight: "Flight", folder: Path) -> list[Path]:
    """Draw a flight.

    Parameters
    ----------
    folder
        Made with its parents.

    Returns
    -------
    list of Path
        Those of `launch.png`, `centrifuge.png`, `pressure.png`, `airspeed.png`, `trajectory.png` and `track.png` for
        which there are data.
    """
    folder.mkdir(parents=True, exist_ok=True)
    record = Record(flight)
    drawn = ((name, draw(record)) for name, draw in FIGURES.items())
    return [save(figure, folder / f"{name}.png") for name, figure in drawn if figure is not None]
