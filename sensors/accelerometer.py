"""A three-axis accelerometer: one drawn unit, on the true specific force f(t) at its place, body axes.

Continuous, at the plant's steps and linear between them:

    u = Rᵀ f                                       f with all vibration in it; R: attitude of the case
    c = (I + C) (u + k₂ u² + k₃ u³)                nonlinearity, each axis: k₂ rectifies vibration; cross-axis
    h = low-pass(c)                                one or two poles, exact (`sensors.filters`)
    z_k = h(t_k - D - δ_k)                         age D of the signal at its time stamp, with jitter δ
    t_k = φ + k/(f₀ (1 + e)) + j_k                 its own clock, sampled at any instant (`sensors.clock`)

or, of a part with poles = 0, z_k = mean of c over the interval 1/(f₀ (1 + e)) that ends at t_k - D - δ_k. Each sample:

    y = (1 + s + s' ΔT) z + b + b' ΔT + d_k + r_k + w_k       ΔT: die above 25 °C (`sensors.thermal`)
    reading = q round(clip(y / q))                 two's complement: -2^(n-1) … 2^(n-1) - 1 steps
    fault(reading)                                 dropout, invalid, stuck, spike, offset (`sensors.faults`)

with scale error s, cross-axis sensitivity C (no diagonal; low-pass and delay are the same for all axes, so it may as
well stand before them), turn-on bias b, temperature coefficients s' and b', drift d (Gauss-Markov or flicker), random
walk r and least significant bit q. White noise w is that of the datasheet's density behind the part's low-pass at the
output rate. A part whose low-pass is at half the rate has a steep decimation filter; in the signal path it is given one
pole at the same -3 dB frequency, which costs a comparable delay, and the noise has the variance that the steep filter
leaves, σ = n √(rate/2). k₃ follows from the datasheet's nonlinearity, the greatest
deviation from the best straight line as a share of the range R: k₃ u³ is off by k₃ R³/4 from its best line (the
Chebyshev polynomial of third order), so k₃ = 4 share/R².

What is not a number is read as such, and forgotten two readings (or steps of the plant) after the truth is one again,
the delay on top. A term that is off draws nothing from another's stream.

From scale on everything is kept in counts (units of q), and bias, drift and noise are summed beforehand, a block at a
time: a sample is then an interpolation, a gain and an addition. The die's temperature is looked at once a block, about
once a second. This runs a thousand times a second of flight, so the arithmetic is written out for three axes (a loop
over them costs as much as all the rest), the unit's state lives in the local variables of a coroutine (attributes
would cost twice as much), and what few parts need is a stage that is None where it is not.
"""

from collections.abc import Callable, Generator, Iterator, Sequence
from functools import partial, reduce
from itertools import chain, islice, repeat
from math import inf

import numpy as np

from sensors.accelerometer_description import AccelerometerDescription
from sensors.clock import Clock
from sensors.faults import Reading, reading_faults
from sensors.filters import History, Stage, lag, low_pass, settled, two_pole
from sensors.mounting import IDENTITY, Matrix, attitude, linear, product, transposed
from sensors.noise import BLOCK, Array, drift, random_walk, shaped
from sensors.settings import AccelerometerSettings, Fault, ThermalSettings
from sensors.streams import Streams
from sensors.surroundings import Surroundings
from sensors.thermal import Die
from sensors.unit import MOST_RATE_ERROR, REFERENCE_TEMPERATURE, ROUND, Triple, Unit, clip, draw_error

Felt = tuple[float, Triple]
"""Plant time, s, and true specific force then, vibration included, body axes, m/s²."""
Step = Callable[[Felt], tuple[Reading, ...]]
Arrive = Callable[[Reading], Reading | None]
Stages = tuple[Stage | None, Callable[[Triple], None] | None, Callable[[float], Triple] | None]

WIDEST_DELAY = 5.0  # standard deviations at which the jitter of the delay is cut


class Accelerometer:
    """One unit of an accelerometer, stepped with the plant.

    Parameters
    ----------
    description : AccelerometerDescription
        The part, set to its range, rate and filter.
    streams : Streams
        Streams "{name}.white", ".drift", ".walk", ".bias", ".bias_tc", ".scale", ".scale_tc", ".cross_axis",
        ".nonlinearity", ".rectification", ".oscillator", ".clock", ".jitter", ".delay" and ".fault.0", … are used.
    dt : float
        Step of the plant, s.
    bias : float or (x, y, z)
        Offset beside that of the unit, m/s²; one number is for each axis.
    unit : {"random", "typical", "ideal"}
        The unit's errors (bias, scale, their temperature coefficients, cross-axis, nonlinearity, rectification, rate):
        drawn within the datasheet, exactly one standard deviation, or none.
    name : str
        Prefix of its streams, for a second one.
    mounting : 3x3 rows
        Attitude R of the case in the body (`sensors.mounting.attitude`).
    rate_error : float
        Error of the output rate beside that of the unit, a fraction.
    jitter : float
        Standard deviation of the sampling instants, which time stamps carry, s.
    delay, delay_jitter : float
        Age of the signal at its time stamp and its standard deviation, s; it is never below 0.
    thermal : ThermalSettings, optional
        Of the die; None is without self-heating.
    surroundings : Surroundings, optional
        The air, whose temperature is asked for about once a second. None is 25 °C throughout.
    faults : sequence of Fault
        What breaks.

    Attributes
    ----------
    step : callable
        `step((t, force))`, once a plant step, takes in the true specific force at plant time t, s, body axes, m/s²,
        and returns the readings since the last step, a tuple of (t, fx, fy, fz), s and m/s²: none, one, or more if the
        part is faster than the plant. The first force is taken to have been there before.
    description : AccelerometerDescription
    bias, bias_tc : (x, y, z)
        Turn-on bias of this unit, m/s², and its temperature coefficient, (m/s²)/K.
    scale_error, scale_tc : (x, y, z)
        A fraction, and 1/K.
    cross_axis : 3x3 rows
        C: how much of the column's axis each row's axis reads; its diagonal is 0.
    rectification, nonlinearity : (x, y, z)
        k₂, 1/(m/s²), and k₃, 1/(m/s²)².
    rate_error : float
        Of the output rate, a fraction.
    phase : float
        Time of the first sample, without jitter, s.

    Raises
    ------
    ValueError
        For a negative delay or jitter, or a rate that is not above 0.
    """

    __slots__ = (
        "_distortion", "_jitter", "_name", "_streams", "_surroundings", "_thermal", "bias",
        "bias_tc", "cross_axis", "description", "nonlinearity", "phase", "rate_error", "rectification", "scale_error",
        "scale_tc", "step",
    )  # fmt: skip

    step: Step

    def __init__(
        self,
        description: AccelerometerDescription,
        streams: Streams,
        *,
        dt: float = 1e-3,
        bias: float | Triple = 0.0,
        unit: Unit = "random",
        name: str = "accelerometer",
        mounting: Matrix = IDENTITY,
        rate_error: float = 0.0,
        jitter: float = 0.0,
        delay: float = 0.0,
        delay_jitter: float = 0.0,
        thermal: ThermalSettings | None = None,
        surroundings: Surroundings | None = None,
        faults: Sequence[Fault] = (),
    ) -> None:
        if not 0.0 <= delay < inf or not 0.0 <= delay_jitter < inf:
            raise ValueError(f"delay and delay_jitter must be at least 0 s and finite, not {delay!r}, {delay_jitter!r}")
        self.description = description
        self._streams, self._name, self._jitter = streams, name, jitter
        self._draw_unit((bias, bias, bias) if isinstance(bias, float | int) else bias, rate_error, unit)
        self._thermal = ThermalSettings() if thermal is None else thermal
        self._surroundings = surroundings
        self._distortion = distortion(transposed(mounting), self.rectification, self.nonlinearity, self.cross_axis)
        self.phase = self._clock().phase
        arrive = reading_faults(faults, streams, name)
        unit_at_work = self._sense(dt, delay, delay_jitter, arrive)
        next(unit_at_work)
        self.step = unit_at_work.send

    @classmethod
    def from_settings(
        cls,
        settings: AccelerometerSettings,
        streams: Streams,
        *,
        dt: float = 1e-3,
        surroundings: Surroundings | None = None,
        name: str = "accelerometer",
    ) -> "Accelerometer":
        """Return the accelerometer that a scenario chooses; what is not in the settings is as of the class.

        The settings' position and vibration scale are matters of the plant and of the vibration.
        """
        return cls(
            settings.description(),
            streams,
            dt=dt,
            bias=settings.bias,
            unit=settings.unit,
            name=name,
            mounting=product(attitude(*settings.mounting_deg), attitude(*settings.mounting_error_deg)),
            rate_error=0.01 * settings.rate_error_percent,
            jitter=settings.jitter,
            delay=settings.delay,
            delay_jitter=settings.delay_jitter,
            thermal=settings.thermal,
            surroundings=surroundings,
            faults=settings.faults,
        )

    def at_rest(self, force: Triple) -> Iterator[Array]:
        """Yield what this unit reads of a steady force from time 0 on, without vibration and before any fault.

        Bit for bit what `step` would give, about a second of readings at a time, so that hours take seconds. It has
        streams of its own: neither this nor `step` is changed by the other.

        Parameters
        ----------
        force : (x, y, z)
            True specific force, body axes, m/s².

        Yields
        ------
        numpy.ndarray
            Shape (n, 4): t, fx, fy, fz, s and m/s².
        """
        sampled = np.array(force if self._distortion is None else self._distortion(*force))
        lsb, bottom, top = self._steps()
        clock = self._clock()
        times = chain((clock.due,), clock.times)
        for gain, error in self._errors():
            counts = np.clip(sampled * gain + error + ROUND - ROUND, bottom, top)
            yield np.column_stack((np.fromiter(islice(times, len(error)), float), counts * lsb))

    def _sense(
        self, dt: float, delay: float, delay_jitter: float, arrive: Arrive | None
    ) -> Generator[tuple[Reading, ...], Felt, None]:
        """Take in the force of each plant step and yield the readings up to it."""
        distort = self._distortion
        a, m = lag(self.description.bandwidth, dt)
        steps_per_second = 1.0 / dt
        lsb, bottom, top = self._steps()
        ball = top * top
        clock = self._clock()
        times = chain((clock.due,), clock.times)
        older = _delays(delay, delay_jitter, self._streams(f"{self._name}.delay")).__next__

        t, (fx, fy, fz) = yield ()
        first = fx, fy, fz = (fx, fy, fz) if distort is None else distort(fx, fy, fz)
        x, y, z = ox, oy, oz = first
        lx = ly = lz = 0.0  # error of the low-pass
        smooth, keep, recall = self._stages(first, dt, delay, delay_jitter)
        readings: tuple[Reading, ...] = ()
        for (gx, gy, gz), errors in self._errors():
            for ex, ey, ez, due in zip(*errors.T.tolist(), times, strict=False):
                while t < due:
                    px, py, pz = fx, fy, fz
                    t, (fx, fy, fz) = yield readings
                    readings = ()
                    if distort is not None:
                        fx, fy, fz = distort(fx, fy, fz)
                    ox, oy, oz = x, y, z
                    if smooth is None:
                        lx, ly, lz = a * lx - m * (fx - px), a * ly - m * (fy - py), a * lz - m * (fz - pz)
                        x, y, z = fx + lx, fy + ly, fz + lz
                    else:
                        x, y, z = signal = smooth(fx, fy, fz)
                        if keep is not None:
                            keep(signal)
                if recall is None:
                    w = (t - due) * steps_per_second  # 0 at the present plant step, 1 at the one before
                    zx, zy, zz = x + w * (ox - x), y + w * (oy - y), z + w * (oz - z)
                else:
                    zx, zy, zz = recall(t - due + older())
                nx = zx * gx + ex + ROUND - ROUND
                ny = zy * gy + ey + ROUND - ROUND
                nz = zz * gz + ez + ROUND - ROUND
                if not nx * nx + ny * ny + nz * nz < ball:  # inside the ball nothing saturates: one look for three
                    nx, ny, nz = clip(nx, bottom, top), clip(ny, bottom, top), clip(nz, bottom, top)
                    lx, ly, lz = settled(lx), settled(ly), settled(lz)
                reading = (due, nx * lsb, ny * lsb, nz * lsb)
                arrived = reading if arrive is None else arrive(reading)
                if arrived is not None:
                    readings += (arrived,)

    def _stages(self, first: Triple, dt: float, delay: float, jitter: float) -> Stages:
        """Return a low-pass, what keeps its signal step by step, and what recalls it by its age.

        All None for one pole, which is written out, sampled between the last two steps.
        """
        d = self.description
        window = 0.0 if d.poles else self._interval
        remembered = delay > 0.0 or jitter > 0.0 or window > 0.0
        if d.poles == 1 and not remembered:
            return None, None, None
        a, m = two_pole(d.bandwidth, dt) if d.poles == 2 else lag(d.bandwidth if d.poles else inf, dt)
        smooth = low_pass(a, m, first)
        if not remembered:
            return smooth, None, None
        history = History(dt, delay + WIDEST_DELAY * jitter + window + dt, first)
        return smooth, history.keep, partial(history.mean, window) if window else history.at

    def _errors(self) -> Iterator[tuple[Triple, Array]]:
        """Yield the gain, counts per m/s², and rows of what is added, counts, for about a second each time."""
        counts = 1.0 / self.description.resolution
        heated = any((*self.bias_tc, *self.scale_tc))
        die, around = Die(self._thermal), self._surroundings
        length = BLOCK
        while heated and length > max(1.0, self.description.rate):
            length //= 2
        k, warmer = 0, 0.0
        for noise in self._noise():
            for first in range(0, BLOCK, length):
                if heated:
                    outside = REFERENCE_TEMPERATURE if around is None else around.flow()[2]
                    warmer = die.step(self.phase + k * self._interval, outside) - REFERENCE_TEMPERATURE
                bias = [b + tc * warmer for b, tc in zip(self.bias, self.bias_tc, strict=True)]
                gain = [(1.0 + s + tc * warmer) * counts for s, tc in zip(self.scale_error, self.scale_tc, strict=True)]
                yield _triple(gain), (noise[first : first + length] + np.tile(bias, (length, 1))) * counts
                k += length

    def _noise(self) -> Iterator[Array]:
        """Yield blocks of drift, random walk and white noise, m/s²."""
        d, stream, interval = self.description, self._streams, self._interval
        sources = []
        if d.drift_sd:
            generator = stream(f"{self._name}.drift")
            sources.append(drift(generator, d.errors.drift_model, d.drift_sd, d.correlation_time, interval, axes=3))
        if d.random_walk:
            sources.append(random_walk(stream(f"{self._name}.walk"), d.random_walk, interval, axes=3))
        if any(d.white_sd):
            generator = stream(f"{self._name}.white")
            sources.append(shaped(generator, d.white_sd, d.noise_bandwidth, d.rate, d.poles or 1))
        if not sources:
            return repeat(np.zeros((BLOCK, 3)))
        return (reduce(np.add, blocks) for blocks in zip(*sources, strict=True))

    def _clock(self) -> Clock:
        return Clock.drawn(
            self.description.rate,
            self._streams(f"{self._name}.clock"),
            error=self.rate_error,
            jitter=self._jitter,
            jitter_generator=self._streams(f"{self._name}.jitter"),
        )

    @property
    def _interval(self) -> float:
        """Time between readings, s."""
        return 1.0 / (self.description.rate * (1.0 + self.rate_error))

    def _steps(self) -> Triple:
        """Return the least significant bit, m/s², and the first and last count: two's complement."""
        d = self.description
        half = float(round(d.range / d.resolution)) if d.errors.saturation else inf
        return d.resolution, -half, half - 1.0

    def _draw_unit(self, extra: Triple, rate_error: float, unit: Unit) -> None:
        d = self.description

        def draw(term: str, sds: Sequence[float], limits: Sequence[float]) -> list[float]:
            generator = self._streams(f"{self._name}.{term}")
            return [draw_error(generator, sd, limit, unit) for sd, limit in zip(sds, limits, strict=True)]

        x, y, z = draw("bias", d.bias_sd, d.bias_limit)
        self.bias = (x + extra[0], y + extra[1], z + extra[2])
        self.bias_tc = _triple(draw("bias_tc", d.bias_tc_sd, d.bias_tc_limit))
        self.scale_error = _triple(draw("scale", [d.scale_sd] * 3, [d.scale_limit] * 3))
        self.scale_tc = _triple(draw("scale_tc", [d.scale_tc_sd] * 3, [d.scale_tc_limit] * 3))
        xy, xz, yx, yz, zx, zy = draw("cross_axis", [d.cross_axis_sd] * 6, [d.cross_axis_limit] * 6)
        self.cross_axis = ((0.0, xy, xz), (yx, 0.0, yz), (zx, zy, 0.0))
        self.rectification = _triple(draw("rectification", [d.rectification_sd] * 3, [inf] * 3))
        cubic_sd = 4.0 * d.nonlinearity_sd / d.range**2
        self.nonlinearity = _triple(draw("nonlinearity", [cubic_sd] * 3, [inf] * 3))
        sd, limit = min(d.rate_sd, MOST_RATE_ERROR), min(d.rate_limit, MOST_RATE_ERROR)
        self.rate_error = draw("oscillator", [sd], [limit])[0] + rate_error


def distortion(case: Matrix, quadratic: Triple, cubic: Triple, cross_axis: Matrix) -> Stage | None:
    """Return what turns the force in body axes into what the three channels make of it; None if it is the same.

    Parameters
    ----------
    case : 3x3 rows
        Rᵀ, into the axes of the case.
    quadratic, cubic : (x, y, z)
        k₂ and k₃ of the channels.
    cross_axis : 3x3 rows
        C; its diagonal is 0.
    """
    (_, xy, xz), (yx, _, yz), (zx, zy, _) = cross_axis
    if not any((*quadratic, *cubic)):
        return linear(product(((1.0, xy, xz), (yx, 1.0, yz), (zx, zy, 1.0)), case))
    (axx, axy, axz), (ayx, ayy, ayz), (azx, azy, azz) = case
    (qx, qy, qz), (cx, cy, cz) = quadratic, cubic

    def distort(x: float, y: float, z: float) -> Triple:
        x, y, z = axx * x + axy * y + axz * z, ayx * x + ayy * y + ayz * z, azx * x + azy * y + azz * z
        x, y, z = x + x * x * (qx + cx * x), y + y * y * (qy + cy * y), z + z * z * (qz + cz * z)
        return x + xy * y + xz * z, y + yx * x + yz * z, z + zx * x + zy * y

    return distort


def _delays(mean: float, sd: float, generator: np.random.Generator) -> Iterator[float]:
    """Return the delays of successive readings, s, none below 0 or more than 5 sd above the mean."""
    if sd == 0.0:
        return repeat(mean)
    most = mean + WIDEST_DELAY * sd
    drawn = (np.clip(mean + sd * generator.standard_normal(BLOCK), 0.0, most) for _ in repeat(None))
    return chain.from_iterable(block.tolist() for block in drawn)


def _triple(values: Sequence[float]) -> Triple:
    x, y, z = values
    return x, y, z
