"""What a detector holds against its limit, found again from the readings; drawn below the force.

A detector sees nothing but readings, so that the same one over the same readings has the same state at every sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.launch.kinds import Kind, Panel
from uavsim.views.figure import BLUE, RED, label, literal
from uavsim.views.record import Array, Record, Stretch, within

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CURVE: dict[str, Any] = {"color": BLUE, "linewidth": 1.0}
DOTS: dict[str, Any] = {"marker": ".", "markersize": 3.5}
LIMIT: dict[str, Any] = {"color": RED, "linewidth": 1.0, "linestyle": "--"}


@dataclass(frozen=True, slots=True)
class State:
    """A detector's state, a row a sample; NaN between recognition and the next reset.

    Attributes
    ----------
    t
        Time, s.
    columns
        By the attributes' names, in their own units.
    recognised
        Samples at which the launch was.
    """

    t: Array
    columns: dict[str, Array]
    recognised: NDArray[np.bool_]


def panels_of(kind: Kind) -> tuple[Panel, ...]:
    """Panels that a kind asks for; the words of one that is not ours are drawn as they are written."""
    if kind.ours:
        return kind.panels
    return tuple(
        replace(panel, label=literal(panel.label), curves=tuple((literal(name), of) for name, of in panel.curves))
        for panel in kind.panels
    )


def read_again(record: Record, panels: Sequence[Panel], until: float) -> State:
    """Let the scenario's detector read what it read in flight, until a time in s."""
    from sensors.mounting import attitude, linear
    from uavsim.onboard.launch import build

    scenario = record.scenario
    names = list(dict.fromkeys(attribute for panel in panels for _, attribute in panel.curves))
    detector: Any = build(scenario.detector, scenario.accelerometer.description().rate)
    turn = linear(attitude(*scenario.accelerometer.mounting_deg))
    readings = np.column_stack([record.column("accelerometer", name) for name in ("t", "fx", "fy", "fz")])
    rearmed, rows, asleep = record.times("rearmed"), [], False  # asleep: after recognition nothing is added
    for t, *force in readings[readings[:, 0] <= until].tolist():
        seen = detector.step(t, *(force if turn is None else turn(*force)))
        rows.append((t, *(np.nan if asleep else getattr(detector, name, np.nan) for name in names), seen))
        asleep |= seen
        if rearmed and t >= rearmed[0]:
            rearmed.pop(0)
            detector.reset()
            asleep = False
    t, *columns, recognised = np.array(rows, float).reshape(-1, len(names) + 2).T
    return State(t, dict(zip(names, columns, strict=True)), recognised > 0.0)


def draw_panels(
    column: "Sequence[Axes]", panels: Sequence[Panel], state: State, stretch: Stretch, origin: float
) -> None:
    """Draw what each panel shows: its first curve, and a second as the limit of the first."""
    for first, (axes, panel) in enumerate(zip(column, panels, strict=True)):
        names = [attribute for _, attribute in panel.curves]
        t, seen, *values = within(
            stretch, state.t, state.recognised.astype(float), *(state.columns[name] / panel.scale for name in names)
        )
        x = 1e3 * (t - origin)
        for i, ((name, _), value) in enumerate(zip(panel.curves, values, strict=True)):
            curve = CURVE | ({} if first else DOTS)
            style = LIMIT if i else curve
            axes.plot(x, value, label=name, **style)
        if seen.any() and not first:
            axes.plot(x[seen > 0.0], values[0][seen > 0.0], "o", color=RED, markersize=6, label="recognised")
        lowest = np.nanmin(values[0]) if np.isfinite(values[0]).any() else 0.0
        if lowest >= 0.0:
            axes.set_ylim(bottom=0.0)
        label(axes, panel.label)
