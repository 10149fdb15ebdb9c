"""One absolute pressure sensor with its thermometer, a drawn unit, running freely on its own oscillator.

Conversion k takes the window [φ + k/f, φ + k/f + T], where f and T follow the part's oscillator: f = f_0 (1 + e),
T = T_0/(1 + e). Its value is that of the truth at the middle of the window, or the mean over it, whichever the caller
gives, and can be read from the window's end on:

    z = p + n·f                                                     felt by the membrane
    x = q round(clip(z + s (z - p_ref) + b + j + c (T_d - 25 °C) + d_k + w_k)/q)
    y_k = y_{k-1} + a (x - y_{k-1})

with the membrane's sensitivity n to the specific force f, a vector along its normal (added where the force is known,
in `AirDataHead`), scale error s about the pressure p_ref at which the absolute accuracy is stated, turn-on offset b,
shift j by soldering, temperature coefficient c of the offset with the temperature T_d of the die, drift d (Gauss-Markov
or 1/f, and random walk), white noise w, saturation at the range, step q, and the part's digital filter of weight a
(1: off), which begins with its first value. The thermometer reads the die: T_d, which the part's own heat keeps above
the air, with an offset, noise and steps of its own, and the same filter. Faults come last, on what the bus carries.

The mean over the window is p(middle) + T² p̈/24 + …: equal to second order. The largest p̈ = ρ (v̇² + v v̈) of a launch is
where the push ends: 8 g gone in 60 ms at 26 m/s are 40 kPa/s². At x1 (4.8 ms) the remainder is then 0.04 Pa, far below
the noise; at x32 (69 ms) it is 8 Pa, where the lag of half a window is 90 Pa.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from itertools import accumulate
from math import inf, nan

import numpy as np

from sensors.clock import Clock
from sensors.faults import value_faults
from sensors.filters import DigitalFilter
from sensors.noise import Array, constant, drift, random_walk, values, white
from sensors.pressure_description import PressureDescription
from sensors.settings import Fault, ThermalSettings
from sensors.streams import Streams
from sensors.thermal import Die
from sensors.unit import (
    MOST_RATE_ERROR,
    NO_BATCH,
    REFERENCE_TEMPERATURE,
    ROUND,
    Batch,
    Triple,
    Unit,
    clip,
    draw_alike,
    draw_error,
    unit_vector,
)

Conversion = tuple[float, float, float]  # pressure Pa, temperature K, end of conversion s
Truth = Callable[[float], tuple[float, float]]  # time s -> pressure at the sensor Pa, temperature K
Blocks = list[Iterator[Array]]


class PressureSensor:
    """One unit of a pressure sensor, which looks at the truth once a conversion.

    Parameters
    ----------
    description : PressureDescription
        The part, set to its mode and filter.
    streams : Streams
        Streams "{name}.white", ".drift", ".walk", ".offset", ".solder", ".offset_tc", ".acceleration", ".scale",
        ".oscillator", ".clock", ".temperature.white", ".temperature.offset" and ".fault.0", … are used.
    name : str
        Prefix of its streams.
    offset_pa : float
        Offset beside that of the unit, Pa.
    unit : {"random", "typical", "ideal"}
        Turn-on errors (offset, solder, temperature coefficient, acceleration, scale, oscillator, thermometer): drawn
        within the datasheet, exactly one standard deviation, or none.
    normal : (x, y, z)
        Of the membrane, body axes, of any length.
    rate_error_percent : float
        Error of the oscillator beside that of the unit, %.
    thermal : ThermalSettings, optional
        Temperature of the die; without them it is the air's.
    faults : sequence of Fault
        What happens to its readings of pressure. A reading dropped is not delivered: the last one stays.
    batch : Batch
        What its temperature coefficient has in common with that of others.

    Attributes
    ----------
    end : float
        End of the conversion under way, s.
    half_window : float
        Half the length of a conversion, s.
    description : PressureDescription
    offset, solder, scale_error, rate_error, temperature_offset : float
        Turn-on errors of this unit, Pa, Pa, Pa/Pa, a fraction and K.
    offset_tc : float
        Its temperature coefficient of the offset, Pa/K.
    acceleration : (x, y, z)
        Its sensitivity to specific force, body axes, Pa/(m/s²).

    Raises
    ------
    ValueError
        If the normal has no length.
    """

    __slots__ = (
        "_count", "_die", "_error", "_fault", "_faults", "_filters", "_first_end", "_high", "_low", "_name", "_rate",
        "_ready", "_reference", "_skips", "_step", "_streams", "_temperature_error", "_temperature_step", "_thermal",
        "_weight", "acceleration", "description", "end", "half_window", "offset", "offset_tc", "rate_error",
        "scale_error", "solder", "temperature_offset",
    )  # fmt: skip

    def __init__(
        self,
        description: PressureDescription,
        streams: Streams,
        *,
        name: str = "pressure",
        offset_pa: float = 0.0,
        unit: Unit = "random",
        normal: Triple = (0.0, 0.0, 1.0),
        rate_error_percent: float = 0.0,
        thermal: ThermalSettings | None = None,
        faults: Sequence[Fault] = (),
        batch: Batch = NO_BATCH,
    ) -> None:
        d = self.description = description
        self._streams, self._name, self._thermal, self._faults = streams, name, thermal, tuple(faults)
        self._draw_unit(offset_pa, unit, unit_vector(normal, "normal of a membrane"), batch)
        speed = 1.0 + self.rate_error + rate_error_percent / 100.0
        clock = Clock.drawn(d.rate * speed, streams(f"{name}.clock"))
        self._rate, self._count = clock.rate, 0
        self.half_window = 0.5 * d.mode.conversion_time / speed
        self.end = self._first_end = clock.due + 2.0 * self.half_window

        self._error, self._temperature_error = values(self._pressure_errors()), values(self._temperature_errors())
        self._low, self._high = d.range if d.errors.saturation else (-inf, inf)
        self._reference = d.reference_pressure
        self._step, self._temperature_step = d.resolution, d.temperature_step
        off = d.iir_weight == 1.0
        self._filters = None if off else (DigitalFilter(d.iir_weight), DigitalFilter(d.iir_weight))
        self._die = None if thermal is None else Die(thermal)
        self._fault = value_faults(self._faults, streams, name)
        self._weight = d.iir_weight
        self._skips = off and self._fault is None
        self._ready: Conversion = (nan, nan, nan)

    def read(self, t: float, truth: Truth) -> Conversion:
        """Return the last conversion delivered by `t`.

        Parameters
        ----------
        t : float
            Time of the reading, s; not before the last one.
        truth : callable
            Gives the true pressure at the sensor, Pa, and temperature of the air, K, for the conversion around a time,
            the middle of one since the last reading.

        Returns
        -------
        tuple of float
            Pressure, Pa, temperature, K, end of the conversion, s; NaN before the first.
        """
        following = self.end
        while following <= t:
            end, error, temperature_error = following, self._error(), self._temperature_error()
            count = self._count = self._count + 1
            following = self.end = self._first_end + count / self._rate
            if following <= t and self._skips:
                continue  # nobody will see it: the next one is finished too
            middle = end - self.half_window
            pressure, temperature = truth(middle)
            if self._die is not None:
                temperature = self._die.step(middle, temperature)
            pressure += self.scale_error * (pressure - self._reference) + error
            pressure += self.offset_tc * (temperature - REFERENCE_TEMPERATURE)
            if not self._low <= pressure <= self._high:
                pressure = clip(pressure, self._low, self._high)
            step = self._step
            pressure = (pressure / step + ROUND - ROUND) * step
            step = self._temperature_step
            temperature = ((temperature + temperature_error) / step + ROUND - ROUND) * step
            if self._filters is not None:
                pressure, temperature = self._filters[0].step(pressure), self._filters[1].step(temperature)
            if self._fault is not None:
                arrived = self._fault(end, pressure)
                if arrived is None:
                    continue
                pressure = arrived
            self._ready = (pressure, temperature, end)
        return self._ready

    def at_rest(self, pressure: float, temperature: float) -> Iterator[tuple[Array, Array, Array]]:
        """Yield blocks of what `read` gives in still air from switching on, bit for bit, many times as fast.

        Nothing of the unit's own state is used or changed.

        Parameters
        ----------
        pressure, temperature : float
            Of the air, Pa and K.

        Yields
        ------
        tuple of numpy.ndarray
            Ends of conversions, s, pressures, Pa, temperatures, K, each of shape (n,): the readings delivered.
        """
        dies = self._dies_at_rest(temperature)
        filters = None if self._filters is None else (_Recursion(self._weight), _Recursion(self._weight))
        fault = value_faults(self._faults, self._streams, self._name)
        errors = zip(_sums(self._pressure_errors()), _sums(self._temperature_errors()), strict=True)
        for block, (error, temperature_error) in enumerate(errors):
            ends = self._first_end + np.arange(block * error.size, (block + 1) * error.size) / self._rate
            die = dies(ends - self.half_window)
            p = pressure + (self.scale_error * (pressure - self._reference) + error)
            p = np.clip(p + self.offset_tc * (die - REFERENCE_TEMPERATURE), self._low, self._high)
            p = (p / self._step + ROUND - ROUND) * self._step
            q = ((die + temperature_error) / self._temperature_step + ROUND - ROUND) * self._temperature_step
            if filters is not None:
                p, q = filters[0].step(p), filters[1].step(q)
            yield (ends, p, q) if fault is None else _delivered(fault, ends, p, q)

    def _dies_at_rest(self, air: float) -> Callable[[Array], Array]:
        """Return what gives the die's temperatures at the middles of conversions in still air."""
        if self._thermal is None:
            return lambda middles: np.full(middles.size, air)
        die = Die(self._thermal)
        return lambda middles: np.array([die.step(t, air) for t in middles.tolist()])

    def _pressure_errors(self) -> Blocks:
        d, name, streams, interval = self.description, self._name, self._streams, 1.0 / self._rate
        model = d.errors.drift_model
        return [
            constant(self.offset + self.solder),
            drift(streams(f"{name}.drift"), model, d.drift_sd, d.correlation_time, interval, axes=1),
            random_walk(streams(f"{name}.walk"), d.random_walk, interval),
            white(streams(f"{name}.white"), d.white_sd),
        ]

    def _temperature_errors(self) -> Blocks:
        noise = white(self._streams(f"{self._name}.temperature.white"), self.description.temperature_white_sd)
        return [constant(self.temperature_offset), noise]

    def _draw_unit(self, offset_pa: float, unit: Unit, normal: Triple, batch: Batch) -> None:
        d = self.description

        def drawn(stream: str, sd: float, limit: float) -> float:
            return draw_error(self._streams(f"{self._name}.{stream}"), sd, limit, unit)

        low, high = d.solder
        shift = drawn("solder", (high - low) / 6.0, (high - low) / 2.0)
        sensitivity = drawn("acceleration", d.acceleration_sd, d.acceleration_limit)
        self.offset = drawn("offset", d.offset_sd, d.offset_limit) + offset_pa
        self.solder = 0.0 if unit == "ideal" else 0.5 * (low + high) + shift
        generator = self._streams(f"{self._name}.offset_tc")
        self.offset_tc = draw_alike(generator, d.offset_tc_sd, d.offset_tc_limit, unit, batch)
        self.scale_error = drawn("scale", d.scale_sd, d.scale_limit)
        self.rate_error = drawn("oscillator", min(d.rate_sd, MOST_RATE_ERROR), min(d.rate_limit, MOST_RATE_ERROR))
        self.temperature_offset = drawn("temperature.offset", d.temperature_offset_sd, d.temperature_offset_limit)
        x, y, z = normal
        self.acceleration = (sensitivity * x, sensitivity * y, sensitivity * z)


class _Recursion:
    """`DigitalFilter` over blocks of finite values, operation by operation the same."""

    __slots__ = ("_last", "_weight")

    def __init__(self, weight: float) -> None:
        self._weight = weight
        self._last: float | None = None

    def step(self, block: Array) -> Array:
        weight = self._weight
        outputs = accumulate(block.tolist(), lambda y, x: y + weight * (x - y), initial=self._last)
        filtered = np.array(list(outputs)[self._last is not None :])
        self._last = float(filtered[-1])
        return filtered


def _sums(sources: Blocks) -> Iterator[Array]:
    """Yield the sums of all sources of one axis, block by block, as `sensors.noise.values` adds them."""
    return (reduce(np.add, blocks)[:, 0] for blocks in zip(*sources, strict=True))


def _delivered(
    fault: Callable[[float, float], float | None], ends: Array, pressures: Array, temperatures: Array
) -> tuple[Array, Array, Array]:
    arrived = [fault(t, value) for t, value in zip(ends.tolist(), pressures.tolist(), strict=True)]
    there = np.array([value is not None for value in arrived])
    return ends[there], np.array([value for value in arrived if value is not None]), temperatures[there]
