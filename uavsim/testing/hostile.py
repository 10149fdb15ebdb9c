"""Readings as no sensor should send them: values and time stamps of every kind of nonsense, drawn from a seed.

A true clock runs below, 1 kHz of specific force and 100 Hz of the head; what is read is hurt now and then, one reading
or some in a row. So most readings are sound, as they are on an aircraft whose bus or sensor is going.
"""

import math
import random
from collections.abc import Callable, Iterable, Iterator

Force = tuple[float, float, float, float]
"""t, fx, fy, fz."""
Row = tuple[float, float, float, float, float, float]
"""t, p_total, p_static, temperature, t_total, t_static."""

NAN, INF = math.nan, math.inf
STATIC, KELVIN = 101_325.0, 288.15
NO_NUMBERS = (NAN, INF, -INF, 1e300, -1e300, 1.7e308, -1.7e308, 1e155, 5e-324)
"""Values that no sensor has, whatever the quantity; some overflow when they are squared or added."""
FORCES = (*NO_NUMBERS, 1e5, -1e5, 4000.0, -4000.0)
"""Implausible specific forces, m/s²; 5e-324 is plausible."""
LOADS = (3999.0, -3999.0, 1500.0, -1500.0, 147.0, 60.0, 0.0, -0.0)
"""Plausible ones that may be taken for a launch."""
PRESSURES = (*NO_NUMBERS, 0.0, -0.0, -5.0, 1e-3, 999.0, 1e9, 250_001.0)
"""Implausible pressures, Pa."""
OFFSETS = (-1e5, -9e4, -5e4, -4.5e4, -2e4, -5e3, -500.0, 500.0, 5e3, 2e4, 5e4, 9e4)
"""Jumps of a pressure, Pa; most leave it plausible."""
TEMPERATURES = (*NO_NUMBERS, 0.0, -3.0, 15.0, 149.0, 151.0, 399.0, 401.0, 1e4)
NO_STAMPS = (NAN, INF, -INF, 1e300, -1e300, 1e12)
AHEAD = (1e9, 6e4, 60.0, 10.0, 1.5, 0.9, 0.2, 0.02, -0.02, -0.2, -0.9, -1.5, -10.0, -60.0, -1e9)
"""How far a stamp may be off, s."""


def shifted(draw: random.Random, t: float) -> float:
    """Return a wrong stamp in place of `t`."""
    kind = draw.random()
    if kind < 0.3:
        return draw.choice(NO_STAMPS)
    return t + draw.choice(AHEAD) if kind < 0.9 else draw.uniform(-1e3, 1e3)


class Bursts:
    """Says which readings are hurt, and how: bursts begin with a probability and last for 1 to `longest` readings."""

    def __init__(self, draw: random.Random, share: float, longest: int) -> None:
        self.draw, self.share, self.longest = draw, share, longest
        self.left, self.seed = 0, 0

    def __call__(self) -> random.Random | None:
        """Return what draws the damage of this reading, None for none; within a burst it may be the same each time."""
        if not self.left:
            if self.draw.random() > self.share:
                return None
            self.left = self.draw.randint(1, self.longest) if self.draw.random() < 0.5 else 1
            self.seed = self.draw.getrandbits(32)
        self.left -= 1
        return random.Random(self.seed) if self.draw.random() < 0.7 else self.draw


class Clock:
    """The true clock, which now and then stands still for a while or takes a step, for all sources at once."""

    def __init__(self, draw: random.Random, rate: float) -> None:
        self.draw, self.period, self.t = draw, 1.0 / rate, 0.0

    def __call__(self) -> float:
        """Return the time, s."""
        self.t += self.period * (1.0 + 0.2 * (self.draw.random() - 0.5))
        chance = self.draw.random()
        if chance < 5e-5:
            self.t += self.draw.choice((0.01, 0.3, 0.9, 1.1, 60.0, 1e5))
        elif chance < 7e-5:
            self.t = self.draw.choice((0.0, self.t - 0.5, self.t - 100.0, -1e6))
        return self.t


class Rail:
    """The specific force, m/s²: rest, and loads that last from 1 to 300 ms; the airspeed, m/s, goes its own ways."""

    def __init__(self, draw: random.Random) -> None:
        self.draw, self.level, self.left, self.speed = draw, 3.0, 0, 0.0

    def __call__(self) -> list[float]:
        """Return the force, m/s²."""
        draw = self.draw
        if not self.left:
            self.level = draw.choice((3.0, 3.0, 3.0, -20.0, 40.0, 60.0, 150.0))
            self.left = draw.randint(1, 300) if self.level != 3.0 else draw.randint(1, 5000)
            self.speed = draw.choice((0.0, 5.0, 32.0, 32.0, 32.0, 60.0, self.speed))
        self.left -= 1
        gauss = draw.gauss
        return [self.level + gauss(0.0, 1.0), gauss(0.0, 1.0), -9.4 + gauss(0.0, 1.0)]


def readings(seed: int, count: int, share: float = 0.003, rows_each: int = 10) -> Iterator[Force | Row]:
    """Yield as many readings as asked for: specific force at 1 kHz and, `rows_each` times as rarely, rows of a head.

    `share` is the probability that a damage of some column or stamp begins with a reading.
    """
    draw = random.Random(seed)
    clock, rail = Clock(draw, 1000.0), Rail(draw)
    value, stamp = Bursts(draw, share, 100), Bursts(draw, share, 30)
    bursts = [Bursts(draw, share, 60) for _ in DAMAGE]
    left, k = count, 0
    while left > 0:
        t, force, k = clock(), rail(), k + 1
        if (hurt := value()) is not None:
            force[hurt.choice((0, 0, 1, 2))] = hurt.choice(FORCES) if hurt.random() < 0.6 else hurt.choice(LOADS)
        yield (t if (hurt := stamp()) is None else shifted(hurt, t)), force[0], force[1], force[2]
        left -= 1
        if not k % rows_each and left > 0:
            row = head(t, rail.speed, draw)
            for place, burst in enumerate(bursts):
                if (hurt := burst()) is not None:
                    row[place] = DAMAGE[place](hurt, row[place])
            yield row[0], row[1], row[2], row[3], row[4], row[5]
            left -= 1


def head(t: float, speed: float, draw: random.Random, static: float = STATIC) -> list[float]:
    """Return a sound row of two BMP390 at an airspeed, m/s."""
    total = static * (1.0 + speed * speed / (7.0 * 287.05287 * KELVIN)) ** 3.5
    ends = t - 0.004, t - 0.007
    return [t, total + draw.gauss(0.0, 3.7), static + draw.gauss(0.0, 3.7), KELVIN, *ends]


def _pressure(draw: random.Random, value: float) -> float:
    return draw.choice(PRESSURES) if draw.random() < 0.5 else value + draw.choice(OFFSETS)


def _temperature(draw: random.Random, _value: float) -> float:
    return draw.choice(TEMPERATURES)


DAMAGE: tuple[Callable[[random.Random, float], float], ...] = (
    shifted, _pressure, _pressure, _temperature, shifted, shifted,
)  # fmt: skip
"""What may happen to each column of a row."""


# -- a sound flight, and one thing wrong with it -----------------------------------------------------------------------

COVERED = (0.3, 1.3)  # s, when the head is covered and tared
START, STROKE, CRUISE = 3.0, 0.4, 32.0  # s, s, m/s: a push of 80 m/s² from START on
REST = 2.5  # m/s², along x on the rail


Sample = tuple[Force | Row, float, float]
"""A reading, when it was taken, s, and the true airspeed then, m/s."""


def flight(until: float, seed: int = 1) -> Iterator[Sample]:
    """Yield sound readings, 1 kHz and 100 Hz, of a launch and a level flight in light gusts.

    The airspeed goes up and down by 1 m/s in 4 s, which the specific force shows, and by a gust of 0.2 m/s and 6 s,
    which it does not.
    """
    draw = random.Random(seed)
    gauss = draw.gauss
    speed, gust, history = 0.0, 0.0, [0.0] * 12
    for k in range(1, round(until * 1000.0)):
        t = 0.001 * k
        force, flown = 0.0, t - START - STROKE
        if flown > 0.0:
            force = 0.5 * math.pi * math.cos(0.5 * math.pi * flown)
            gust += -gust / 6.0 * 0.001 + 0.2 * math.sqrt(2.0 / 6.0 * 0.001) * gauss(0.0, 1.0)
        elif t > START:
            force = CRUISE / STROKE
        speed += 0.001 * force
        history = [*history[1:], speed + gust]
        rest = 0.0 if flown > 0.0 else REST
        yield (t, force + rest + gauss(0.0, 0.3), gauss(0.0, 0.3), -9.8 + gauss(0.0, 0.3)), t, speed + gust
        if not k % 10:
            total, static = head(t, history[3], draw)[1], head(t, history[0], draw)[2]
            yield (t, total + 30.0, static, KELVIN, t - 0.004, t - 0.007), t, speed + gust


Damage = Callable[[float], float]
"""What a value, or a time stamp, becomes."""


def constant(value: float) -> Damage:
    """Return a damage that says the same number whatever was read."""
    return lambda _: value


def plus(value: float) -> Damage:
    """Return a damage that adds."""
    return lambda read: read + value


def damaged(
    stream: Iterable[Sample], length: int, column: int, damage: Damage, start: float, count: int
) -> Iterator[Sample]:
    """Hurt one column (0: the stamp) of some readings in a row, from `start`, s, on; `length` says of which sensor."""
    left = count
    for reading, t, speed in stream:
        if left and len(reading) == length and t >= start:
            left -= 1
            hurt = list(reading)
            hurt[column] = damage(hurt[column])
            yield tuple(hurt), t, speed  # type: ignore[misc]
        else:
            yield reading, t, speed


def battered(stream: Iterable[Sample], seed: int, start: float, stop: float, share: float = 0.01) -> Iterator[Sample]:
    """Hurt any column of any reading between two times, s, as `readings` does."""
    draw = random.Random(seed)
    value, stamp = Bursts(draw, share, 100), Bursts(draw, share, 30)
    bursts = [Bursts(draw, share, 60) for _ in DAMAGE]
    for reading, t, speed in stream:
        if not start <= t < stop:
            yield reading, t, speed
            continue
        hurt = list(reading)
        if len(hurt) == 4:
            if (how := value()) is not None:
                hurt[how.choice((1, 1, 2, 3))] = how.choice(FORCES) if how.random() < 0.6 else how.choice(LOADS)
            if (how := stamp()) is not None:
                hurt[0] = shifted(how, hurt[0])
        else:
            for place, burst in enumerate(bursts):
                if (how := burst()) is not None:
                    hurt[place] = DAMAGE[place](how, hurt[place])
        yield tuple(hurt), t, speed  # type: ignore[misc]
