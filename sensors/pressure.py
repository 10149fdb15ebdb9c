"""One absolute pressure sensor with its thermometer, a drawn unit, running freely on its own oscillator.

Conversion k takes the window [φ + k/f, φ + k/f + T], where f and T follow the part's oscillator: f = f_0 (1 + e),
T = T_0/(1 + e). Its value is that of the truth at the middle of the window and can be read from its end on:

    z = p(middle),   x = q round(clip(z + s (z - p_ref) + b + d_k + w_k) / q),   y_k = y_{k-1} + a (x - y_{k-1})

with scale error s about the pressure p_ref at which the absolute accuracy is stated, turn-on offset b, drift d
(Gauss-Markov and random walk), white noise w, saturation at the range, step q, and the part's digital filter of
weight a (1: off), which begins with its first value. The thermometer is the same with T for p and without s and d.

The mean over the window is p(middle) + T² p̈/24 + …: equal to second order. The largest p̈ = ρ (v̇² + v v̈) of a launch is
where the push ends: 8 g gone in 60 ms at 26 m/s are 40 kPa/s². At x1 (4.8 ms) the remainder is then 0.04 Pa, far below
the noise; at x32 (69 ms) it is 8 Pa, where the lag of half a window, which is modelled, is 90 Pa.
"""

from math import nan

from sensors.clock import Clock
from sensors.description import PressureDescription, Unit, draw_error
from sensors.noise import constant, gauss_markov, random_walk, rows, white
from sensors.streams import Streams

Conversion = tuple[float, float, float]  # pressure Pa, temperature K, end of conversion s


class DigitalFilter:
    """The filter y += a (x - y) that begins with its first input.

    Parameters
    ----------
    weight : float
        a, above 0 and at most 1; 1 passes everything.
    """

    __slots__ = ("_output", "_weight")

    def __init__(self, weight: float) -> None:
        self._weight = weight
        self._output: float | None = None

    def step(self, x: float) -> float:
        """Take in one value and return the filtered one."""
        before = self._output
        self._output = y = x if before is None or self._weight == 1.0 else before + self._weight * (x - before)
        return y


class PressureSensor:
    """One unit of a pressure sensor, told the truth at the middle of each conversion.

    Parameters
    ----------
    description : PressureDescription
        The part, set to its mode and filter.
    streams : Streams
        Streams "{name}.white", ".drift", ".walk", ".offset", ".scale", ".oscillator", ".clock", ".temperature.white",
        ".temperature.offset" are used.
    name : str
        Prefix of its streams.
    offset_pa : float
        Offset beside that of the unit, Pa.
    unit : {"random", "typical", "ideal"}
        Turn-on errors (offset, scale, oscillator, thermometer): drawn within the datasheet, exactly one standard
        deviation, or none.

    Attributes
    ----------
    due : float
        Middle of the next conversion, s, at which `convert` must be called.
    description : PressureDescription
    offset, scale_error, rate_error, temperature_offset : float
        Turn-on errors of this unit, Pa, Pa/Pa, a fraction and K.
    """

    __slots__ = (
        "_clock", "_error", "_filter", "_half", "_pending", "_ready", "_temperature_error", "_temperature_filter",
        "description", "due", "offset", "rate_error", "scale_error", "temperature_offset",
    )  # fmt: skip

    def __init__(
        self,
        description: PressureDescription,
        streams: Streams,
        *,
        name: str = "pressure",
        offset_pa: float = 0.0,
        unit: Unit = "random",
    ) -> None:
        d = self.description = description
        self.offset = draw_error(streams(f"{name}.offset"), d.offset_sd, d.offset_limit, unit) + offset_pa
        self.scale_error = draw_error(streams(f"{name}.scale"), d.scale_sd, d.scale_limit, unit)
        self.rate_error = draw_error(streams(f"{name}.oscillator"), d.rate_sd, d.rate_limit, unit)
        self.temperature_offset = draw_error(
            streams(f"{name}.temperature.offset"), d.temperature_offset_sd, d.temperature_offset_limit, unit
        )
        speed = 1.0 + self.rate_error
        self._clock = Clock.drawn(d.rate * speed, streams(f"{name}.clock"))
        self._half = 0.5 * d.mode.conversion_time / speed
        self.due = self._clock.due + self._half

        interval = 1.0 / self._clock.rate
        self._error = rows(
            (
                constant(self.offset),
                gauss_markov(streams(f"{name}.drift"), d.drift_sd, d.correlation_time, interval),
                random_walk(streams(f"{name}.walk"), d.random_walk, interval),
                white(streams(f"{name}.white"), d.white_sd),
            )
        )
        self._temperature_error = rows(
            (constant(self.temperature_offset), white(streams(f"{name}.temperature.white"), d.temperature_white_sd))
        )
        self._filter = DigitalFilter(d.iir_weight)
        self._temperature_filter = DigitalFilter(d.iir_weight)
        self._pending: Conversion | None = None
        self._ready: Conversion = (nan, nan, nan)

    def convert(self, pressure: float, temperature: float) -> None:
        """Take in the true pressure (Pa) and temperature (K) at `due`, and set `due` to the next conversion."""
        if self._pending is not None:
            self._ready = self._pending
        d = self.description
        (error,) = self._error()
        (temperature_error,) = self._temperature_error()
        low, high = d.range
        p = pressure + self.scale_error * (pressure - d.reference_pressure) + error
        p = _quantise(min(max(p, low), high), d.resolution)
        kelvin = _quantise(temperature + temperature_error, d.temperature_resolution)
        self._pending = (self._filter.step(p), self._temperature_filter.step(kelvin), self.due + self._half)
        self._clock.tick()
        self.due = self._clock.due + self._half

    def latest(self, t: float) -> Conversion:
        """Return (pressure Pa, temperature K, end s) of the last conversion finished by `t`; NaN before the first."""
        if self._pending is not None and self._pending[2] <= t:
            self._ready = self._pending
            self._pending = None
        return self._ready


def _quantise(value: float, step: float) -> float:
    """Return `value` rounded to a multiple of `step`; NaN stays NaN."""
    return round(value / step) * step if value == value else value  # noqa: PLR0124  # not NaN
