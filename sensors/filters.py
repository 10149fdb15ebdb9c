"""Low-passes, the memory of a signal, and the part's digital filter.

A low-pass of the input u, which is linear between the plant's steps, is followed by its error e against the input:

    e_k = a e_{k-1} - m (u_k - u_{k-1}),   y_k = u_k + Re e_k            a = e^{p Δt},  m = r (e^{p Δt} - 1)/(p Δt)

exact for such an input, and zero while it is steady. One pole: p = -ω, r = 1. Two (Butterworth): p = ω e^{j3π/4} with
r = 1 - j, and "Re" stands for its conjugate. ω = 2π f at the -3 dB frequency f. (A residue R of H(s) at p gives
r = -R/p, and twice that for the pair; Re r = 1 is unit gain at rest.)

What the signal was some time ago, or on the mean over some time, follows from its steps (`History`), also exactly.

Sources: Franklin, Powell & Workman, "Digital Control of Dynamic Systems", ch. 6.3 (first-order hold); Oppenheim &
Schafer, "Discrete-Time Signal Processing", ch. 7 (Butterworth).
"""

from cmath import exp as complex_exp
from cmath import sinh as complex_sinh
from collections import deque
from collections.abc import Callable
from math import ceil, expm1, inf, isfinite, pi, sqrt

from sensors.unit import Triple

Stage = Callable[[float, float, float], Triple]
"""Something that is done to the three axes of a signal, in and out in the same unit."""


def lag(bandwidth: float, dt: float) -> tuple[float, float]:
    """Return (a, m) of one pole at `bandwidth`, Hz, for steps of `dt`, s; no error, (0, 0), if it is infinite."""
    if bandwidth == inf:
        return 0.0, 0.0
    omega_dt = 2.0 * pi * bandwidth * dt
    passed = -expm1(-omega_dt)
    return 1.0 - passed, passed / omega_dt


def one_pole(bandwidth: float, dt: float) -> Triple:
    """Return (a, b0, b1) of y_k = a y_{k-1} + b0 u_{k-1} + b1 u_k, a first-order low-pass of `bandwidth` Hz.

    Exact for an input that is linear between the steps (first-order hold); (0, 0, 1) if the bandwidth is infinite.
    """
    a, m = lag(bandwidth, dt)
    return a, m - a, 1.0 - m


def two_pole(bandwidth: float, dt: float) -> tuple[complex, complex]:
    """Return (a, m) of a two-pole Butterworth low-pass of `bandwidth` Hz, for steps of `dt`, s."""
    p_dt = 2.0 * pi * bandwidth * dt * complex(-sqrt(0.5), sqrt(0.5))
    a = complex_exp(p_dt)
    return a, (1.0 - 1.0j) * 2.0 * complex_exp(0.5 * p_dt) * complex_sinh(0.5 * p_dt) / p_dt  # e^z - 1 for small z


def butterworth(bandwidth: float, dt: float) -> Stage:
    """Return a two-pole low-pass of three axes, a stage to be called once a step.

    Its first input is taken to have been there before; an axis whose input was no number starts again when it is one.
    """
    a, m = two_pole(bandwidth, dt)
    before: Triple | None = None
    ex = ey = ez = 0j

    def step(x: float, y: float, z: float) -> Triple:
        nonlocal before, ex, ey, ez
        px, py, pz = (x, y, z) if before is None else before
        before = (x, y, z)
        ex, ey, ez = a * ex - m * (x - px), a * ey - m * (y - py), a * ez - m * (z - pz)
        if not isfinite(ex.real + ey.real + ez.real):
            ex, ey, ez = settled(ex), settled(ey), settled(ez)
        return x + ex.real, y + ey.real, z + ez.real

    return step


def settled(error: complex) -> complex:
    """Return the error of a low-pass, or none where it is no number and would never be one again."""
    return error if isfinite(error.real) else 0.0


class History:
    """What a signal was at its last steps, linear between them.

    Parameters
    ----------
    dt : float
        Time between steps, s.
    longest : float
        How far back it will be asked for, s.
    first : (x, y, z)
        What it has been so far.

    Attributes
    ----------
    keep : callable
        `keep((x, y, z))` takes in the value of one more step.
    """

    __slots__ = ("_last", "_past", "_steps_per_second", "keep")

    keep: Callable[[Triple], None]

    def __init__(self, dt: float, longest: float, first: Triple) -> None:
        steps = ceil(longest / dt) + 3
        self._steps_per_second = 1.0 / dt
        self._past = deque([first] * steps, maxlen=steps)
        self._last = steps - 2
        self.keep = self._past.append

    def at(self, age: float) -> Triple:
        """Return what it was `age` seconds before the last step."""
        steps = age * self._steps_per_second
        whole = min(int(steps), self._last)
        w = steps - whole
        x, y, z = self._past[-1 - whole]
        ox, oy, oz = self._past[-2 - whole]
        return x + w * (ox - x), y + w * (oy - y), z + w * (oz - z)

    def mean(self, age: float, window: float) -> Triple:
        """Return its mean over the `window` seconds that ended `age` seconds before the last step."""
        end = age * self._steps_per_second
        start = end + window * self._steps_per_second
        share = 1.0 / (start - end)
        x, y, z = self._past[-1]  # everything as a difference from here, so that a steady signal comes out as it is
        mx = my = mz = 0.0
        for whole in range(min(int(end), self._last), min(int(start), self._last) + 1):
            # The mean of a straight piece is its middle; of the first and the last only a part is inside.
            begun, ended = max(end, whole), min(start, whole + 1.0)
            part, w = (ended - begun) * share, 0.5 * (begun + ended) - whole
            nx, ny, nz = self._past[-1 - whole]
            ox, oy, oz = self._past[-2 - whole]
            mx += part * (nx - x + w * (ox - nx))
            my += part * (ny - y + w * (oy - ny))
            mz += part * (nz - z + w * (oz - nz))
        return x + mx, y + my, z + mz


class DigitalFilter:
    """The filter y += a (x - y) that begins with its first input, and again after one that was no number.

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
        begins = before is None or self._weight == 1.0 or not isfinite(before)
        self._output = y = x if begins or before is None else before + self._weight * (x - before)
        return y
