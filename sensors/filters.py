"""Low-passes, the memory of a signal, and the part's digital filter.

A low-pass of the input u, which is linear between the plant's steps, is followed by its error e against the input:

    e_k = a e_{k-1} - m (u_k - u_{k-1}),   y_k = u_k + Re e_k,       a = e^{p Δt},  m = r (e^{p Δt} - 1)/(p Δt)

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

HUGE = 1e300  # beyond is no signal any more

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
    """Return (a, m) of a two-pole Butterworth low-pass of `bandwidth` Hz, for steps of `dt`, s; (0, 0) if infinite."""
    if bandwidth == inf:
        return 0.0, 0.0
    p_dt = 2.0 * pi * bandwidth * dt * complex(-sqrt(0.5), sqrt(0.5))
    a = complex_exp(p_dt)
    return a, (1.0 - 1.0j) * 2.0 * complex_exp(0.5 * p_dt) * complex_sinh(0.5 * p_dt) / p_dt  # e^z - 1 for small z


def low_pass(a: complex, m: complex, first: Triple) -> Stage:
    """Return a low-pass of three axes, a stage to be called once a step.

    Parameters
    ----------
    a, m : complex
        Of `lag` or `two_pole`.
    first : (x, y, z)
        What its input has been so far. An axis whose input was no number starts again when it is one.
    """
    # With Δ = u_k - u_{k-1}, the real part alone: e_k = q_{k-1} - c Δ,  q_k = g e_k - h e_{k-1} + d Δ.
    c, d, g, h = m.real, (m * a.conjugate()).real, 2.0 * a.real, abs(a) ** 2
    px, py, pz = first
    ex = ey = ez = qx = qy = qz = 0.0

    def step(x: float, y: float, z: float) -> Triple:
        nonlocal px, py, pz, ex, ey, ez, qx, qy, qz
        dx, dy, dz = x - px, y - py, z - pz
        px, py, pz = x, y, z
        nx, ny, nz = qx - c * dx, qy - c * dy, qz - c * dz
        qx, qy, qz = g * nx - h * ex + d * dx, g * ny - h * ey + d * dy, g * nz - h * ez + d * dz
        ex, ey, ez = nx, ny, nz
        if not -HUGE < qx + qy + qz < HUGE:
            ex, ey, ez = settled(ex), settled(ey), settled(ez)
            qx, qy, qz = settled(qx), settled(qy), settled(qz)
        return x + ex, y + ey, z + ez

    return step


def settled(error: float) -> float:
    """Return the error of a low-pass, or none where it is no number and would never be one again."""
    return error if isfinite(error) else 0.0


class History:
    """What a signal was at its last steps, linear between them.

    Parameters
    ----------
    dt : float
        Time between steps, s.
    longest : float
        How far back it will be asked for, s; what was before is as it was then.
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
        past = self._past
        steps = age * self._steps_per_second
        whole = int(steps)
        if whole > self._last:
            steps = whole = self._last
        w, place = steps - whole, -1 - whole
        x, y, z = past[place]
        ox, oy, oz = past[place - 1]
        return x + w * (ox - x), y + w * (oy - y), z + w * (oz - z)

    def mean(self, window: float, age: float) -> Triple:
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
