"""Calibrated and equivalent airspeed beside the true one, of the truth and of an estimate.

    V_c = a₀·M(q_c/p₀),    V_e = a₀·M(q_c/p_s)·√(p_s/p₀)             `airdata.calibrated`; q_c = p_t − p_s

The truth has both pressures. So has an estimate of ours: the pair that it tells is the pair of the airspeed that it
tells, V̂ = K·a(T)·M, so M·K is its Mach number whatever the thermometer reads. An estimator of somebody else's may tell
nothing but an airspeed; its Mach number is M = V̂/a(T) with the thermometer's last reading and the humidity of the
place's air.

Where there are no such pressures (beyond Mach 1, after a flight has diverged, before the first reading) both are NaN.
They are derived after the flight: the loop does not pay for them.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.flight import DERIVED
from uavsim.onboard.airspeed.kinds import KINDS
from uavsim.plants.air.weather import at_ground

if TYPE_CHECKING:
    from uavsim.scenario import Scenario

Array = NDArray[np.float64]


class Airspeeds(NamedTuple):
    """One value a row, m/s; NaN where there is none."""

    calibrated: Array
    equivalent: Array

    def columns(self) -> dict[str, Array]:
        """As a table has them."""
        return dict(zip(DERIVED, self, strict=True))


def of_pressures(total: Array, static: Array, calibration: float = 1.0) -> Airspeeds:
    """Return the airspeeds of two pressures, Pa; `calibration` multiplies the Mach number that they have."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        ratio = np.where((total > 0.0) & (static > 0.0), total / static, np.nan)
    ratio = np.where(ratio <= airdata.total_pressure(static=1.0, mach=1.0), ratio, np.nan)
    mach = np.full(ratio.shape, np.nan)
    there = np.isfinite(ratio)
    mach[there] = airdata.mach(total=ratio[there], static=np.ones(int(there.sum())))
    return of_mach(calibration * mach, static)


def of_mach(mach: Array, static: Array) -> Airspeeds:
    """Return the airspeeds at a Mach number and a static pressure, Pa."""
    calibrated, equivalent = np.full(mach.shape, np.nan), np.full(mach.shape, np.nan)
    there = (mach >= 0.0) & (mach <= 1.0) & (static > 0.0) & np.isfinite(static)
    m, p = mach[there], static[there]
    calibrated[there] = airdata.calibrated_from_mach(mach=m, static=p)
    equivalent[there] = airdata.STANDARD_SPEED_OF_SOUND * m * np.sqrt(p / airdata.STANDARD_PRESSURE)
    return Airspeeds(calibrated, equivalent)


def of_estimate(estimate: Mapping[str, Any], readings: Mapping[str, Any], scenario: "Scenario") -> Airspeeds:
    """Return the airspeeds of an estimate's rows.

    Parameters
    ----------
    estimate, readings
        The tables 'estimate' and 'air_data', columns by name.
    scenario
        What was flown.
    """
    true, static = (np.asarray(estimate[name], dtype=float) for name in ("airspeed", "p_static"))
    kind = scenario.estimator.kind
    if kind in KINDS and KINDS[kind].ours:
        total = np.asarray(estimate["p_total"], dtype=float)
        found = of_pressures(total, static, scenario.estimator.calibration)
    else:
        sound = _sound(np.asarray(estimate["t"], dtype=float), readings, scenario)
        found = of_mach(true / sound, static)
    still = true == 0.0  # under its cover an estimator tells 0 whatever the noise of the pressures is
    return Airspeeds(*(np.where(still & (static > 0.0), 0.0, np.where(np.isnan(true), np.nan, one)) for one in found))


def _sound(time: Array, readings: Mapping[str, Any], scenario: "Scenario") -> Array:
    """Speed of sound, m/s, by the thermometer's last reading; that of the standard atmosphere before the first."""
    stamps, warm = (np.asarray(readings.get(name, ()), dtype=float) for name in ("t", "temperature"))
    use = np.isfinite(stamps) & (warm >= airdata.MIN_TEMPERATURE) & (warm <= airdata.MAX_TEMPERATURE)
    temperature = np.full(time.shape, airdata.STANDARD_TEMPERATURE)
    if use.any():
        at = np.searchsorted(stamps[use], time, side="right") - 1
        temperature = np.where(at >= 0, warm[use][np.maximum(at, 0)], temperature)
    vapour = at_ground(scenario.environment).vapour_fraction
    lightness = float(
        airdata.airspeed(total=1.01, static=1.0, temperature=airdata.STANDARD_TEMPERATURE, vapour_fraction=vapour)
        / airdata.airspeed(total=1.01, static=1.0, temperature=airdata.STANDARD_TEMPERATURE)
    )
    return np.asarray(airdata.speed_of_sound(temperature) * lightness, dtype=float)
