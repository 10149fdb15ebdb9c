"""A three-axis accelerometer: one drawn unit, on the true specific force f(t) in body axes.

    u = f + v                                     vibration is felt like everything else
    T du_f/dt = u - u_f,   T = 1/(2π f_3dB)       bandwidth: one pole, exact for an input linear within a plant step
    z = u_f(t_k),   t_k = φ + k/rate              sampled on its own clock, linear between plant steps
    y = clip(round(((1 + s) z + b + d_k + w_k) / q)) q

with scale error s, turn-on bias b, in-run drift d (Gauss-Markov and random walk), white noise w, least significant
bit q and clipping at the range. The part's decimation filter is steep; in the signal path it is given one pole at the
same -3 dB frequency, which costs a comparable delay; the white noise has the variance that the steep filter leaves,
σ = n √(rate/2).

From scale on everything is kept in counts (units of q), with bias, drift and noise summed beforehand, a block at a
time: a sample is then an interpolation, a gain and an addition. The arithmetic is written out for three axes because a
loop over them costs as much as all the rest.
"""

from math import expm1, pi

from sensors.clock import Clock
from sensors.description import AccelerometerDescription, Triple, Unit, draw_error
from sensors.noise import constant, gauss_markov, random_walk, rows, white
from sensors.streams import Streams
from sensors.vibration import Vibration

# x + ROUND - ROUND is x rounded to a whole number, ties to even, for |x| < 2^51, and NaN for NaN: the sum has no bits
# left below 1 (IEEE 754 double). It costs half of what round() does.
ROUND = 1.5 * 2.0**52


class Accelerometer:
    """One unit of an accelerometer, stepped with the plant.

    Once a plant step: `feel`, then, `while acc.due <= t`, `sample`.

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
    due : float
        Time of the next sample, s.
    description : AccelerometerDescription
    bias, scale_error : (x, y, z)
        Turn-on errors of this unit, m/s² and a fraction.
    """

    __slots__ = (
        "_a", "_b0", "_b1", "_before", "_bottom", "_count", "_error", "_gain", "_lsb", "_now", "_phase", "_rate",
        "_state", "_steps_per_second", "_t", "_top", "_vibration", "bias", "description", "due", "scale_error",
    )  # fmt: skip

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

        self._a, self._b0, self._b1 = one_pole(d.bandwidth, dt)
        self._vibration = Vibration.still() if vibration is None else vibration
        self._before: Triple | None = None
        self._now = self._state = (0.0, 0.0, 0.0)
        self._t = 0.0
        self._steps_per_second = 1.0 / dt

        self._lsb = lsb = d.resolution
        self._top = round(d.range / lsb) - 1.0  # two's complement: -2^(n-1) … 2^(n-1) - 1
        self._bottom = -self._top - 1.0
        sx, sy, sz = self.scale_error
        self._gain = ((1.0 + sx) / lsb, (1.0 + sy) / lsb, (1.0 + sz) / lsb)
        interval = 1.0 / d.rate
        self._error = rows(
            (
                constant(self.bias),
                gauss_markov(streams(f"{name}.drift"), d.drift_sd, d.correlation_time, interval, axes=3),
                random_walk(streams(f"{name}.walk"), d.random_walk, interval, axes=3),
                white(streams(f"{name}.white"), d.noise_sd),
            ),
            scale=1.0 / lsb,
        )

        # The clock's arithmetic is repeated in sample(): a call of its tick() would cost a tenth of the sample.
        clock = Clock.drawn(d.rate, streams(f"{name}.clock"))
        self._rate, self._phase, self._count = clock.rate, clock.phase, 0
        self.due = clock.due

    def feel(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take in the true specific force at plant time `t` (s), body axes, m/s²; the first is taken to be steady."""
        vx, vy, vz = self._vibration.step()
        fx += vx
        fy += vy
        fz += vz
        a, b0, b1 = self._a, self._b0, self._b1
        if self._before is None:
            c = 1.0 - b1
            self._state = (c * fx, c * fy, c * fz)
            self._now = (fx, fy, fz)
        sx, sy, sz = self._state
        self._before = self._now
        self._now = (x, y, z) = (sx + b1 * fx, sy + b1 * fy, sz + b1 * fz)
        self._state = (a * x + b0 * fx, a * y + b0 * fy, a * z + b0 * fz)
        self._t = t

    def sample(self) -> tuple[float, float, float, float]:
        """Return the reading (t, fx, fy, fz) that is due, s and m/s², and set `due` to the next."""
        due = self.due
        w = (self._t - due) * self._steps_per_second  # 0 at the present plant step, 1 at the one before
        x, y, z = self._now
        bx, by, bz = self._before  # type: ignore[misc]  # felt before it is asked
        gx, gy, gz = self._gain
        ex, ey, ez = self._error()
        x = (x + w * (bx - x)) * gx + ex + ROUND - ROUND
        y = (y + w * (by - y)) * gy + ey + ROUND - ROUND
        z = (z + w * (bz - z)) * gz + ez + ROUND - ROUND
        top, bottom, lsb = self._top, self._bottom, self._lsb
        if not bottom <= x <= top:
            x = top if x > top else max(x, bottom)
        if not bottom <= y <= top:
            y = top if y > top else max(y, bottom)
        if not bottom <= z <= top:
            z = top if z > top else max(z, bottom)
        self._count = count = self._count + 1
        self.due = self._phase + count / self._rate
        return due, x * lsb, y * lsb, z * lsb

    def _draw_unit(self, streams: Streams, name: str, extra: Triple, unit: Unit) -> None:
        d = self.description
        generator = streams(f"{name}.bias")
        x, y, z = (draw_error(generator, sd, bound, unit) for sd, bound in zip(d.bias_sd, d.bias_limit, strict=True))
        self.bias = (x + extra[0], y + extra[1], z + extra[2])
        generator = streams(f"{name}.scale")
        x, y, z = (draw_error(generator, d.scale_sd, d.scale_limit, unit) for _ in range(3))
        self.scale_error = (x, y, z)


def one_pole(bandwidth: float, dt: float) -> Triple:
    """Return (a, b0, b1) of y_k = a y_{k-1} + b0 u_{k-1} + b1 u_k, a first-order low-pass of `bandwidth` Hz.

    Exact for an input that is linear between the steps (first-order hold): with ω = 2π f and a = e^{-ω dt},
    b1 = 1 - (1 - a)/(ω dt) and b0 = (1 - a)/(ω dt) - a.
    """
    omega_dt = 2.0 * pi * bandwidth * dt
    passed = -expm1(-omega_dt)
    mean = passed / omega_dt
    return 1.0 - passed, mean - (1.0 - passed), 1.0 - mean
