"""Loads that are no launch: a centrifuge's, an engine's run-up, somebody who walks with the aircraft."""

from dataclasses import dataclass
from math import cos, floor, pi, radians, sin
from typing import Annotated

import numpy as np
from annotated_types import Gt

from sensors.streams import Streams
from uavsim.studies.signals.noise import band_noise
from uavsim.studies.signals.ranges import Array, NonNegative, Range
from uavsim.truth import STANDARD_GRAVITY as G0


@dataclass(frozen=True, slots=True)
class CentrifugeSettings:
    """A sustained load on the launch axis, gravity on z; ω rises and falls evenly, so the load goes with its square.

    Attributes
    ----------
    level_g
        ω² r, standard g.
    hold
        At that level, s.
    ramp
        From rest to it and back, s each.
    """

    level_g: NonNegative = 4.1
    hold: NonNegative = 60.0
    ramp: Annotated[float, Gt(0)] = 5.0


def centrifuge(settings: CentrifugeSettings, rate: float = 1000.0) -> Array:
    """Return the true force of a run from rest to rest, shape (n, 3), m/s²."""
    whole = settings.hold + 2 * settings.ramp
    t = np.arange(floor(whole * rate) + 1) / rate
    speed = np.clip(np.minimum(t, whole - t) / settings.ramp, 0.0, 1.0)  # over that of the level
    return np.column_stack([settings.level_g * G0 * speed**2, np.zeros_like(t), np.full_like(t, -G0)])


@dataclass(frozen=True, slots=True)
class RunUpSettings:
    """An engine run up on the rail. The latch holds, so thrust is not felt: only what turns out of balance is.

    Attributes
    ----------
    duration
        s; idle for a tenth of it, then evenly up to full speed at half of it, which is held.
    idle_hz, full_hz
        Revolutions a second.
    shake_g
        Amplitude at full speed of the first order, on each axis, uniform, standard g; it goes with speed squared.
    blade
        Amplitude of the second order, the blades', over the first.
    elevation_deg
        Of the rail, degrees, uniform.
    """

    duration: Annotated[float, Gt(0)] = 20.0
    idle_hz: Annotated[float, Gt(0)] = 30.0
    full_hz: Annotated[float, Gt(0)] = 120.0
    shake_g: Range = (0.5, 2.0)
    blade: NonNegative = 0.5
    elevation_deg: Range = (5.0, 35.0)


def run_up(settings: RunUpSettings, streams: Streams, rate: float = 1000.0) -> Array:
    """Return the true force of a run-up, shape (n, 3), m/s²; stream "run-up"."""
    generator = streams("run-up")
    t = np.arange(floor(settings.duration * rate) + 1) / rate
    hz = np.interp(t / settings.duration, [0.1, 0.5], [settings.idle_hz, settings.full_hz])
    turned = 2 * pi * np.concatenate([[0.0], np.cumsum((hz[1:] + hz[:-1]) / 2)]) / rate
    elevation = radians(generator.uniform(*settings.elevation_deg))
    force = np.tile([G0 * sin(elevation), 0.0, -G0 * cos(elevation)], (t.size, 1))
    for axis in range(3):
        shake = generator.uniform(*settings.shake_g) * G0 * (hz / settings.full_hz) ** 2
        one, two = generator.uniform(0.0, 2 * pi, 2)
        force[:, axis] += shake * (np.sin(turned + one) + settings.blade * np.sin(2 * turned + two))
    return force


@dataclass(frozen=True, slots=True)
class WalkSettings:
    """Carried by somebody who walks; each range is uniform.

    In 248 s of a recorded power-up, carrying and walking the kinematic force reached 2.7 m/s² forward and 4.5 m/s² in
    all; the amplitudes are chosen to reach that.

    Attributes
    ----------
    duration
        s.
    pace_hz
        Steps a second.
    vertical, forward, lateral
        Amplitude at the pace, at the pace and at half the pace, m/s².
    sway_deg
        Amplitude of the pitch, at 0.2 Hz, degrees.
    unsteady
        Hands: noise of 1-10 Hz, m/s² rms on each axis.
    """

    duration: Annotated[float, Gt(0)] = 60.0
    pace_hz: Range = (1.5, 2.2)
    vertical: Range = (1.5, 2.8)
    forward: Range = (0.5, 1.5)
    lateral: Range = (0.3, 0.8)
    sway_deg: Range = (0.0, 20.0)
    unsteady: NonNegative = 0.3


def walk(settings: WalkSettings, streams: Streams, rate: float = 1000.0) -> Array:
    """Return the true force of carrying, shape (n, 3), m/s²; stream "walk"."""
    generator = streams("walk")
    t = np.arange(floor(settings.duration * rate) + 1) / rate
    turn = 2 * pi * generator.uniform(*settings.pace_hz) * t
    phases = generator.uniform(0.0, 2 * pi, 4)
    pitch = radians(generator.uniform(*settings.sway_deg)) * np.sin(2 * pi * 0.2 * t + phases[3])
    force = np.column_stack([G0 * np.sin(pitch), np.zeros_like(t), -G0 * np.cos(pitch)])
    orders = ((settings.forward, 1.0), (settings.lateral, 0.5), (settings.vertical, 1.0))
    for axis, (amplitude, order) in enumerate(orders):
        force[:, axis] += generator.uniform(*amplitude) * np.sin(order * turn + phases[axis])
        force[:, axis] += settings.unsteady * band_noise(t.size, rate, (1.0, 10.0), generator)
    return force
