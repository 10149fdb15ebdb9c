"""Vibration at the accelerometer: a specific force beside the truth, body axes, m/s².

    v(t) = rms(phase) g ξ(t) + e_x c P a(τ) sin(2π f_r τ) + Σ A_i g sin(2π f_i t + φ_i) + Σ g ζ_i(t)
    a(τ) = τ/t_rise while the push rises, e^{-(τ - t_rise)/T} afterwards;   τ = t - t_release ≥ 0

ξ is noise of unit rms with a flat spectrum in a band, independent on each axis; its rms is that of the phase: waiting
on the rail, stroke, flight. The second term is the airframe ringing along body x: the push excites it as it rises to
its plateau P, to the fraction c of it, and it decays from there. To these come tones and random vibration ζ_i of a
given power spectral density, each always there or in one phase only. All noise repeats after 32.768 s, without a
seam, and is the same in time whatever the step; a tone is computed at the time of each step. Vibration is part of what
is felt: it goes through the bandwidth and can alias.
"""

from collections.abc import Callable, Iterator
from itertools import chain, count, islice
from math import ceil, inf, isfinite, pi, radians

import numpy as np
from numpy.typing import NDArray

from sensors.noise import BLOCK
from sensors.settings import Phase, Tone, VibrationSettings
from sensors.spectrum import band_limited, check_psd, spectral
from sensors.streams import Streams
from sensors.unit import G0

PERIOD = 32.768  # s after which the noise repeats, without a seam: 32 768 steps of 1 ms
PHASES = ("waiting", "stroke", "flight")
RING_DECAYS = 20  # the ring is dropped when it has fallen to e^-20 = 2e-9

Row = list[float] | tuple[float, float, float]
Array = NDArray[np.float64]
Source = tuple[Phase, Callable[[NDArray[np.int64]], Array]]
"""When it is there, and its rows (x, y, z), m/s², at steps of the plant."""


class Vibration:
    """Vibration of one flight, step by step of the plant.

    Parameters
    ----------
    settings : VibrationSettings
    streams : Streams
        Streams "vibration" and, for each spectrum, "vibration.spectrum.{i}" are used.
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
        If the band, a tone or a spectrum reaches half the plant's step rate, or as `check`.
    """

    __slots__ = ("_dt", "_flight_rms", "_k", "_released", "_sources", "_unit", "step")

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
        check(settings, dt)
        self._dt = dt
        steps = round(PERIOD / dt)
        self._unit = band_limited(streams("vibration"), steps, dt, settings.band_hz, axes=3) * (scale * G0)
        self._flight_rms = settings.flight_rms_g
        self._released = ceil(release_time / dt) if isfinite(release_time) else inf
        self._sources = _sources(settings, streams, dt, scale * G0)
        self._k = 0
        waiting = _endless(self._unit, settings.waiting_rms_g, 0)
        if not isfinite(release_time):
            self._shake(waiting, aloft=False)
            return
        released = ceil(release_time / dt)
        lasting = rise + RING_DECAYS * settings.ring_decay
        tau = np.arange(released, released + ceil(lasting / dt)) * dt - release_time
        grown = np.minimum(tau / rise, 1.0) if rise > 0.0 else np.ones_like(tau)
        envelope = grown * np.exp(-np.maximum(tau - rise, 0.0) / settings.ring_decay)
        ring = envelope * np.sin(2.0 * np.pi * settings.ring_hz * tau)
        ringing = _rows(self._unit, released, tau.size) * settings.stroke_rms_g
        ringing[:, 0] += ring * (scale * settings.ring_fraction * plateau)
        rest = _endless(self._unit, settings.stroke_rms_g, released + tau.size)
        self._shake(chain(islice(waiting, released), ringing.tolist(), rest), aloft=False)

    def on(self, force: tuple[float, float, float]) -> tuple[float, float, float]:
        """Go on by a step and return what everything feels of a true specific force then, m/s²."""
        (fx, fy, fz), (vx, vy, vz) = force, self.step()
        return fx + vx, fy + vy, fz + vz

    def leave_rail(self, t: float) -> None:
        """Go over to the vibration of flight: the next step has the noise of the plant step at time `t`."""
        self._shake(_endless(self._unit, self._flight_rms, round(t / self._dt)), aloft=True)

    def _shake(self, noise: Iterator[Row], aloft: bool) -> None:
        """Go on with these rows, and with the tones and spectra of the phase if there are any."""
        self.step = self._together(noise, aloft).__next__ if self._sources else noise.__next__

    def _together(self, noise: Iterator[Row], aloft: bool) -> Iterator[Row]:
        """Yield the sum, a block at a time; `_k` is the step that comes next."""
        for first in count(self._k, BLOCK):
            k = np.arange(first, first + BLOCK)
            rows = np.array(list(islice(noise, BLOCK)))
            phase = np.full(BLOCK, 2) if aloft else (k >= self._released).astype(int)
            for when, source in self._sources:
                if when == "always":
                    rows += source(k)
                elif (there := phase == PHASES.index(when)).any():
                    rows += source(k) * there[:, np.newaxis]
            for self._k, row in enumerate(rows.tolist(), first + 1):
                yield row


def check(settings: VibrationSettings, dt: float) -> None:
    """Refuse tones and spectra that a plant with this step, s, cannot carry.

    Raises
    ------
    ValueError
        In one line that names the key, "vibration.spectra[0].psd", and what is allowed.
    """
    half = 0.5 / dt
    for i, tone in enumerate(settings.tones):
        if not 0.0 < tone.frequency_hz < half:
            raise ValueError(
                f"vibration.tones[{i}].frequency_hz: must be above 0 and below half the step rate, {half:g} Hz, "
                f"not {tone.frequency_hz:g}"
            )
        if not all(isfinite(amplitude) for amplitude in tone.amplitude_g):
            raise ValueError(f"vibration.tones[{i}].amplitude_g: must be finite, not {tone.amplitude_g}")
    for i, spectrum in enumerate(settings.spectra):
        check_psd(f"vibration.spectra[{i}].psd", spectrum.psd, half)


def _sources(settings: VibrationSettings, streams: Streams, dt: float, scale: float) -> tuple[Source, ...]:
    """Return the tones and the spectra."""
    steps = round(PERIOD / dt)
    tones: list[Source] = [(tone.when, _sinusoid(tone, dt, scale)) for tone in settings.tones]
    spectra: list[Source] = [
        (spectrum.when, _periodic(spectral(streams(f"vibration.spectrum.{i}"), steps, dt, spectrum.psd, 3) * scale))
        for i, spectrum in enumerate(settings.spectra)
    ]
    return (*tones, *spectra)


def _sinusoid(tone: Tone, dt: float, scale: float) -> Callable[[NDArray[np.int64]], Array]:
    omega, phase, amplitude = 2.0 * pi * tone.frequency_hz, radians(tone.phase_deg), np.array(tone.amplitude_g) * scale
    return lambda k: np.sin(omega * (k * dt) + phase)[:, np.newaxis] * amplitude


def _periodic(table: Array) -> Callable[[NDArray[np.int64]], Array]:
    return lambda k: np.take(table, k, axis=0, mode="wrap")


def _rows(table: Array, first: int, number: int) -> Array:
    """Return rows of a periodic table."""
    return np.take(table, np.arange(first, first + number), axis=0, mode="wrap")


def _endless(table: Array, factor: float, start: int) -> Iterator[list[float]]:
    """Return the rows of a periodic table times `factor`, for ever, beginning with row `start`.

    They are made a block at a time: a flight needs a few thousand of a phase, and a phase may never come.
    """
    return chain.from_iterable((_rows(table, first, BLOCK) * factor).tolist() for first in count(start, BLOCK))
