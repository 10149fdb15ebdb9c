"""`uavsim replay` of a log that is read in parts: one of gigabytes, or one that is cut into its flights."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.cli.common import Bar

if TYPE_CHECKING:
    from uavsim.flight import Flight
    from uavsim.logs import Recording
    from uavsim.onboard.launch import DetectorSettings

PASSES = 0.9  # share of the progress that two passes over the log take; the rest is what is made of a stretch


def in_lots(
    logs: list[Path],
    mapping: str | None,
    detector: "DetectorSettings | None",
    made: "Callable[[Recording], Flight]",
    folder: Path,
    *,
    all_launches: bool,
    plots: bool,
) -> "Flight":
    """Replay a log in parts, write its folder, and return what is to be told; ValueError if the log is wrong."""
    from uavsim.logs import Stream, replay_long
    from uavsim.onboard.launch import DetectorSettings

    with Bar("replay") as bar:
        stream = Stream(logs, mapping)
        settings = DetectorSettings() if detector is None else detector
        replayed = replay_long(stream, settings, made, folder, lambda share: bar.show(PASSES * share))
        spans = replayed.spans if all_launches else []
        for number, span in enumerate(spans):
            bar.show(PASSES + (1.0 - PASSES) * number / len(spans))
            flight = made(stream.between(*span))
            place = folder / "flights" / f"{number:04}"
            place.mkdir(parents=True)
            flight.write(place, _drawn(flight) if plots else None)
    if all_launches:
        replayed.flight.score["recording"]["flights"] = [
            {"folder": f"flights/{number:04}", "start": start, "end": end} for number, (start, end) in enumerate(spans)
        ]
    replayed.write(folder, _drawn(replayed.flight) if plots else None)
    return replayed.flight


def _drawn(flight: "Flight") -> Callable[[Path], None]:
    from uavsim.views import log as view

    def draw(folder: Path) -> None:
        view.save_plot(flight, folder / "plots")

    return draw
