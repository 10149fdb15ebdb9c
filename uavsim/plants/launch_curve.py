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

from math import cos, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.plants.rig_settings import LaunchCurveSettings
from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]


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
