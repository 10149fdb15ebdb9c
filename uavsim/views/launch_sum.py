"""What a detector without windows holds against its limit, found again from the readings; drawn below the force.

A detector sees nothing but readings, so that the same one over the same readings has the same state at every sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from uavsim.truth import STANDARD_GRAVITY
from uavsim.views.figure import BLUE, RED, label
from uavsim.views.record import Array, Record, Stretch, within

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from uavsim.onboard.launch import DetectorSettings

G_MS = 1e-3 * STANDARD_GRAVITY  # m/s in 1 g·ms
HOLDS = ("single-threshold", "double-threshold")
HEIGHTS: dict[str, tuple[float, ...]] = {"adaptive-cusum": (1.3, 0.8)} | dict.fromkeys(("cusum", *HOLDS), (1.3,))


@dataclass(frozen=True, slots=True)
class Held:
    """A detector's state, a row a sample; NaN between recognition and the next reset.

    Attributes
    ----------
    t
        Time, s.
    value, limit
        The sum and its limit, g·ms, or the time held and the one to be held, ms.
    roughness
        Of the force, g; NaN where the kind has none.
    recognised
        Samples at which the launch was.
    """

    t: Array
    value: Array
    limit: Array
    roughness: Array
    recognised: NDArray[np.bool_]


def held(record: Record, until: float) -> Held:
    """Let the scenario's detector read what it read in flight, until a time in s."""
    from sensors.mounting import attitude, linear
    from uavsim.onboard.launch import build

    scenario = record.scenario
    detector: Any = build(scenario.detector, scenario.accelerometer.description().rate)
    turn = linear(attitude(*scenario.accelerometer.mounting_deg))
    readings = np.column_stack([record.column("accelerometer", name) for name in ("t", "fx", "fy", "fz")])
    rearmed, rows, asleep = record.times("rearmed"), [], False  # asleep: after recognition nothing is added
    for t, *force in readings[readings[:, 0] <= until].tolist():
        seen = detector.step(t, *(force if turn is None else turn(*force)))
        rows.append((t, *((np.nan,) * 3 if asleep else _state(detector, scenario.detector)), seen))
        asleep |= seen
        if rearmed and t >= rearmed[0]:
            rearmed.pop(0)
            detector.reset()
            asleep = False
    t, value, limit, roughness, recognised = np.array(rows, float).reshape(-1, 5).T
    return Held(t, value, limit, roughness, recognised > 0.0)


def _state(detector: Any, settings: "DetectorSettings") -> tuple[float, float, float]:
    if settings.kind in HOLDS:
        return 1e3 * detector.held, 1e3 * settings.window, np.nan
    if settings.kind == "cusum":
        return detector.sum / G_MS, settings.cusum.limit / G_MS, np.nan
    return detector.sum / G_MS, detector.limit / G_MS, detector.roughness / STANDARD_GRAVITY


def draw_held(column: "Sequence[Axes]", kind: str, state: Held, stretch: Stretch, origin: float) -> None:
    """Draw the sum or the time held against its limit, and the roughness that the limit follows."""
    names = ("time held", "time to be held", "held, ms") if kind in HOLDS else ("sum S", "limit h", "S, g·ms")
    t, value, limit, roughness, seen = within(
        stretch, state.t, state.value, state.limit, state.roughness, state.recognised.astype(float)
    )
    x = 1e3 * (t - origin)
    column[0].plot(x, value, color=BLUE, linewidth=1.0, marker=".", markersize=3.5, label=names[0])
    column[0].plot(x, limit, color=RED, linewidth=1.0, linestyle="--", label=names[1])
    if seen.any():
        column[0].plot(x[seen > 0.0], value[seen > 0.0], "o", color=RED, markersize=6, label="recognised")
    column[0].set_ylim(bottom=0.0)
    label(column[0], names[2])
    for axes in column[1:]:
        axes.plot(x, roughness, color=BLUE, linewidth=1.0, label="roughness r of $f_x$")
        axes.set_ylim(bottom=0.0)
        label(axes, "r, g")
