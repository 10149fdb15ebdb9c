"""The clock of a device, which says when its k-th event happens.

    t_k = φ + k / f

with its own phase φ, drawn once in [0, 1/f), and its own true rate f, which may be off from the nominal one. Times are
computed from the integer k and never accumulated, so an hour of them carries no rounding drift.
"""

import numpy as np


class Clock:
    """Times of a periodic event.

    Parameters
    ----------
    rate : float
        True rate, Hz.
    phase : float
        Time of the first event, s.

    Attributes
    ----------
    due : float
        Time of the next event, s.
    rate, phase : float
        As given.
    """

    __slots__ = ("_count", "due", "phase", "rate")

    def __init__(self, rate: float, phase: float) -> None:
        self.rate = rate
        self.phase = phase
        self._count = 0
        self.due = phase

    @classmethod
    def drawn(cls, rate: float, generator: np.random.Generator) -> "Clock":
        """Return a clock of this true rate with a phase drawn uniformly in [0, 1/rate)."""
        return cls(rate, float(generator.random()) / rate)

    def tick(self) -> None:
        """Go on to the next event."""
        self._count += 1
        self.due = self.phase + self._count / self.rate
