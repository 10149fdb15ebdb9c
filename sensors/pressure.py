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

from collections.abc import Callable
from math import nan

from sensors.clock import Clock
from sensors.filters import DigitalFilter
from sensors.noise import constant, gauss_markov, random_walk, values, white
from sensors.pressure_description import PressureDescription
from sensors.streams import Streams
from sensors.unit import Unit, draw_error, quantise

Conversion = tuple[float, float, float]  # pressure Pa, temperature K, end of conversion s
Truth = Callable[[float], tuple[float, float]]  # time s -> pressure at the port Pa, temperature K


class PressureSensor:
    """One unit of a pressure sensor, which looks at the truth at the middle of each conversion.

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
    end : float
        End of the conversion under way, s.
    description : PressureDescription
    offset, scale_error, rate_error, temperature_offset : float
        Turn-on errors of this unit, Pa, Pa/Pa, a fraction and K.
    """

    __slots__ = (
        "_count", "_error", "_filters", "_first_end", "_half", "_high", "_low", "_rate", "_ready", "_reference",
        "_step", "_temperature_error", "_temperature_step", "description", "end", "offset", "rate_error",
        "scale_error", "temperature_offset",
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
        clock = Clock.drawn(d.rate * speed, streams(f"{name}.clock"))
        self._rate, self._count = clock.rate, 0
        self._half = 0.5 * d.mode.conversion_time / speed
        self.end = self._first_end = clock.due + 2.0 * self._half

        interval = 1.0 / self._rate
        self._error = values(
            (
                constant(self.offset),
                gauss_markov(streams(f"{name}.drift"), d.drift_sd, d.correlation_time, interval),
                random_walk(streams(f"{name}.walk"), d.random_walk, interval),
                white(streams(f"{name}.white"), d.white_sd),
            )
        )
        self._temperature_error = values(
            (constant(self.temperature_offset), white(streams(f"{name}.temperature.white"), d.temperature_white_sd))
        )
        self._low, self._high = d.range
        self._reference = d.reference_pressure
        self._step, self._temperature_step = d.resolution, d.temperature_resolution
        off = d.iir_weight == 1.0
        self._filters = None if off else (DigitalFilter(d.iir_weight), DigitalFilter(d.iir_weight))
        self._ready: Conversion = (nan, nan, nan)

    def read(self, t: float, truth: Truth) -> Conversion:
        """Return the last conversion finished by `t`.

        Parameters
        ----------
        t : float
            Time of the reading, s; not before the last one.
        truth : callable
            Gives the true pressure at the port, Pa, and temperature, K, at the middle of a conversion since the last
            reading.

        Returns
        -------
        tuple of float
            Pressure, Pa, temperature, K, end of the conversion, s; NaN before the first.
        """
        while self.end <= t:
            end, error, temperature_error = self.end, self._error(), self._temperature_error()
            self._count = count = self._count + 1
            self.end = self._first_end + count / self._rate
            if self.end <= t and self._filters is None:
                continue  # nobody will see it: the next one is finished too
            pressure, temperature = truth(end - self._half)
            pressure += self.scale_error * (pressure - self._reference) + error
            pressure = quantise(min(max(pressure, self._low), self._high), self._step)
            temperature = quantise(temperature + temperature_error, self._temperature_step)
            if self._filters is not None:
                pressure, temperature = self._filters[0].step(pressure), self._filters[1].step(temperature)
            self._ready = (pressure, temperature, end)
        return self._ready
