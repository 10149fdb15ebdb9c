"""A three-axis accelerometer: one drawn unit, on the true specific force f(t) in body axes.

    u = f + v                                     vibration is felt like everything else
    T du_f/dt = u - u_f,   T = 1/(2π f_3dB)       bandwidth: one pole, exact for an input linear within a plant step
    z = u_f(t_k),   t_k = φ + k/rate              sampled on its own clock, linear between plant steps
    y = clip(round(((1 + s) z + b + d_k + w_k) / q)) q

with scale error s, turn-on bias b, in-run drift d (Gauss-Markov and random walk), white noise w, least significant
bit q and clipping at the range. The part's decimation filter is steep; in the signal path it is given one pole at the
same -3 dB frequency, which costs a comparable delay; the white noise has the variance that the steep filter leaves,
σ = n √(rate/2).

From scale on everything is kept in counts (units of q), bias, drift and noise summed beforehand, a block at a time:
a sample is then an interpolation, a gain and an addition. This runs a thousand times a second of flight, so the
arithmetic is written out for three axes (a loop over them costs as much as all the rest) and the unit's state lives
in the local variables of a coroutine (attributes would cost twice as much).
"""

from collections.abc import Callable, Generator

from sensors.accelerometer_description import AccelerometerDescription
from sensors.clock import Clock
from sensors.filters import one_pole
from sensors.noise import constant, gauss_markov, random_walk, rows, white
from sensors.streams import Streams
from sensors.unit import ROUND, Triple, Unit, draw_error
from sensors.vibration import Vibration

Reading = tuple[float, float, float, float]
"""t, s, and specific force x, y, z, m/s²."""
Felt = tuple[float, Triple]
"""Plant time, s, and true specific force then, body axes, m/s²."""


class Accelerometer:
    """One unit of an accelerometer, stepped with the plant.

    Parameters
    ----------
    description : AccelerometerDescription
        The part, set to its range and rate.
    streams : Streams
        Streams "{name}.white", ".drift", ".walk", ".bias", ".scale", ".clock" are used.
    dt : float
        Step of the plant, s.
    bias : float or (x, y, z)
        Offset beside that of the unit, m/s²; one number is for each axis.
    unit : {"random", "typical", "ideal"}
        Turn-on errors (bias, scale): drawn within the datasheet, exactly one standard deviation, or none.
    vibration : Vibration, optional
        What is felt beside the truth.
    name : str
        Prefix of its streams, for a second one.

    Attributes
    ----------
    step : callable
        `step((t, force))`, once a plant step, takes in the true specific force at plant time t, s, body axes, m/s²,
        and returns the readings since the last step, a tuple of (t, fx, fy, fz), s and m/s²: none, one, or more if the
        part is faster than the plant. The first force is taken to have been there before.
    description : AccelerometerDescription
    bias, scale_error : (x, y, z)
        Turn-on errors of this unit, m/s² and a fraction.
    phase : float
        Time of the first sample, s.
    """

    __slots__ = ("bias", "description", "phase", "scale_error", "step")

    step: Callable[[Felt], tuple[Reading, ...]]

    def __init__(
        self,
        description: AccelerometerDescription,
        streams: Streams,
        *,
        dt: float = 1e-3,
        bias: float | Triple = 0.0,
        unit: Unit = "random",
        vibration: Vibration | None = None,
        name: str = "accelerometer",
    ) -> None:
        d = self.description = description
        self._draw_unit(streams, name, (bias, bias, bias) if isinstance(bias, float | int) else bias, unit)
        interval = 1.0 / d.rate
        error = rows(
            (
                constant(self.bias),
                gauss_markov(streams(f"{name}.drift"), d.drift_sd, d.correlation_time, interval, axes=3),
                random_walk(streams(f"{name}.walk"), d.random_walk, interval, axes=3),
                white(streams(f"{name}.white"), d.noise_sd),
            ),
            scale=1.0 / d.resolution,
        )
        clock = Clock.drawn(d.rate, streams(f"{name}.clock"))
        self.phase = clock.phase
        unit_at_work = self._sense(Vibration.still() if vibration is None else vibration, clock, error, dt)
        next(unit_at_work)
        self.step = unit_at_work.send

    def _sense(
        self, vibration: Vibration, clock: Clock, error: Callable[[], list[float]], dt: float
    ) -> Generator[tuple[Reading, ...], Felt, None]:
        """Take in the force of each plant step and yield the readings up to it."""
        lsb = self.description.resolution
        gx, gy, gz = ((1.0 + s) / lsb for s in self.scale_error)
        top = round(self.description.range / lsb) - 1.0  # two's complement: -2^(n-1) … 2^(n-1) - 1
        bottom = -top - 1.0
        a, b0, b1 = one_pole(self.description.bandwidth, dt)
        steps_per_second = 1.0 / dt
        rate, phase, count, due = clock.rate, clock.phase, 0, clock.due

        t, (x, y, z) = yield ()
        vx, vy, vz = vibration.step()
        x, y, z = ox, oy, oz = x + vx, y + vy, z + vz
        sx, sy, sz = (1.0 - b1) * x, (1.0 - b1) * y, (1.0 - b1) * z
        while True:
            readings: tuple[Reading, ...] = ()
            while due <= t:
                w = (t - due) * steps_per_second  # 0 at the present plant step, 1 at the one before
                ex, ey, ez = error()
                nx = (x + w * (ox - x)) * gx + ex + ROUND - ROUND
                ny = (y + w * (oy - y)) * gy + ey + ROUND - ROUND
                nz = (z + w * (oz - z)) * gz + ez + ROUND - ROUND
                if not bottom <= nx <= top:
                    nx = top if nx > top else max(nx, bottom)
                if not bottom <= ny <= top:
                    ny = top if ny > top else max(ny, bottom)
                if not bottom <= nz <= top:
                    nz = top if nz > top else max(nz, bottom)
                readings = (*readings, (due, nx * lsb, ny * lsb, nz * lsb))
                count += 1
                due = phase + count / rate
            t, (fx, fy, fz) = yield readings
            vx, vy, vz = vibration.step()
            fx += vx
            fy += vy
            fz += vz
            ox, oy, oz = x, y, z
            x, y, z = sx + b1 * fx, sy + b1 * fy, sz + b1 * fz
            sx, sy, sz = a * x + b0 * fx, a * y + b0 * fy, a * z + b0 * fz

    def _draw_unit(self, streams: Streams, name: str, extra: Triple, unit: Unit) -> None:
        d = self.description
        generator = streams(f"{name}.bias")
        x, y, z = (draw_error(generator, sd, bound, unit) for sd, bound in zip(d.bias_sd, d.bias_limit, strict=True))
        self.bias = (x + extra[0], y + extra[1], z + extra[2])
        generator = streams(f"{name}.scale")
        x, y, z = (draw_error(generator, d.scale_sd, d.scale_limit, unit) for _ in range(3))
        self.scale_error = (x, y, z)
