"""Launches from a rail: their distribution, one of them with what is true of it, and recordings of many.

Everything but the noise of a launch is drawn from streams "launch.…" of (seed, index), one for each quantity.
"""

from dataclasses import dataclass, field
from math import ceil, cos, floor, inf, radians, sin
from typing import Annotated, Literal

import numpy as np
from annotated_types import Gt

from sensors.streams import Streams
from uavsim.studies.signals.noise import band_noise, sense
from uavsim.studies.signals.ranges import Array, NonNegative, Range, check
from uavsim.studies.signals.shock import Shock, ShockSettings, draw_shock
from uavsim.studies.signals.stroke import CATAPULT_PEAK, CATAPULT_TIME, Shape, Stroke
from uavsim.truth import STANDARD_GRAVITY as G0

Fault = Literal["none", "hang-fire", "broken"]

CROSSING = 4.5 * G0  # m/s², level at which the delay of a detection begins
BUMP_WITHIN = 0.4  # s before onset, in which a bump trial's bump falls


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
            check(name, getattr(self, name))
        check("duration", self.duration, 1e-3)
        if "trapezoid" in self.shapes and self.rise[1] > self.duration[0] / 2:
            raise ValueError(f"a trapezoid of {self.duration[0]:g} s cannot rise and fall in {self.rise[1]:g} s each")
        check("wait", self.wait, BUMP_WITHIN if self.bump else 0.0)

    @property
    def length(self) -> float:
        """Length of every recording, s: all trials of one distribution are equally long."""
        hang = self.hang[1] if self.fault == "hang-fire" else 0.0
        return self.wait[1] + hang + self.duration[1] + self.after


MEASURED_CATAPULT = LaunchSettings(
    shapes=("catapult",), peak_g=(CATAPULT_PEAK / G0,) * 2, duration=(CATAPULT_TIME,) * 2, rise=(0.020, 0.040)
)


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
