"""What launch detectors are judged on: launches and disturbances at the accelerometer, with their distributions.

Specific force in m/s², body axes forward-right-down, t in s. On a rail of elevation θ a launch is

    f_x(t) = a(t - t_onset) + g sin θ,   f_y = 0,   f_z = -g cos θ        reading = clip(f + σ ξ + v)

a is the kinematic stroke (`Stroke`): a half-sine P sin(π t/T), a trapezoid that rises and falls in the same time, or
the measured shape of an electromechanical catapult; P is the kinematic peak, T the time from no force to no force.
ξ is white and normal, so σ is noise and vibration at the detector, not a part's data sheet. v is vibration with a flat
spectrum in a band. After the stroke the rail's rest is felt again. Degrees and g are in the settings only, whose names
say so. Unless a setting says otherwise:

    launches      half-sine or trapezoid 50:50; P U(5, 15) g; T U(0.1, 0.4) s; rise U(10, 40) ms; θ U(5°, 35°);
                  wait before onset U(0.5, 1) s; the bump of a bump trial begins U(0.4 s, its length) before onset
    hang-fire     the force first stays at U(0.1, 0.4) P for U(0.1, 0.5) s, then the stroke comes
    broken        the force goes at U(0.1, 0.6) T, within 5 ms, for U(20, 60) ms, and comes back in 5 ms
    shocks        half-sine, peak U(20, 50) g, U(2, 5) ms, on x, y or z, either sign, then ringing of opposite sign:
                  U(0.2, 0.5) of the peak, U(80, 400) Hz, decay U(5, 20) ms
    soft drops    the same with U(6, 12) g, U(15, 25) ms and a tenth to a fifth of ringing at U(20, 60) Hz
    the mix       shocks as a Poisson process of 0.5/s; in each spell of 30 s vibration of 0, 1, 2 or 3 g rms (each
                  axis, 5-200 Hz), equally probable, on a rail of its own θ; σ 0.3 g; all of it clipped at ±16 g

All randomness comes from named streams of (seed, index), see `sensors.streams`: trial i of a seed is the same whatever
else is drawn. The disturbances are assumptions, not measurements, but for the bounds on walking (`WalkSettings`).
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import ceil, cos, floor, inf, pi, radians, sin
from typing import Annotated, Literal
from zlib import crc32

import numpy as np
from annotated_types import Ge, Gt, Interval
from numpy.typing import NDArray

from sensors.streams import Streams
from uavsim.truth import STANDARD_GRAVITY as G0

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Shape = Literal["half-sine", "trapezoid", "catapult"]
Fault = Literal["none", "hang-fire", "broken"]
NonNegative = Annotated[float, Ge(0)]
Range = tuple[NonNegative, NonNegative]
"""Bounds of a uniform distribution; equal ones give that value."""

CROSSING = 4.5 * G0  # m/s², level at which the delay of a detection begins
CATAPULT_PEAK = 66.0  # m/s², kinematic, mean of 90 recorded strokes of an electromechanical catapult
CATAPULT_TIME = 0.61  # s, from no force to no force
CATAPULT_KNOTS = (0.18, 0.28, 0.47)  # s: end of the plateau, of the slope, of the second plateau
CATAPULT_SECOND = 53.0 / CATAPULT_PEAK  # second plateau over the first
WEAK_RISE = 0.02  # s, rise of a hang-fire's weak force
BREAK_RAMP = 0.005  # s, in which a broken stroke's force goes and comes back
BUMP_WITHIN = 0.4  # s before onset, in which a bump trial's bump falls
RING_DECAYS = 10.0  # a ring is dropped when it has fallen to e^-10 = 5e-5
SPELL = 30.0  # s, of one level of vibration and one rail in the mix; also what is generated at once
FADE = 0.05  # s, over which a spell's vibration grows and dies away, so that there is no step between spells


def _check(name: str, bounds: Range, least: float = 0.0, most: float = 1e6) -> None:
    if not least <= bounds[0] <= bounds[1] <= most:
        raise ValueError(f"{name} must be two numbers in {least:g} … {most:g}, the smaller first, not {bounds}")


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
            _check(name, getattr(self, name))
        for name in ("duration", "ring_decay"):
            _check(name, getattr(self, name), 1e-4, 1.0)  # no shock outlasts the spell after its own


SOFT_DROP = ShockSettings((6.0, 12.0), (0.015, 0.025), ring=(0.1, 0.2), ring_hz=(20.0, 60.0))


@dataclass(frozen=True, slots=True)
class LaunchSettings:
    """Distribution of launches; each range is uniform.

    Attributes
    ----------
    shapes
        Drawn with equal probability.
    peak_g
        Kinematic peak, standard g.
    duration
        From no force to no force, s.
    rise
        Of a trapezoid, s; of the catapult, s in its measured 0.61 s, scaled in time with the rest of the shape.
    elevation_deg
        Of the rail, degrees.
    sigma_g
        White noise and vibration at the detector, standard g.
    vibration_g
        Vibration of 5-200 Hz beside it, g rms, throughout.
    clip_g
        Range of the accelerometer, standard g.
    wait
        Before onset, s; at least 0.4 s with a bump.
    after
        Recorded after the longest launch, s.
    bump
        Whether a shock strikes in the last 0.4 s before onset.
    shock
        That shock.
    fault
        Hang-fire, broken stroke or none.
    hang
        Time of the weak force of a hang-fire, s.
    weak
        The weak force over the peak.
    break_at
        When a broken stroke breaks, as a fraction of its duration.
    gap
        For how long, s.
    """

    shapes: tuple[Shape, ...] = ("half-sine", "trapezoid")
    peak_g: Range = (5.0, 15.0)
    duration: Range = (0.1, 0.4)
    rise: Range = (0.010, 0.040)
    elevation_deg: Range = (5.0, 35.0)
    sigma_g: NonNegative = 0.3
    vibration_g: NonNegative = 0.0
    clip_g: Annotated[float, Gt(0)] = 16.0
    wait: Range = (0.5, 1.0)
    after: NonNegative = 0.3
    bump: bool = False
    shock: ShockSettings = field(default_factory=ShockSettings)
    fault: Fault = "none"
    hang: Range = (0.1, 0.5)
    weak: Range = (0.1, 0.4)
    break_at: Range = (0.1, 0.6)
    gap: Range = (0.020, 0.060)

    def __post_init__(self) -> None:
        if not self.shapes:
            raise ValueError("shapes must name at least one")
        for name in ("peak_g", "rise", "elevation_deg", "hang", "weak", "break_at", "gap"):
            _check(name, getattr(self, name))
        _check("duration", self.duration, 1e-3)
        if "trapezoid" in self.shapes and self.rise[1] > self.duration[0] / 2:
            raise ValueError(f"a trapezoid of {self.duration[0]:g} s cannot rise and fall in {self.rise[1]:g} s each")
        _check("wait", self.wait, BUMP_WITHIN if self.bump else 0.0)

    @property
    def length(self) -> float:
        """Length of every recording, s: all trials of one distribution are equally long."""
        hang = self.hang[1] if self.fault == "hang-fire" else 0.0
        return self.wait[1] + hang + self.duration[1] + self.after


MEASURED_CATAPULT = LaunchSettings(
    shapes=("catapult",), peak_g=(CATAPULT_PEAK / G0,) * 2, duration=(CATAPULT_TIME,) * 2, rise=(0.020, 0.040)
)


@dataclass(frozen=True, slots=True)
class Stroke:
    """Kinematic acceleration along the rail, beginning at t = 0; see `LaunchSettings` for the attributes.

    Raises
    ------
    ValueError
        If the rise takes more than half of a trapezoid or outlasts the catapult's plateau, or the weak force is above
        half the peak.
    """

    shape: Shape
    peak: float  # m/s²
    duration: float  # s
    rise: float = 0.0  # s
    hang: float = 0.0  # s
    weak: float = 0.0  # of the peak
    break_at: float = inf  # s after the stroke itself begins
    gap: float = 0.0  # s

    def __post_init__(self) -> None:
        longest = {"half-sine": inf, "trapezoid": self.duration / 2, "catapult": CATAPULT_KNOTS[0]}[self.shape]
        if not 0.0 <= self.rise <= longest:
            raise ValueError(
                f"a {self.shape} of {self.duration:g} s cannot rise in {self.rise:g} s, only {longest:g} s"
            )
        if not (self.peak >= 0.0 and self.duration > 0.0 and 0.0 <= self.weak <= 0.5 and self.hang >= 0.0):
            raise ValueError("peak and hang must be at least 0, duration above 0 and weak between 0 and 0.5")

    @property
    def end(self) -> float:
        """When the force has gone for good, s after the first force."""
        return self.hang + self.duration

    def force(self, t: Array) -> Array:
        """Return the acceleration at `t`, s after the first force: shape of `t`, m/s²."""
        own = t - self.hang
        force = self._pulse(own)
        if self.hang > 0.0:  # the weak force lasts until the stroke exceeds it, which it does before its middle
            weak = self.weak * self.peak * np.clip(t / WEAK_RISE, 0.0, 1.0)
            force = np.where(own < self.duration / 2, np.maximum(force, weak), force)
        if self.gap > 0.0 and self.break_at < inf:
            knots = self.break_at + np.cumsum([0.0, BREAK_RAMP, self.gap, BREAK_RAMP])
            force = force * np.interp(own, knots, [1.0, 0.0, 0.0, 1.0])
        return force

    def _pulse(self, t: Array) -> Array:
        if self.shape == "half-sine":
            inside = (t > 0.0) & (t < self.duration)
            return np.where(inside, self.peak * np.sin(pi / self.duration * t), 0.0)
        if self.shape == "trapezoid":
            rise = max(self.rise, 1e-9)  # a jump, as far as any clock can tell
            return np.interp(t, [0.0, rise, self.duration - rise, self.duration], [0.0, self.peak, self.peak, 0.0])
        knots = np.array([0.0, max(self.rise, 1e-9), *CATAPULT_KNOTS, CATAPULT_TIME]) * (self.duration / CATAPULT_TIME)
        second = CATAPULT_SECOND * self.peak
        return np.interp(t, knots, [0.0, self.peak, self.peak, second, second, 0.0])


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


@dataclass(frozen=True, slots=True)
class LaunchTruth:
    """What is true of a launch: times in s of its recording, `peak` the largest true axis force, m/s²."""

    onset: float
    crossing: float | None  # first time the true axis force is above 4.5 g; None if it never is
    peak: float
    end: float


@dataclass(frozen=True, slots=True)
class Launch:
    """One launch: stroke, rail elevation (rad), onset and length of the recording (s), and the bump before it."""

    stroke: Stroke
    elevation: float
    onset: float
    length: float
    bump: Shock | None = None

    def axial(self, t: Array) -> Array:
        """Return the true force on the launch axis at `t` s of the recording, without the bump, m/s²."""
        return self.stroke.force(t - self.onset) + G0 * sin(self.elevation)

    def force(self, t: Array) -> Array:
        """Return the true force at `t` s, shape (n, 3), m/s², with gravity and bump."""
        force = np.zeros((t.size, 3))
        force[:, 0] = self.axial(t)
        force[:, 2] = -G0 * cos(self.elevation)
        if self.bump is not None:
            force[:, self.bump.axis] += self.bump.force(t)
        return force

    def truth(self, crossing: float = CROSSING) -> LaunchTruth:
        """Return the times and the peak; `crossing` is the level in m/s². The crossing is exact to 10 ns."""
        stroke, onset, end = self.stroke, self.onset, self.onset + self.stroke.end
        t = np.linspace(onset, end, 1 + ceil(1e4 * stroke.end))
        force = self.axial(t)
        corners = (
            0.5 * stroke.duration,
            stroke.rise,
            stroke.rise * stroke.duration / CATAPULT_TIME,
            min(stroke.break_at, stroke.duration),
        )
        peak = max(force.max(), self.axial(onset + stroke.hang + np.array(corners)).max())
        found = None
        for _ in range(3):  # closing in: 0.1 ms, 1 µs, 10 ns
            above = np.flatnonzero(force > crossing)
            if above.size == 0:
                break
            first = int(above[0])
            found = float(t[first])
            if first == 0:
                break
            t = np.linspace(t[first - 1], t[first], 101)
            force = self.axial(t)
        return LaunchTruth(onset, found, float(peak), end)


def draw_launch(settings: LaunchSettings, streams: Streams) -> Launch:
    """Draw a launch from the streams "launch.…" of a trial.

    Parameters
    ----------
    settings
        Its distribution.
    streams
        Of the trial: `Streams(seed, index)`.
    """

    def uniform(name: str, bounds: Range) -> float:
        return float(streams(f"launch.{name}").uniform(*bounds))

    duration = uniform("duration", settings.duration)
    hanging, broken = settings.fault == "hang-fire", settings.fault == "broken"
    stroke = Stroke(
        shape=settings.shapes[int(streams("launch.shape").integers(len(settings.shapes)))],
        peak=uniform("peak", settings.peak_g) * G0,
        duration=duration,
        rise=uniform("rise", settings.rise),
        hang=uniform("hang", settings.hang) if hanging else 0.0,
        weak=uniform("weak", settings.weak) if hanging else 0.0,
        break_at=uniform("break_at", settings.break_at) * duration if broken else inf,
        gap=uniform("gap", settings.gap) if broken else 0.0,
    )
    onset = uniform("wait", settings.wait)
    bump = None
    if settings.bump:
        generator = streams("launch.bump")
        bump = draw_shock(settings.shock, 0.0, generator)
        start = onset - generator.uniform(bump.duration, BUMP_WITHIN)
        bump = Shock(start, bump.axis, bump.peak, bump.duration, bump.ring, bump.ring_hz, bump.ring_decay)
    return Launch(stroke, radians(uniform("elevation", settings.elevation_deg)), onset, settings.length, bump)


def sense(force: Array, sigma_g: float, clip_g: float, generator: np.random.Generator) -> Array:
    """Return what is read of a true force: white noise added, then clipped.

    Before detection the truth does not depend on the noise, so one flight's force serves any number of readings.

    Parameters
    ----------
    force
        Any shape, m/s².
    sigma_g, clip_g
        Standard deviation and range, standard g.
    generator
        Of the noise.
    """
    reading = force + sigma_g * G0 * generator.standard_normal(force.shape)
    return np.clip(reading, -clip_g * G0, clip_g * G0, out=reading)


@dataclass(frozen=True, slots=True)
class Recordings:
    """Trials of one distribution: `t` (n,) s, `f` (trials, n, 3) m/s², and the launch and the truth of each."""

    t: Array
    f: Array
    launches: tuple[Launch, ...]
    truths: tuple[LaunchTruth, ...]


def record_launches(
    settings: LaunchSettings, seed: int, count: int, rate: float = 1000.0, first: int = 0
) -> Recordings:
    """Draw launches `first` … `first` + `count` - 1 of a seed and read them.

    Parameters
    ----------
    settings
        Their distribution.
    seed
        Root seed.
    count, first
        Which trials; each is the same whatever others are drawn.
    rate
        Hz; sample k is at k / rate.

    Raises
    ------
    ValueError
        If vibration is asked for at a rate that cannot hold it.
    """
    n = floor(settings.length * rate) + 1
    t = np.arange(n) / rate
    readings = np.empty((count, n, 3))
    launches = []
    for row in range(count):
        streams = Streams(seed, first + row)
        launch = draw_launch(settings, streams)
        force = launch.force(t)
        if settings.vibration_g > 0.0:
            generator = streams("launch.vibration")
            for axis in range(3):
                force[:, axis] += settings.vibration_g * G0 * band_noise(n, rate, (5.0, 200.0), generator)
        readings[row] = sense(force, settings.sigma_g, settings.clip_g, streams("launch.noise"))
        launches.append(launch)
    return Recordings(t, readings, tuple(launches), tuple(launch.truth() for launch in launches))


def band_noise(n: int, rate: float, band_hz: Range, generator: np.random.Generator) -> Single:
    """Return normal noise of unit rms with a flat spectrum in a band, shape (n,).

    Each frequency of the band has a complex normal amplitude of its own, so the samples are exactly normal.

    Raises
    ------
    ValueError
        If the band is empty in `n` samples or reaches half the rate: sample faster then and take every k-th sample.
    """
    from scipy.fft import irfft, next_fast_len

    m = next_fast_len(n, real=True)
    low, high = ceil(band_hz[0] * m / rate), floor(band_hz[1] * m / rate)
    if not 1 <= low <= high < m / 2:
        raise ValueError(f"vibration of {band_hz[0]:g}-{band_hz[1]:g} Hz does not fit {n} samples at {rate:g} Hz")
    spectrum = np.zeros(m // 2 + 1, np.complex64)
    spectrum[low : high + 1] = generator.standard_normal(2 * (high + 1 - low), dtype=np.float32).view(np.complex64)
    noise: Single = irfft(spectrum, m, norm="forward", overwrite_x=True)[:n]
    noise *= np.float32(0.5 / np.sqrt(high + 1 - low))  # a frequency's 2 (a cos - b sin) has variance 4
    return noise


@dataclass(frozen=True, slots=True)
class MixSettings:
    """A stream of disturbances without end; the defaults are "the mix".

    Attributes
    ----------
    shock
        Distribution of the shocks.
    shock_rate
        Of their Poisson process, 1/s.
    vibration_g
        Levels of the vibration, g rms on each axis; each spell of 30 s has one of them, equally probable.
    band_hz
        Its band, Hz; below half the rate.
    elevation_deg
        Of the rail in each spell, degrees, uniform.
    sigma_g, clip_g
        White noise and range, standard g.
    """

    shock: ShockSettings = field(default_factory=ShockSettings)
    shock_rate: Annotated[float, Interval(ge=0, le=100)] = 0.5
    vibration_g: tuple[NonNegative, ...] = (0.0, 1.0, 2.0, 3.0)
    band_hz: Range = (5.0, 200.0)
    elevation_deg: Range = (5.0, 35.0)
    sigma_g: NonNegative = 0.3
    clip_g: Annotated[float, Gt(0)] = 16.0

    def __post_init__(self) -> None:
        _check("elevation_deg", self.elevation_deg)
        if not self.vibration_g or min(self.vibration_g) < 0.0 or self.shock_rate < 0.0:
            raise ValueError("vibration_g must hold at least one level, and no level or rate may be negative")


SOFT_DROPS = MixSettings(shock=SOFT_DROP, vibration_g=(0.0,))


class Mix:
    """The disturbances of `MixSettings`, as many hours as are read, in constant memory.

    Spell k is drawn from streams of (seed, index, name, k) alone, so any part can be had without what is before it.

    Parameters
    ----------
    settings
    seed, index
        Each pair is a stream of its own.
    rate
        Hz; sample k is at k / rate.
    axes
        Which columns, of 0, 1, 2 = x, y, z; a column is the same alone as beside others.

    Raises
    ------
    ValueError
        If there are no axes, or the band of the vibration reaches half the rate.
    """

    __slots__ = ("axes", "index", "rate", "seed", "settings", "spell")

    def __init__(
        self, settings: MixSettings, seed: int, index: int = 0, rate: float = 1000.0, axes: tuple[int, ...] = (0, 1, 2)
    ) -> None:
        if not axes or not set(axes) <= {0, 1, 2}:
            raise ValueError(f"axes must be some of 0, 1, 2, not {axes}")
        if any(settings.vibration_g) and not 0.0 < settings.band_hz[0] < settings.band_hz[1] < rate / 2:
            raise ValueError(f"a rate of {rate:g} Hz cannot hold vibration of {settings.band_hz} Hz")
        if seed < 0 or index < 0:
            raise ValueError(f"seed and index must be at least 0, not {seed} and {index}")
        self.settings, self.rate, self.axes = settings, rate, axes
        self.seed = seed
        self.spell = round(SPELL * rate)  # samples
        self.index = index

    def _generator(self, name: str, k: int) -> np.random.Generator:
        # As in sensors.streams, with the number of the spell behind the name: CRCs of so many names would meet.
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(self.index, crc32(name.encode()), k)))

    def shocks(self, k: int) -> tuple[Shock, ...]:
        """Return the shocks that begin in spell `k`, in time order, in seconds of the stream."""
        length = self.spell / self.rate
        generator = self._generator("mix.shock", k)
        starts = np.sort(generator.random(generator.poisson(self.settings.shock_rate * length)))
        return tuple(draw_shock(self.settings.shock, (k + u) * length, generator) for u in starts.tolist())

    def level(self, k: int) -> float:
        """Return the vibration of spell `k`, g rms."""
        levels = self.settings.vibration_g
        return levels[int(self._generator("mix.level", k).integers(len(levels)))]

    def read_spell(self, k: int) -> Single:
        """Return spell `k`, shape (spell, axes), m/s²; columns are contiguous."""
        n, settings = self.spell, self.settings
        elevation = radians(self._generator("mix.elevation", k).uniform(*settings.elevation_deg))
        rest = (G0 * sin(elevation), 0.0, -G0 * cos(elevation))
        level = self.level(k)
        columns = np.empty((len(self.axes), n), np.float32)
        for column, axis in zip(columns, self.axes, strict=True):
            self._generator(f"mix.noise.{axis}", k).standard_normal(dtype=np.float32, out=column)
            np.multiply(column, np.float32(settings.sigma_g * G0), out=column)
            np.add(column, np.float32(rest[axis]), out=column)
            if level > 0.0:
                np.add(column, self._vibration(level, axis, k), out=column)
        self._strike(columns, k)
        limit = np.float32(settings.clip_g * G0)
        np.clip(columns, -limit, limit, out=columns)
        return columns.T

    def _vibration(self, level: float, axis: int, k: int) -> Single:
        noise = band_noise(self.spell, self.rate, self.settings.band_hz, self._generator(f"mix.vibration.{axis}", k))
        noise *= np.float32(level * G0)
        m = max(1, round(FADE * self.rate))
        fade = (np.sin(pi / 2 * np.arange(m) / m) ** 2).astype(np.float32)
        noise[:m] *= fade
        noise[-m:] *= fade[::-1]
        return noise

    def _strike(self, columns: Single, k: int) -> None:
        """Add the shocks where they fall, also those that began in the spell before and ring on."""
        begin, end = k * self.spell, (k + 1) * self.spell
        for shock in (self.shocks(k - 1) if k > 0 else ()) + self.shocks(k):
            first, last = max(begin, ceil(shock.start * self.rate)), min(end, ceil(shock.end * self.rate))
            if shock.axis in self.axes and first < last:
                force = shock.force(np.arange(first, last) / self.rate)
                columns[self.axes.index(shock.axis), first - begin : last - begin] += force.astype(np.float32)

    def blocks(self, size: int, samples: int, start: int = 0) -> Iterator[Single]:
        """Read `samples` samples from sample `start` on, in blocks of `size`; the last may be shorter.

        Yields
        ------
        ndarray
            Shape (size, axes), m/s², float32, columns contiguous; the numbers do not depend on `size` and `start`.
            A block is the reader's own.
        """
        if size < 1 or samples < 0 or start < 0:
            raise ValueError("size must be at least 1, samples and start at least 0")
        held, spell = -1, np.empty((0, len(self.axes)), np.float32)
        for begin in range(start, start + samples, size):
            block = np.empty((len(self.axes), min(size, start + samples - begin)), np.float32).T
            done = 0
            while done < len(block):
                k, offset = divmod(begin + done, self.spell)
                if k != held:
                    held, spell = k, self.read_spell(k)
                part = spell[offset : offset + len(block) - done]
                block[done : done + len(part)] = part
                done += len(part)
            yield block


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
