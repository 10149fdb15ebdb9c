"""What the figures of a sweep share: names and units, axes of a key, which cells are shown."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.campaign.sweep import OUTCOME, Sweep
from uavsim.studies.campaign.vary import Varied, as_text, told
from uavsim.views.figure import BLACK, BLUE, GREEN, ORANGE, PURPLE, literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Line = NDArray[np.int_]

COLOURS = (BLUE, ORANGE, GREEN, PURPLE, BLACK)
LOGARITHMIC = 8.0  # ratio of the greatest to the least value from which an axis is logarithmic
NAMES = {
    "launch.latency": ("latency", "ms", 1e3),
    "launch.latency_from_crossing": ("latency after 4.5 g", "ms", 1e3),
    "airspeed.rmse": ("RMSE of the airspeed", "m/s", 1.0),
    "airspeed.cruise.rmse": ("RMSE of the airspeed in cruise", "m/s", 1.0),
    "flight.rail_exit_speed": ("airspeed off the rail", "m/s", 1.0),
    "flight.cruise_airspeed": ("airspeed in cruise", "m/s", 1.0),
    OUTCOME: ("flights as expected", "%", 100.0),
}
"""What a number of the score is called, its unit, and the factor from SI."""


def named(key: str) -> tuple[str, str, float]:
    """What a number is called, its unit and the factor to it; a number without a name of its own is its key."""
    return NAMES.get(key, (key, "", 1.0))


def with_unit(key: str) -> str:
    """Name and unit of a number, for an axis."""
    name, unit, _ = named(key)
    return f"{literal(name)}, {unit}" if unit else literal(name)


@dataclass(frozen=True)
class Scale:
    """Where the values of a key stand on an axis: at their numbers, or one after another with their names."""

    key: str
    places: Array
    ticks: tuple[str, ...]
    numeric: bool
    log: bool

    def dress(self, axes: "Axes") -> None:
        """Scale an axis and mark the values."""
        if self.log:
            axes.set_xscale("log")
        axes.minorticks_off()
        axes.set_xticks(self.places, [literal(tick) for tick in self.ticks])
        if not self.numeric:
            axes.tick_params(axis="x", labelrotation=20 if max(map(len, self.ticks)) > 12 else 0)
        low, high = float(self.places.min()), float(self.places.max())
        if self.log:
            share = (high / low) ** 0.05
            axes.set_xlim(low / share, high * share)
        else:
            margin = 0.05 * (high - low) if self.numeric and high > low else 0.5
            axes.set_xlim(low - margin, high + margin)


def scale_of(one: Varied) -> Scale:
    """Return the axis of a key: a line of numbers where all values are, names one after another where not."""
    if one.numeric and len(one.choices) > 1:
        numbers = np.sort(np.array(one.labels, dtype=np.float64))
        log = bool(numbers[0] > 0.0 and numbers[-1] >= LOGARITHMIC * numbers[0])
        return Scale(one.key, numbers, tuple(f"{number:.4g}" for number in numbers), True, log)
    ticks = tuple(value_text(value) for value in one.labels)
    return Scale(one.key, np.arange(len(ticks), dtype=np.float64), ticks, False, False)


def title(found: Sweep, what: str) -> str:
    """Return a figure's title."""
    return f"{found.scenario.name}: {what}"


def flights(found: Sweep) -> str:
    """Say how many flights there are in a cell, and which."""
    least, most = int(found.table["flights"].min()), int(found.table["flights"].max())
    count = f"{most}" if least == most else f"{least} to {most}"
    return f"{count} flights a cell, the same draws in all, seed {found.scenario.seed}"


def line_of(found: Sweep, axis: int) -> Line:
    """The line of cells along a key in which the other keys are those of the reference."""
    return next(line for line in found.lines(axis) if found.reference in line)


def series(found: Sweep, axis: int) -> list[tuple[str, str, Line]]:
    """Lines of cells to draw along a key, a value of one other key each if there are few: name, colour, cells."""
    lines, others = list(found.lines(axis)), [one for i, one in enumerate(found.varies) if i != axis]
    if len(others) != 1 or len(lines) > len(COLOURS):
        return [("", BLUE, line_of(found, axis))]
    key = others[0].key
    return [
        (f"{brief_key(found, key)} {value_text(found.labels[line[0]][f'vary.{key}'])}", colour, line)
        for line, colour in zip(lines, COLOURS, strict=False)
    ]


def brief_key(found: Sweep, key: str) -> str:
    """Return as many of the last parts of a key as tell it from the other ones that are varied."""
    parts = key.split(".")
    others = [one.key.split(".") for one in found.varies if one.key != key]
    for count in range(1, len(parts)):
        if all(other[-count:] != parts[-count:] for other in others):
            return ".".join(parts[-count:])
    return key


def value_text(value: Any) -> str:
    """Write a label of a cell."""
    return f"{value:.5g}" if isinstance(value, float) else short(as_text(value), 24)


def short(text: str, longest: int) -> str:
    """Return a text without its end if it is too long."""
    return text if len(text) <= longest else f"{text[: longest - 1]}…"


def moved(found: Sweep, *first: str) -> tuple[str, ...]:
    """Numbers of the score that are not the same in all cells, after those given of which it is true."""
    return tuple(key for key in (*first, *found.quantities) if not found.alike(key))


def alike(found: Sweep) -> str:
    """Say which numbers of the score are the same in all cells, and so are not drawn."""
    same = [named(key)[0] for key in (OUTCOME, *found.quantities) if found.alike(key)]
    return f"; the same in every cell: {', '.join(same)}" if same else ""


def beside(found: Sweep, axes: tuple[int, ...]) -> str:
    """Say what the keys are that a figure does not show."""
    others = {one.key: found.cells[found.reference][one.key] for i, one in enumerate(found.varies) if i not in axes}
    return f"; {told(others)}" if others else ""


def plane_of(found: Sweep, across: int, up: int) -> Line:
    """Numbers of the cells over two keys, shape (values of up, values of across), others as in the reference."""
    shape = tuple(len(one.choices) for one in found.varies)
    at = np.unravel_index(found.reference, shape)
    grid = np.arange(len(found.cells)).reshape(shape)
    chosen = grid[tuple(slice(None) if i in {across, up} else int(at[i]) for i in range(len(shape)))]
    plane = chosen.T if across < up else chosen
    for turned, axis in ((1, across), (0, up)):
        if found.varies[axis].numeric:
            plane = np.take(plane, np.argsort(found.varies[axis].labels), axis=turned)
    return plane
