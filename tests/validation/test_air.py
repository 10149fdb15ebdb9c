"""The turbulence over 6000 s at 1 kHz, at 3 heights and 3 airspeeds, and aloft; it prints what it measures.

Authority and method are those of tests/plants/air/test_air_turbulence.py: the printed spectra, folded, all comparisons
one family that is held at 1 % by Holm's step-down. Each fourth row is analysed, which is the same process at 250 Hz.
6000 s at 60 m and 32 m/s hold 870 independent values of u, so one variance is known to ±10 % (2 standard deviations);
that of p, q and r to 1 %. Seen nine times in ten, 5.8 standard deviations of one comparison: 28 % of that variance of
u, 3 % of those of p, q and r, 9 % of a density at 1 Hz, 3 % at 10 Hz.
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from references import dryden as specification
from references.dryden import FOOT, GUSTS, Finding

from uavsim.plants.air import moving
from uavsim.plants.air.moving import MovingAir, State
from uavsim.plants.air.settings import EnvironmentSettings

pytestmark = [pytest.mark.slow, pytest.mark.certify]

Array = NDArray[np.float64]
HEIGHTS, SPEEDS = (5.0, 60.0, 250.0), (8.0, 32.0, 90.0)  # m, m/s
SPAN, W20 = 2.0, 8.0  # m, m/s
RATE, LENGTH, EACH = 1000.0, 6000.0, 4  # Hz, s
SEVERITY, SD_ALOFT = 4, 10.6 * FOOT  # MIL-F-8785C, figure 7, at 3750 ft
BLOCK = 10.0  # s


def recorded(monkeypatch: pytest.MonkeyPatch, height: float, speed: float, seed: int) -> Array:
    """Every fourth row of u, v, w, p, q, r while height and airspeed stay."""
    monkeypatch.setattr(moving, "AHEAD", BLOCK)
    environment = EnvironmentSettings(
        turbulence_wind_20ft=W20, wind_from_deg=180.0, turbulence_severity=SEVERITY
    )  # its axis is north, and the aircraft heads there
    air = MovingAir(environment, 0.0, SPAN, RATE, round(LENGTH * RATE), seed)
    state = State(height, 0.0, speed, 0.0, 0.0, 0.0)
    blocks = round(LENGTH / BLOCK)
    return np.concatenate([air.ahead(state)[::EACH, :6].copy() for _ in range(blocks)])


def compared(values: Array, air: specification.Air, speed: float) -> list[Finding]:
    law = {name: specification.in_time(s, speed) for name, s in specification.spatial(air, SPAN).items()}
    pitch, yaw = (specification.turned(speed, SPAN, factor) for factor in (4.0, 3.0))
    crossed = {
        "wq": lambda omega: -pitch(omega) * law["w"](np.abs(omega)),
        "vr": lambda omega: yaw(omega) * law["v"](np.abs(omega)),
    }
    return specification.judged(values, law, crossed, EACH / RATE)


def row(name: str, found: list[Finding]) -> str:
    """Return a line of the table: variance over the law's, with its standard deviation, of all six."""
    by = {f.name: f for f in found}
    cells = [f"{by[f'variance of {g}'].ratio:5.3f} ± {by[f'variance of {g}'].sd:.3f}" for g in GUSTS]
    slopes = max(abs(by[f"slope of {g}"].ratio) for g in GUSTS)
    densities = [abs(f.ratio - 1.0) / f.sd for f in found if f.name.startswith("density")]
    crossed = [abs(f.ratio) / f.sd for f in found if "cross" in f.name]
    return f"{name:>14} | {' | '.join(cells)} | {slopes:5.3f} | {max(densities):4.1f} | {max(crossed):4.1f}"


def test_six_thousand_seconds(monkeypatch: pytest.MonkeyPatch, table: Callable[[str], None]) -> None:
    table("turbulence over 6000 s, variance over that of the law ± its standard deviation; greatest error of a slope,")
    table("greatest deviation of a density and of a cross-spectrum, in standard deviations")
    table(f"{'height, speed':>14} | " + " | ".join(f"{name:^13}" for name in GUSTS) + " | slope | dens | cross")
    found = []
    cases = [(h, v, specification.low(h, W20)) for h in HEIGHTS for v in SPEEDS]
    cases.append((3750.0 * FOOT, 32.0, specification.high(SD_ALOFT)))
    for height, speed, air in cases:
        values = recorded(monkeypatch, height, speed, seed=round(100 * height + speed))
        here = compared(values, air, speed)
        table(row(f"{height:.0f} m, {speed:.0f} m/s", here))
        found += here
    least = min(found, key=lambda f: f.p)
    table(f"{len(found)} comparisons; the least probable: {least.name}, p = {least.p:.1e}")
    assert specification.holm(found) == []
