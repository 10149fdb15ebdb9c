"""A flight as a log has it, made by equations: rest, a push along x, and a cruise whose airspeed waves a little.

With V(t) given, level, in still air: f_x = V̇ while flying, Δp by the isentropic law at V, and p_s the field's.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.logs import Recording, Series

Array = NDArray[np.float64]

G = 9.80665  # m/s²
FIELD, WARM = 99_000.0, 285.0  # Pa, K
PUSH, LAUNCH, LASTED = 7.0 * G, 5.0, 0.35  # m/s², s, s: 24 m/s
WAVE, OMEGA = 1.5, 0.9  # m/s, rad/s, of the airspeed in cruise


@dataclass(frozen=True)
class Made:
    """A recording and what is true of it."""

    recording: Recording
    t: Array
    airspeed: Array

    def at(self, t: Array) -> Array:
        """True airspeed, m/s."""
        return np.interp(t, self.t, self.airspeed)


def made(
    *,
    end: float = 14.0,
    begin: float = 0.0,
    rate: float = 250.0,
    head_rate: float = 100.0,
    noise: float = 2.0,
    differential: bool = True,
    offset: float = 12.0,
    shift: float = 0.0,
    seed: int = 1,
    reference: bool = False,
) -> Made:
    """Make one.

    Parameters
    ----------
    begin, end
        Of the log, s; the launch is at 5 s.
    rate, head_rate
        Hz.
    noise
        Of each pressure, Pa.
    differential
        Whether the total channel is a difference.
    offset
        What it is off by, Pa.
    shift
        By how much the head's clock is later, s.
    reference
        Whether the log has the true airspeed.
    """
    random = np.random.default_rng(seed)
    t = np.arange(0.0, end, 1.0 / rate)
    gone = np.clip(t - LAUNCH - LASTED, 0.0, None)
    speed = np.clip(t - LAUNCH, 0.0, LASTED) * PUSH + WAVE * np.sin(OMEGA * gone)
    along = np.gradient(speed, 1.0 / rate) + random.normal(0.0, 0.5, t.size)
    readings = np.column_stack([t, along, random.normal(0.0, 0.5, t.size), -G + random.normal(0.0, 0.5, t.size)])
    at = np.arange(0.0, end, 1.0 / head_rate) + 0.0007
    true = np.interp(at, t, speed)
    mach = true / airdata.speed_of_sound(WARM)
    impact = airdata.total_pressure(static=FIELD, mach=mach) - FIELD
    static = FIELD + random.normal(0.0, noise, at.size)
    total = impact + offset + random.normal(0.0, noise, at.size) + (0.0 if differential else FIELD)
    keep, held = t >= begin, at >= begin
    series = {"p_static": static, "temperature": np.full(at.size, WARM)}
    series |= {"p_difference" if differential else "p_total": total}
    found = {name: Series(name, at[held] + shift, values[held], f"made.csv: {name}") for name, values in series.items()}
    if reference:
        found["airspeed_reference"] = Series("airspeed_reference", t[keep], speed[keep], "made.csv: truth")
    return Made(Recording(("made.csv",), "", readings[keep], (), found), t, speed)
