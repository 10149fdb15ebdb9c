"""The launch-force curve as a rig: a prescribed push along body x, on a launcher's elevation.

    push(t) = A c(t - t_release),   f_x = max(push, g sin θ),   f_y = 0,   f_z = -g cos θ

The stop behind holds what the push does not.

    ring       c = min(t/t_rise, 1) (1 + B e^{-t/τ} cos(2π f t + φ)), and falls evenly to 0 at the end
    trapezoid  the same with B = 0
    half-sine  c = sin(π t/T)

A is the specific force of the launcher (`peak_specific_force_g`) times the drawn factor, T the curve's length. What is
published is a drawing of such a curve with white noise of an unknown deviation. The ring with B = 0.5, f = 120 Hz,
φ = 315°, τ = 50 ms and a rise of 3 ms is the simplest that gives its table of counts (7, 14, 22, 32 of 10, 20, 30, 40
samples at 1 kHz above three quarters of A): white noise alone gives them with a probability below 1 %.

The way along the rail is the double integral of f_x - g sin θ while the push lasts.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin
from typing import Annotated, Literal

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LaunchCurveSettings:
    """A prescribed launch force along body x, `plant.kind = "launch-curve"`.

    Its level A is `launcher.peak_specific_force_g`, its elevation and wait are the launcher's, too.

    Attributes
    ----------
    shape
        "ring": rises, and rings about its plateau; "half-sine"; "trapezoid": rises, stays and falls.
    length
        From no force to no force, s.
    rise
        Time in which ring and trapezoid rise, s.
    fall
        Time in which they fall at the end, s.
    ring_fraction
        Amplitude of the ring at the start, as a fraction of A.
    ring_hz
        Its frequency, Hz.
    ring_phase_deg
        Its phase at the start, degrees.
    ring_decay
        Time in which it decays to 1/e, s.
    noise_sd_g
        Standard deviation of white noise on the curve, independent each ms, g.
    """

    shape: Literal["ring", "half-sine", "trapezoid"] = "ring"
    length: Annotated[float, Interval(ge=0.01, le=10)] = 0.3
    rise: Annotated[float, Interval(ge=0.001, le=1)] = 0.003
    fall: Annotated[float, Interval(ge=0.001, le=1)] = 0.020
    ring_fraction: Annotated[float, Interval(ge=0, le=5)] = 0.5
    ring_hz: Annotated[float, Interval(gt=0, le=500)] = 120.0
    ring_phase_deg: Annotated[float, Interval(ge=-360, le=360)] = 315.0
    ring_decay: Annotated[float, Interval(gt=0, le=10)] = 0.050
    noise_sd_g: Annotated[float, Interval(ge=0, le=50)] = 0.0


def shape(settings: LaunchCurveSettings, t: Array) -> Array:
    """Force over its level at times since release, s; 0 before and after the curve."""
    s = settings
    during = (t >= 0.0) & (t < s.length)
    if s.shape == "half-sine":
        return np.where(during, np.sin(pi * t / s.length), 0.0)
    edges = np.clip(np.minimum(t / s.rise, (s.length - t) / s.fall), 0.0, 1.0)
    if s.shape == "trapezoid":
        return edges
    since = np.maximum(t, 0.0)
    ring = np.exp(-since / s.ring_decay) * np.cos(2.0 * pi * s.ring_hz * since + radians(s.ring_phase_deg))
    return edges * (1.0 + s.ring_fraction * ring)


def launch_curve(settings: LaunchCurveSettings, run: Run) -> PrescribedPlant:
    """Make the plant of one run."""
    elevation = radians(run.launcher.elevation_deg)
    time = run.time
    since = time - run.release_time
    level = run.launcher.peak_specific_force_g * STANDARD_GRAVITY * run.force_factor
    held = STANDARD_GRAVITY * sin(elevation)
    force = np.maximum(level * shape(settings, since), held)
    speed = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) - held)]) / run.step_rate
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / run.step_rate
    over = int(np.searchsorted(since, settings.length))
    way[over:] = way[min(over, way.size - 1)]
    columns = {
        "fx": force,
        "fy": np.zeros_like(time),
        "fz": np.full_like(time, -STANDARD_GRAVITY * cos(elevation)),
        "rail_s": way,
        "roll": np.zeros_like(time),
        "pitch": np.full_like(time, elevation),
        "heading": np.full_like(time, radians(run.launcher.heading_deg)),
        "p": np.zeros_like(time),
        "q": np.zeros_like(time),
        "r": np.zeros_like(time),
        "altitude": np.full_like(time, run.environment.ground_elevation + run.launcher.height) + way * sin(elevation),
    }
    noise = np.zeros((time.size, 3))
    noise[:, 0] = np.random.default_rng(run.random_seed).standard_normal(time.size)
    return PrescribedPlant(run, columns, noise * (settings.noise_sd_g * STANDARD_GRAVITY))


READ = ("peak_specific_force_g", "force_factor", "force_spread", "elevation_deg", "heading_deg")  # of the launcher
KINDS.add(Kind("launch-curve", launch_curve, group="launch_curve", launcher=READ, ours=True))
