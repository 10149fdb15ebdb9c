"""A wind tunnel as a rig: an open jet into a room, with a head that is held in it.

What is set is a polygon s(t): 0 until the wait is over, then each value after the other, reached over a ramp (0: at
once) and held. The mean stream follows with a lag, and turbulence is a first-order process along it (Dryden's
longitudinal spectrum) whose correlation time is its length over the speed:

    v + τ v' = s(t)                V = v (1 + I x),   x' = -(v/L) x + √(2v/L) w,   E x² = 1

w is white noise of unit density, drawn from the run's seed. x stands still where the air does. With Mach numbers it is
M that follows. The air comes from the room without loss or heat, and the jet has the room's pressure:

    T = T_0 - V²/(2 c_p),   T_0 = T_room + drift t        p_s = p_room        p_t = p_s (1 + M²/5)^3.5

so p_t is above the room's pressure by what the fan gives. That a static port reads less is an error of the port, not of
the tunnel, and stands with the probe (`air_data.static_port`).

The head stands at the angles α and β to the stream, which blows to the south: pitch α, heading -β. Nothing moves, and
the accelerometer feels 1 g.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import cos, radians, sin
from typing import Annotated
from zlib import crc32

import numpy as np
from annotated_types import Interval, MinLen
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.airdata import GAMMA, GAS_CONSTANT_DRY_AIR
from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant, room
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]
Speed = Annotated[float, Interval(ge=0.0, le=300.0)]  # m/s
Mach = Annotated[float, Interval(ge=0.0, le=0.9)]
Angle = Annotated[float, Interval(ge=-80.0, le=80.0)]  # degrees

HEAT_CAPACITY = GAMMA / (GAMMA - 1.0) * GAS_CONSTANT_DRY_AIR  # J/(kg K), c_p of dry air
HALF_EXCESS = 0.5 * (GAMMA - 1.0)  # –, (γ - 1)/2: T_0/T = 1 + 0.2 M²


@dataclass(frozen=True, slots=True)
class WindTunnelSettings:
    """A wind tunnel, `plant.kind = "wind-tunnel"`: at rest until the launcher's wait is over, then speed after speed.

    Pressure and temperature of the room are those of the standard atmosphere at the place (`environment`).

    Attributes
    ----------
    speeds
        Airspeeds that are set, m/s, in their order.
    machs
        Mach numbers that are set, in place of the speeds.
    hold
        Time for which each is set, s.
    ramp
        Time in which the set value goes evenly from one to the next, before it is held, s.
    settling
        Time constant with which the air follows what is set, s.
    turbulence
        Standard deviation of the turbulence along the stream, as a share of the airspeed.
    turbulence_length
        Its scale length, m: the correlation time is that over the airspeed.
    temperature_drift
        Rate at which the air warms from the start of the record, K/s.
    alpha_deg, beta_deg
        Angle of attack and of sideslip at which the head stands in the stream, degrees.
    """

    speeds: Annotated[tuple[Speed, ...], MinLen(1)] = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0)
    machs: tuple[Mach, ...] = ()
    hold: Annotated[float, Interval(ge=0.1, le=600.0)] = 10.0
    ramp: Annotated[float, Interval(ge=0.0, le=600.0)] = 0.0
    settling: Annotated[float, Interval(ge=0.0, le=60.0)] = 0.5
    turbulence: Annotated[float, Interval(ge=0.0, le=0.2)] = 0.0
    turbulence_length: Annotated[float, Interval(ge=0.001, le=1000.0)] = 0.5
    temperature_drift: Annotated[float, Interval(ge=-0.1, le=0.1)] = 0.0
    alpha_deg: Angle = 0.0
    beta_deg: Angle = 0.0

    @property
    def length(self) -> float:
        """How long the run takes after the wait, s."""
        return len(self.machs or self.speeds) * (self.ramp + self.hold)


def corners(settings: WindTunnelSettings, start: float) -> tuple[Array, Array]:
    """Return the times, s, and values of the polygon that is set; a jump has two values at its time."""
    times, values = [0.0, start], [0.0, 0.0]
    for value in settings.machs or settings.speeds:
        reached = times[-1] + settings.ramp
        times += [reached, reached + settings.hold]
        values += [value, value]
    return np.array(times), np.array(values)


def followed(time: Array, times: Array, values: Array, lag: float) -> Array:
    """Return what follows a polygon with a first-order lag, exactly, from rest at its first value.

    Within a straight piece s = a + b t the answer is s - bτ, a part that has settled, and a rest that dies away:

        v(t) = s(t) - bτ + (v_0 - a + bτ) e^{-t/τ}

    Parameters
    ----------
    time : array
        Rising, s; from the polygon's start on. After its end the last value stays.
    times, values : array
        Corners of the polygon.
    lag : float
        τ, s; 0 is none.
    """
    result = np.full(time.shape, values[-1])
    state = float(values[0])
    pieces = [*pairwise(zip(times.tolist(), values.tolist(), strict=True))]
    pieces.append(((times[-1], values[-1]), (np.inf, values[-1])))
    for (start, low), (end, high) in pieces:
        if end <= start:
            continue
        slope = (high - low) / (end - start)
        rows = slice(*np.searchsorted(time, [start, end]))
        since = np.append(time[rows] - start, min(end, float(time[-1])) - start)
        settled = low + slope * (since - lag)
        rest = (state - low + slope * lag) * np.exp(-since / lag) if lag > 0.0 else np.zeros_like(since)
        result[rows], state = (settled + rest)[:-1], float(settled[-1] + rest[-1])
    return result


def turbulence(speed: Array, dt: float, length: float, seed: int) -> Array:
    """Return x, the turbulence along a stream of a given mean `speed`, m/s, with unit variance, one value a step.

    x_k = φ_k x_{k-1} + √(1 - φ_k²) ξ_k with φ_k = e^{-v_k dt/L}: exact for a speed that is constant within a step.
    """
    source = np.random.SeedSequence(seed, spawn_key=(crc32(b"wind_tunnel.turbulence"),))
    drawn = np.random.default_rng(source).standard_normal(speed.size)
    keep = np.exp(-speed * dt / length)
    new = np.sqrt(-np.expm1(-2.0 * speed * dt / length)) * drawn
    x, last = [], float(drawn[0])
    for share, step in zip(keep.tolist(), new.tolist(), strict=True):
        last = share * last + step
        x.append(last)
    return np.array(x)


def stream(settings: WindTunnelSettings, run: Run) -> tuple[Array, Array, Array]:
    """Return airspeed, m/s, Mach number and temperature, K, at each row of the run.

    Raises
    ------
    ValueError
        If what is set leads beyond Mach 1 or to air that is too cold.
    """
    time = run.time
    _, warm = room(run.environment)
    total = warm + settings.temperature_drift * time
    mean = followed(time, *corners(settings, run.release_time), settings.settling)
    if settings.machs:
        mean = mean * np.sqrt(GAMMA * GAS_CONSTANT_DRY_AIR * total / (1.0 + HALF_EXCESS * mean * mean))
    speed = mean
    if settings.turbulence > 0.0:
        x = turbulence(mean, 1.0 / run.step_rate, settings.turbulence_length, run.random_seed)
        speed = np.maximum(mean * (1.0 + settings.turbulence * x), 0.0)
    temperature = total - speed * speed / (2.0 * HEAT_CAPACITY)
    if temperature.min() < airdata.MIN_TEMPERATURE or temperature.max() > airdata.MAX_TEMPERATURE:
        raise ValueError(
            f"plant.wind_tunnel: the air gets {temperature.min():.0f} to {temperature.max():.0f} K; it must stay "
            f"within {airdata.MIN_TEMPERATURE:g} and {airdata.MAX_TEMPERATURE:g} K"
        )
    mach = speed / np.sqrt(GAMMA * GAS_CONSTANT_DRY_AIR * temperature)
    if mach.max() > 1.0:
        raise ValueError(f"plant.wind_tunnel: what is set reaches Mach {mach.max():.2f}; it must stay below 1")
    return speed, mach, temperature


def wind_tunnel(settings: WindTunnelSettings, run: Run) -> PrescribedPlant:
    """Make the plant of one run.

    Raises
    ------
    ValueError
        If what is set leads beyond Mach 1 or to air that is too cold.
    """
    speed, mach, temperature = stream(settings, run)
    pressure, _ = room(run.environment)
    alpha, beta = radians(settings.alpha_deg), radians(settings.beta_deg)
    still = np.zeros_like(speed)
    columns = {
        "airspeed": speed,
        "mach": mach,
        "p_static": np.full_like(speed, pressure),
        "p_total": airdata.total_pressure(static=np.full_like(speed, pressure), mach=mach),
        "temperature": temperature,
        "fx": np.full_like(speed, STANDARD_GRAVITY * sin(alpha)),
        "fy": still,
        "fz": np.full_like(speed, -STANDARD_GRAVITY * cos(alpha)),
        "north": still,
        "east": still,
        "altitude": np.full_like(speed, run.environment.ground_elevation + run.launcher.height),
        "vn": still,
        "ve": still,
        "vd": still,
        "wind_n": -speed,
        "wind_e": still,
        "wind_d": still,
        "roll": still,
        "pitch": np.full_like(speed, alpha),
        "heading": np.full_like(speed, -beta),
        "p": still,
        "q": still,
        "r": still,
        "alpha": np.full_like(speed, alpha),
        "beta": np.full_like(speed, beta),
    }
    return PrescribedPlant(run, columns)


KINDS.add(Kind("wind-tunnel", wind_tunnel, group="wind_tunnel", launches=False, ours=True))
