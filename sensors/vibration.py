"""Vibration at the accelerometer: a specific force beside the truth, body axes, m/s².

    v(t) = rms(phase) g ξ(t) + e_x c P a(τ) sin(2π f_r τ),   τ = t - t_release ≥ 0
    a(τ) = τ/t_rise while the push rises, e^{-(τ - t_rise)/T} afterwards

ξ is noise of unit rms with a flat spectrum in a band, independent on each axis; its rms is that of the phase: waiting
on the rail, stroke, flight. The second term is the airframe ringing along body x: the push excites it as it rises to
its plateau P, to the fraction c of it, and it decays from there. Vibration is part of what is felt: it goes through
the bandwidth and can alias.
"""

from collections.abc import Callable, Iterator
from itertools import chain, cycle, islice, repeat
from math import ceil, isfinite

import numpy as np
from numpy.typing import NDArray

from sensors.noise import band_limited
from sensors.settings import VibrationSettings
from sensors.streams import Streams
from sensors.unit import G0

PERIOD = 32768  # steps after which the noise repeats, without a seam: 33 s at 1 kHz
RING_DECAYS = 20  # the ring is dropped when it has fallen to e^-20 = 2e-9

Row = list[float] | tuple[float, float, float]
Array = NDArray[np.float64]


class Vibration:
    """Vibration of one flight, step by step of the plant.

    Parameters
    ----------
    settings : VibrationSettings
    streams : Streams
        The stream "vibration" is used.
    dt : float
        Step of the plant, s; its step k is at k dt, beginning with k = 0.
    release_time : float
        When the latch lets go, s; infinity if it never does.
    plateau : float
        Specific force of the push, m/s².
    rise : float
        Time in which the push rises to it, s.
    scale : float
        Factor on everything.

    Attributes
    ----------
    step : callable
        Called once a plant step, gives (x, y, z) of that step, m/s².

    Raises
    ------
    ValueError
        If the band reaches half the plant's step rate.
    """

    __slots__ = ("_dt", "_flight_rms", "_unit", "step")

    step: Callable[[], Row]

    def __init__(
        self,
        settings: VibrationSettings,
        streams: Streams,
        *,
        dt: float,
        release_time: float,
        plateau: float,
        rise: float = 0.0,
        scale: float = 1.0,
    ) -> None:
        unit = band_limited(streams("vibration"), PERIOD, dt, settings.band_hz, axes=3) * (scale * G0)
        self._dt = dt
        self._unit = unit
        self._flight_rms = settings.flight_rms_g
        waiting = _endless(unit * settings.waiting_rms_g, 0)
        if not isfinite(release_time):
            self.step = waiting.__next__
            return
        released = ceil(release_time / dt)
        lasting = rise + RING_DECAYS * settings.ring_decay
        tau = np.arange(released, released + ceil(lasting / dt)) * dt - release_time
        grown = np.minimum(tau / rise, 1.0) if rise > 0.0 else np.ones_like(tau)
        envelope = grown * np.exp(-np.maximum(tau - rise, 0.0) / settings.ring_decay)
        ring = envelope * np.sin(2.0 * np.pi * settings.ring_hz * tau)
        stroke = unit * settings.stroke_rms_g
        ringing = np.take(stroke, np.arange(released, released + tau.size), axis=0, mode="wrap")
        ringing[:, 0] += ring * (scale * settings.ring_fraction * plateau)
        rest = _endless(stroke, released + tau.size)
        self.step = chain(islice(waiting, released), ringing.tolist(), rest).__next__

    @classmethod
    def still(cls) -> "Vibration":
        """Return no vibration at all."""
        self = cls.__new__(cls)
        self._dt = 1.0
        self._unit = np.zeros((1, 3))
        self._flight_rms = 0.0
        self.step = repeat((0.0, 0.0, 0.0)).__next__
        return self

    def leave_rail(self, t: float) -> None:
        """Go over to the vibration of flight from the plant step at time `t` on."""
        self.step = _endless(self._unit * self._flight_rms, round(t / self._dt)).__next__


def _endless(table: Array, start: int) -> Iterator[list[float]]:
    """Return the rows of a periodic table for ever, beginning with row `start`."""
    return cycle(np.roll(table, -start, axis=0).tolist())
