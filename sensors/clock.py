"""The clock of a device, which says when its k-th event happens.

    t_k = φ + k / f + j_k,   f = f_nominal (1 + e)

with its own phase φ, drawn once in [0, 1/f), its own true rate f, which may be off from the nominal one, and jitter j,
normal and held within ±0.4/f so that no event overtakes another. Times are computed from the integer k and never
accumulated, so an hour of them carries no rounding drift.
"""

from collections.abc import Callable, Iterator
from itertools import chain, count
from math import inf

import numpy as np

from sensors.noise import BLOCK, Array

WIDEST = 0.4  # of the time between events: two neighbours that come towards each other keep a fifth of it


class Clock:
    """Times of a periodic event.

    Parameters
    ----------
    rate : float
        True rate, Hz.
    phase : float
        Time of the first event, s.
    jitter : float
        Standard deviation of an event about that time, s; 0 is none, and then nothing is drawn.
    generator : numpy.random.Generator, optional
        Draws the jitter; needed if there is any.

    Attributes
    ----------
    due : float
        Time of the next event, s; with jitter the first is at 0 at the earliest.
    later : callable
        Gives the times of the events after that, s, one a call. A loop that is in a hurry takes `due` and `later` into
        its local variables and leaves `tick` alone.
    times : iterator of float
        What `later` draws from; a `for` gets them for half the price.
    rate, phase : float
        As given.

    Raises
    ------
    ValueError
        If the rate is not above 0, the jitter is negative, or nobody draws it.

    Examples
    --------
    >>> clock = Clock(100.0, 0.002)
    >>> clock.tick()
    >>> clock.due
    0.012
    """

    __slots__ = ("due", "later", "phase", "rate", "times")

    later: Callable[[], float]

    def __init__(
        self, rate: float, phase: float, *, jitter: float = 0.0, generator: np.random.Generator | None = None
    ) -> None:
        _check_rate(rate)
        if not 0.0 <= jitter < inf:
            raise ValueError(f"jitter must be at least 0 s and finite, not {jitter!r}")
        self.rate = rate
        self.phase = phase
        blocks = _steady(rate, phase)
        if jitter > 0.0:
            if generator is None:
                raise ValueError("jitter needs a generator that draws it")
            blocks = _jittered(blocks, rate, jitter, generator)
        self.times = chain.from_iterable(block.tolist() for block in blocks)
        self.later = self.times.__next__
        self.due = self.later()

    @classmethod
    def drawn(
        cls,
        rate: float,
        generator: np.random.Generator,
        *,
        error: float = 0.0,
        jitter: float = 0.0,
        jitter_generator: np.random.Generator | None = None,
    ) -> "Clock":
        """Return a clock with a phase drawn uniformly in the time between events.

        Parameters
        ----------
        rate : float
            Nominal rate, Hz.
        generator : numpy.random.Generator
            Draws the phase.
        error : float
            Of the rate, a fraction above -1.
        jitter, jitter_generator
            As of the class.
        """
        true_rate = rate * (1.0 + error)
        _check_rate(true_rate)
        return cls(true_rate, float(generator.random()) / true_rate, jitter=jitter, generator=jitter_generator)

    def tick(self) -> None:
        """Go on to the next event."""
        self.due = self.later()


def _check_rate(rate: float) -> None:
    if not 0.0 < rate < inf:
        raise ValueError(f"rate must be above 0 Hz and finite, not {rate!r}")


def _steady(rate: float, phase: float) -> Iterator[Array]:
    """Yield blocks of φ + k/f."""
    k = np.arange(BLOCK)
    for first in count(0, BLOCK):
        yield phase + (k + first) / rate


def _jittered(steady: Iterator[Array], rate: float, sd: float, generator: np.random.Generator) -> Iterator[Array]:
    """Yield the same blocks with jitter, no time below 0."""
    widest = WIDEST / rate
    for block in steady:
        yield np.maximum(block + np.clip(generator.standard_normal(BLOCK) * sd, -widest, widest), 0.0)
