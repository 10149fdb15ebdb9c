"""Handling bumps and drops: a half-sine on one axis and the ringing behind it."""

from dataclasses import dataclass
from math import pi

import numpy as np

from uavsim.studies.signals.ranges import Array, Range, check
from uavsim.truth import STANDARD_GRAVITY as G0

RING_DECAYS = 10.0  # a ring is dropped when it has fallen to e^-10 = 5e-5


@dataclass(frozen=True, slots=True)
class ShockSettings:
    """Distribution of a shock; each range is uniform.

    Attributes
    ----------
    peak_g
        Peak of its half-sine, standard g.
    duration
        Of the half-sine, s.
    ring
        First amplitude of the ringing over the peak, before decay.
    ring_hz
        Its frequency, Hz.
    ring_decay
        Its time constant, s.
    """

    peak_g: Range = (20.0, 50.0)
    duration: Range = (0.002, 0.005)
    ring: Range = (0.2, 0.5)
    ring_hz: Range = (80.0, 400.0)
    ring_decay: Range = (0.005, 0.020)

    def __post_init__(self) -> None:
        for name in ("peak_g", "ring", "ring_hz"):
            check(name, getattr(self, name))
        for name in ("duration", "ring_decay"):
            check(name, getattr(self, name), 1e-4, 1.0)  # no shock outlasts the spell after its own


SOFT_DROP = ShockSettings((6.0, 12.0), (0.015, 0.025), ring=(0.1, 0.2), ring_hz=(20.0, 60.0))


@dataclass(frozen=True, slots=True)
class Shock:
    """A half-sine and the ringing behind it, on one axis.

    f = P sin(π τ/D), τ < D;   f = -r P e^{-(τ-D)/T} sin(2π f_r (τ - D)), later;   τ = t - start
    """

    start: float  # s
    axis: int  # 0, 1, 2 = x, y, z
    peak: float  # m/s², signed
    duration: float  # s
    ring: float
    ring_hz: float  # Hz
    ring_decay: float  # s

    @property
    def end(self) -> float:
        """When it is dropped, s."""
        return self.start + self.duration + RING_DECAYS * self.ring_decay

    def force(self, t: Array) -> Array:
        """Return the force on its axis at `t` s: shape of `t`, m/s²."""
        since = t - self.start
        after = np.maximum(since - self.duration, 0.0)
        half = np.where(since < self.duration, np.sin(pi / self.duration * since), 0.0)
        ring = self.ring * np.exp(-after / self.ring_decay) * np.sin(2 * pi * self.ring_hz * after)
        return np.where((since >= 0.0) & (t < self.end), self.peak * (half - ring), 0.0)


def draw_shock(settings: ShockSettings, start: float, generator: np.random.Generator) -> Shock:
    """Draw the shock that begins at `start` s."""
    axis, sign = int(generator.integers(3)), 1.0 - 2.0 * float(generator.integers(2))
    ranges = (settings.peak_g, settings.duration, settings.ring, settings.ring_hz, settings.ring_decay)
    peak, *rest = (low + (high - low) * u for (low, high), u in zip(ranges, generator.random(5).tolist(), strict=True))
    return Shock(start, axis, sign * peak * G0, *rest)
