"""Whether force and pressures of a log have the same clock, by a launch that both show.

With F(t) = ∫(f_x − rest) dt the speed that the push has given, and w the headwind, a head's difference is

    Δp = c + ½ρ F² + ρ w F

after the launch as before it. So both shapes are moved over Δp until a sum of them agrees best, by the coefficient of
correlation R; a parabola through the best three has the delay. Its standard deviation is that of a fit to noise,

    σ_τ = σ_r/√Σ(dΔp/dt)²

σ_r being what remains, over as many points as are not alike, and of the slope what neither shape can make. What is found is the age of the pressure, its
tubes and filters included, and the clocks' offset together. One launch cannot tell them apart.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from uavsim.logs.head import Channel, Head
from uavsim.logs.recording import Array

BEFORE, AFTER = 1.0, 1.5  # s around a launch that the template has
GAINED = 5.0  # m/s of speed in a push, below which nothing is to be seen in the pressure
ALIKE = 0.9  # of the correlation, from which on both show the same launch. By hand
UNIQUE = 0.03  # by which no other place may come as near. By hand
FINE = 200.0  # Hz, of the grid on which a pressure is compared at the least
DENSITY = (0.3, 3.0)  # of the factor between F² and Δp over ½ρ at sea level, beyond which it is another event
STRONGEST = 25.0  # m/s, of a headwind at a launch
RHO = 1.225  # kg/m³
FAR = 3.0  # standard deviations of the delay that are told
MOST_GRID = 4_000_000  # places that are compared


@dataclass(frozen=True, slots=True)
class Delay:
    """By how much the pressures are later than the force, s, its standard deviation and the correlation."""

    delay: float
    sd: float
    likeness: float

    def beyond(self, age: float, period: float) -> float:
        """Return what of it the clocks are off by, s, if a pressure has a known age; 0 if that may be chance.

        Chance is what three standard deviations allow, and half of a period of the pressures.
        """
        off = self.delay - age
        return off if abs(off) > max(FAR * self.sd, 0.5 * period) else 0.0


def delay_of(head: Head, readings: Array, launches: list[float]) -> Delay | None:
    """Find by how much the head is later than the force; None where no launch shows in both.

    Parameters
    ----------
    head : Head
    readings : numpy.ndarray
        t, fx, fy, fz; the launch is along x.
    launches : list of float
        When a detector recognised one, s; the greatest push, if there is none.
    """
    t, fx = readings[:, 0], readings[:, 1]
    good = np.isfinite(fx)
    t, fx = t[good], fx[good]
    if t.size < 10:
        return None
    for at in launches or [float(t[np.argmax(fx)])]:
        template = _gained(t, fx, at)
        if template is not None and (found := _match(head, *template)) is not None:
            return found
    return None


def _gained(t: Array, fx: Array, at: float) -> tuple[Array, Array] | None:
    """Times around a launch and F², m²/s²; None if the push gives too little."""
    inside = (t >= at - BEFORE) & (t <= at + AFTER)
    t, fx = t[inside], fx[inside]
    rest = fx[t < at - 0.5 * BEFORE]
    if t.size < 10 or rest.size < 3:
        return None
    push = fx - float(np.median(rest))
    speed = np.concatenate(([0.0], np.cumsum(0.5 * (push[1:] + push[:-1]) * np.diff(t))))
    return (t, speed**2) if speed.max() > GAINED else None


def _match(head: Head, t: Array, square: Array) -> Delay | None:
    dt = min(1.0 / FINE, 0.5 * head.total.period)
    total = Channel("", head.total.t, head.differences, "")
    keep = np.isfinite(total.values)
    if np.count_nonzero(keep) < 10 or (total.t[-1] - total.t[0]) / dt > MOST_GRID:
        return None
    grid = np.arange(total.t[0], total.t[-1], dt)
    pressure = np.interp(grid, total.t[keep], total.values[keep])
    square = np.interp(np.arange(t[0], t[-1], dt), t, square)
    shapes = np.column_stack([square, np.sqrt(square)])
    n = len(shapes)
    if grid.size < n:
        return None
    likeness, basis = _likeness(pressure, shapes)
    best = int(np.argmax(likeness))
    far = np.abs(np.arange(likeness.size) - best) * dt > BEFORE
    if likeness[best] < ALIKE or (far.any() and likeness[far].max() > likeness[best] - UNIQUE):
        return None
    seen = pressure[best : best + n] - pressure[best : best + n].mean()
    left = seen - basis @ (basis.T @ seen)
    factors, *_ = np.linalg.lstsq(shapes - shapes.mean(axis=0), seen, rcond=None)
    wind = factors[1] / (2.0 * factors[0])
    if not (DENSITY[0] <= factors[0] / (0.5 * RHO) <= DENSITY[1] and abs(wind) <= STRONGEST):
        return None
    shift = 0.0
    if 0 < best < likeness.size - 1:
        a, b, c = likeness[best - 1 : best + 2]
        shift = 0.5 * (a - c) / (a - 2.0 * b + c) if a - 2.0 * b + c < 0.0 else 0.0
    steep = np.gradient(shapes @ factors, dt)
    steep = steep - steep.mean()
    steep = steep - basis @ (basis.T @ steep)
    each = max(head.total.period / dt, _alike(left))  # points of the grid that are one reading, or one gust
    sd = sqrt(float(np.mean(left**2)) * each / float(np.dot(steep, steep)))
    return Delay(float(grid[best] - t[0] + shift * dt), sd, float(likeness[best]))


def _alike(left: Array) -> float:
    """How many points of a series go together: 1 + 2 Σ of its autocorrelations up to the first that is below 0."""
    whole = float(np.dot(left, left))
    together = 1.0
    for lag in range(1, left.size // 2):
        share = float(np.dot(left[lag:], left[:-lag])) / whole if whole > 0.0 else 0.0
        if share <= 0.0:
            break
        together += 2.0 * share
    return together


def _likeness(signal: Array, shapes: Array) -> tuple[Array, Array]:
    """R of the shapes with the signal from each place on, and the shapes' orthonormal basis."""
    from scipy.signal import fftconvolve  # late: half a second that a log without pressures does not need

    n = len(shapes)
    signal = signal - signal.mean()
    basis, _ = np.linalg.qr(shapes - shapes.mean(axis=0))
    explained = sum(fftconvolve(signal, one[::-1], mode="valid") ** 2 for one in basis.T)
    one, two = np.concatenate(([0.0], np.cumsum(signal))), np.concatenate(([0.0], np.cumsum(signal**2)))
    whole = (two[n:] - two[:-n]) - (one[n:] - one[:-n]) ** 2 / n
    floor = 1e-9 * max(float(two[-1]), 1e-300)
    return np.where(whole > floor, np.sqrt(explained / np.maximum(whole, floor)), 0.0), basis
