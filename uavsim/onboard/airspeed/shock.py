"""A sudden step of f_x: thrust does not change within hundredths of a second, an offset may, by a shock.

The mean of f_x over `WIDE` is held against that over the `WIDE` before last. A difference beyond `SIZE` and beyond
`DEVIATIONS` of its noise is a step. Whether it was felt or is an offset of the accelerometer that has jumped, the
pressures tell: b is opened by the step's size, so that they can, and no port is charged with it meanwhile. Where b has
taken up most of the step a second later, the accelerometer is named.
"""

from collections import deque
from math import inf

WIDE = 4  # readings of the head, of each mean: 40 ms at 100 Hz
# m/s² and standard deviations of a step that is looked at. By hand: the motor's start and gusts stay below as a rule,
# and an offset of less is within what b may do
SIZE, DEVIATIONS = 1.4, 6.0
# share of the step, and of the least one, that each mean's readings may differ by: a slope has no two levels. By hand
LEVEL, NOISE = 0.2, 0.6
LARGEST = 15.0  # m/s²; a greater one is a push that begins or ends
WAIT = 1.0  # s until b is looked at
# of the step, that b must have taken up and not more than its like above, and the standard deviation up to which b is
# known. In gusts it is not, and nobody is named. By hand: no accelerometer named in 20 flights of `gusty`
LEAST_PART, KNOWN = 0.7, 0.15


class Shock:
    """Looks for steps in the mean force between readings of the head.

    Attributes
    ----------
    due : float
        When b is to be looked at, s; inf without a step.
    """

    __slots__ = ("_bias", "_forces", "_least", "_size", "due")

    def __init__(self, sd: float) -> None:
        self._least = max(SIZE, DEVIATIONS * sd * (2.0 / WIDE) ** 0.5)
        self._forces: deque[float] = deque(maxlen=3 * WIDE)
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._forces.clear()
        self._bias, self._size, self.due = 0.0, 0.0, inf

    def add(self, t: float, force: float, bias: float) -> float:
        """Take the mean force since the last reading, m/s², and b; return the size of a step, m/s², or 0."""
        forces = self._forces
        forces.append(force)
        if len(forces) < 3 * WIDE or self.due < inf:
            return 0.0
        rough = forces[-1] + forces[-2] - forces[0] - forces[1]
        if -self._least < rough < self._least:  # a quick look, for it is asked a hundred times a second
            return 0.0
        row = list(forces)
        old, new = row[:WIDE], row[-WIDE:]
        size = (sum(new) - sum(old)) / WIDE
        still = max(max(old) - min(old), max(new) - min(new))
        if not self._least < abs(size) < LARGEST or still > LEVEL * abs(size) + NOISE * self._least:
            return 0.0
        self._bias, self._size, self.due = bias, size, t + WAIT
        return size

    def judge(self, bias: float, variance: float) -> tuple[bool, float]:
        """Judge a step by b, m/s², and its variance: whether it was an offset, and by how much b has moved, m/s²."""
        taken, size, self.due = (bias - self._bias) / self._size, self._size, inf
        self._forces.clear()
        return LEAST_PART < taken < 2.0 - LEAST_PART and variance < (KNOWN * size) ** 2, taken * size
