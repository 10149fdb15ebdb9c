"""What breaks in a sensor between two times: faults of its readings, applied one after the other as they are listed.

    dropout     no reading comes
    invalid     a reading comes and is NaN
    stuck       the last value before is repeated, with new time stamps
    spike       z ± s, either sign with the same probability
    offset      z + s

A fault concerns the readings with start ≤ t < stop. A dropout, an invalid reading and a spike hit each of those with
the fault's probability, by itself; a stuck value and an offset are there throughout. This is what arrives at the flight
computer: a spike is not bounded by the range and needs not be a multiple of the least significant bit.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, repeat
from math import nan

import numpy as np

from sensors.noise import BLOCK
from sensors.settings import Fault
from sensors.streams import Streams

Values = tuple[float, ...]
Reading = tuple[float, float, float, float]
Hit = Callable[[float, Values], Values | None]
"""Time stamp and values of a reading to its values, or None if there is none."""


def reading_faults(faults: Sequence[Fault], streams: Streams, name: str) -> Callable[[Reading], Reading | None] | None:
    """Return what turns a reading (t, x, y, z) into the one that arrives, or into None; None if nothing breaks.

    Parameters
    ----------
    faults : sequence of Fault
    streams : Streams
        Fault i draws from the stream "{name}.fault.{i}", one number for each reading it concerns.
    name : str
        Of the sensor.
    """
    hit = _all_faults(faults, streams, name)
    if hit is None:
        return None

    def arriving(reading: Reading) -> Reading | None:
        values = reading[1:]
        hurt = hit(reading[0], values)
        if hurt is values:
            return reading
        if hurt is None:
            return None
        x, y, z = hurt
        return reading[0], x, y, z

    return arriving


def value_faults(faults: Sequence[Fault], streams: Streams, name: str) -> Callable[[float, float], float | None] | None:
    """Return what turns a value read at time t into the one that arrives, or into None; None if nothing breaks.

    As `reading_faults`, for a sensor of one axis: a fault's axis has no meaning.
    """
    hit = _all_faults(faults, streams, name)
    if hit is None:
        return None

    def arriving(t: float, value: float) -> float | None:
        hurt = hit(t, (value,))
        return None if hurt is None else hurt[0]

    return arriving


def _all_faults(faults: Sequence[Fault], streams: Streams, name: str) -> Hit | None:
    hits = [_KINDS[fault.kind](fault, _uniform(streams(f"{name}.fault.{i}"))) for i, fault in enumerate(faults)]
    if len(hits) < 2:
        return hits[0] if hits else None

    def one_after_the_other(t: float, values: Values) -> Values | None:
        hurt: Values | None = values
        for hit in hits:
            if hurt is None:
                break
            hurt = hit(t, hurt)
        return hurt

    return one_after_the_other


def _uniform(generator: np.random.Generator) -> Iterator[float]:
    """Return endless numbers uniform in [0, 1)."""
    return chain.from_iterable(generator.random(BLOCK).tolist() for _ in repeat(None))


def _concerned(fault: Fault, values: Values) -> Iterator[tuple[bool, float]]:
    """Yield each value with whether the fault is on its axis; a single value is on any."""
    everywhere = fault.axis == "all" or len(values) == 1
    for axis, value in zip("xyz", values, strict=False):
        yield everywhere or axis == fault.axis, value


def _dropout(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(t: float, values: Values) -> Values | None:
        return None if fault.start <= t < fault.stop and next(uniform) < fault.probability else values

    return hit


def _invalid(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(t: float, values: Values) -> Values:
        if fault.start <= t < fault.stop and next(uniform) < fault.probability:
            return tuple(nan if on else value for on, value in _concerned(fault, values))
        return values

    return hit


def _spike(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(t: float, values: Values) -> Values:
        if not fault.start <= t < fault.stop:
            return values
        drawn = next(uniform)
        if drawn >= fault.probability:
            return values
        size = fault.size if drawn < 0.5 * fault.probability else -fault.size
        return tuple(value + size if on else value for on, value in _concerned(fault, values))

    return hit


def _offset(fault: Fault, _uniform: Iterator[float]) -> Hit:
    def hit(t: float, values: Values) -> Values:
        if fault.start <= t < fault.stop:
            return tuple(value + fault.size if on else value for on, value in _concerned(fault, values))
        return values

    return hit


def _stuck(fault: Fault, _uniform: Iterator[float]) -> Hit:
    held: Values | None = None  # what it was before; if there was nothing, the first that comes

    def hit(t: float, values: Values) -> Values:
        nonlocal held
        if held is None or not fault.start <= t < fault.stop:
            held = values
        pairs = zip(_concerned(fault, values), held, strict=True)
        return tuple(before if on else value for (on, value), before in pairs)

    return hit


_KINDS: dict[str, Callable[[Fault, Iterator[float]], Hit]] = {
    "dropout": _dropout,
    "invalid": _invalid,
    "stuck": _stuck,
    "spike": _spike,
    "offset": _offset,
}
