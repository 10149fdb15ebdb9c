"""What breaks in a sensor between two times: faults of its readings, applied one after the other as they are listed.

    dropout     no reading comes
    invalid     a reading comes and is NaN
    stuck       the last value before is repeated, with new time stamps
    dead        s, whatever is measured
    spike       z ± s, either sign with the same probability
    offset      z + s

A fault concerns the readings with start ≤ t < stop. A dropout, an invalid reading and a spike hit each of those with
the fault's probability, by itself; a stuck or dead value and an offset are there throughout. This is what arrives at
the flight computer: a spike is not bounded by the range and needs not be a multiple of the least significant bit.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, repeat
from math import nan
from typing import cast

import numpy as np

from sensors.noise import BLOCK
from sensors.settings import Fault
from sensors.streams import Streams

Stamped = tuple[float, ...]
"""Time stamp, s, and one value or three."""
Reading = tuple[float, float, float, float]
Hit = Callable[[Stamped], Stamped | None]
"""What was sent to what arrives, None if that is nothing."""


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
    return cast("Callable[[Reading], Reading | None] | None", _all_faults(faults, streams, name))


def value_faults(faults: Sequence[Fault], streams: Streams, name: str) -> Callable[[float, float], float | None] | None:
    """Return what turns a value read at time t into the one that arrives, or into None; None if nothing breaks.

    As `reading_faults`, for a sensor of one axis: a fault's axis has no meaning.
    """
    hit = _all_faults(faults, streams, name)
    if hit is None:
        return None

    def arriving(t: float, value: float) -> float | None:
        hurt = hit((t, value))
        return None if hurt is None else hurt[1]

    return arriving


def _all_faults(faults: Sequence[Fault], streams: Streams, name: str) -> Hit | None:
    hits = [_KINDS[fault.kind](fault, _uniform(streams(f"{name}.fault.{i}"))) for i, fault in enumerate(faults)]
    if len(hits) < 2:
        return hits[0] if hits else None

    def one_after_the_other(sent: Stamped) -> Stamped | None:
        hurt: Stamped | None = sent
        for hit in hits:
            if hurt is None:
                break
            hurt = hit(hurt)
        return hurt

    return one_after_the_other


def _uniform(generator: np.random.Generator) -> Iterator[float]:
    """Return endless numbers uniform in [0, 1)."""
    return chain.from_iterable(generator.random(BLOCK).tolist() for _ in repeat(None))


def _concerned(fault: Fault, sent: Stamped) -> Iterator[tuple[bool, float]]:
    """Yield the time stamp and each value with whether the fault is on it; a single value is on any axis."""
    everywhere = fault.axis == "all" or len(sent) == 2
    for place, value in zip("txyz", sent, strict=False):
        yield place != "t" and (everywhere or place == fault.axis), value


def _dropout(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(sent: Stamped) -> Stamped | None:
        return None if fault.start <= sent[0] < fault.stop and next(uniform) < fault.probability else sent

    return hit


def _invalid(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(sent: Stamped) -> Stamped:
        if fault.start <= sent[0] < fault.stop and next(uniform) < fault.probability:
            return tuple(nan if on else value for on, value in _concerned(fault, sent))
        return sent

    return hit


def _spike(fault: Fault, uniform: Iterator[float]) -> Hit:
    def hit(sent: Stamped) -> Stamped:
        if not fault.start <= sent[0] < fault.stop:
            return sent
        drawn = next(uniform)
        if drawn >= fault.probability:
            return sent
        size = fault.size if drawn < 0.5 * fault.probability else -fault.size
        return tuple(value + size if on else value for on, value in _concerned(fault, sent))

    return hit


def _offset(fault: Fault, _uniform: Iterator[float]) -> Hit:
    def hit(sent: Stamped) -> Stamped:
        if fault.start <= sent[0] < fault.stop:
            return tuple(value + fault.size if on else value for on, value in _concerned(fault, sent))
        return sent

    return hit


def _dead(fault: Fault, _uniform: Iterator[float]) -> Hit:
    def hit(sent: Stamped) -> Stamped:
        if fault.start <= sent[0] < fault.stop:
            return tuple(fault.size if on else value for on, value in _concerned(fault, sent))
        return sent

    return hit


def _stuck(fault: Fault, _uniform: Iterator[float]) -> Hit:
    held: Stamped | None = None  # what it was before; if there was nothing, the first that comes

    def hit(sent: Stamped) -> Stamped:
        nonlocal held
        if held is None or not fault.start <= sent[0] < fault.stop:
            held = sent
            return sent
        pairs = zip(_concerned(fault, sent), held, strict=True)
        return tuple(before if on else value for (on, value), before in pairs)

    return hit


_KINDS: dict[str, Callable[[Fault, Iterator[float]], Hit]] = {
    "dropout": _dropout,
    "invalid": _invalid,
    "stuck": _stuck,
    "dead": _dead,
    "spike": _spike,
    "offset": _offset,
}
