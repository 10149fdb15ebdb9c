"""Dryden's turbulence at low and at high altitude: its law, and its forming filters solved exactly at any step.

The law (MIL-F-8785C 3.7.1.2, 3.7.2, 3.7.3; MIL-HDBK-1797 appendix), h above the ground in feet, W₂₀ the wind at 20 ft:

    10 … 1000 ft   σ_w = 0.1 W₂₀,  σ_u = σ_v = σ_w/s^0.4,  s = 0.177 + 0.000823 h
                   8785C   L_w = h,    L_u = L_v = h/s^1.2
                   1797    2 L_w = h,  L_u = 2 L_v = h/s^1.2
    from 2000 ft   σ_u = σ_v = σ_w by height and probability of exceedance
                   8785C   L_u = L_v = L_w = 1750 ft
                   1797    L_u = 2 L_v = 2 L_w = 1750 ft

Below 10 ft all is as at 10 ft. Between, both kinds are there, the share k = (h − 1000)/1000 of the variance from the
upper one. One-sided spectra over the frequency ω, with T = L/V in 8785C and for v and w T = 2 L/V in 1797:

    Φ_u = σ² (2 T/π)/(1 + (T ω)²)              Φ_v, Φ_w = σ² (T/π)(1 + 3 (T ω)²)/(1 + (T ω)²)²
    Φ_p = σ_w²/(V² T_w) · 0.8 (π V T_w/4b)^⅓/(1 + (4 b ω/π V)²)
    Φ_q = (ω/V)² Φ_w/(1 + (4 b ω/π V)²)        Φ_r = (ω/V)² Φ_v/(1 + (3 b ω/π V)²)

The factor two that 1797 puts before the lengths of v and w in its spectra is the one that it takes from these lengths:
the two specifications name lengths otherwise, and their air is the same.

u, v, w are in the axes of the mean wind at low altitude, along it, to the right, down, and in those of the body at high
altitude. p, q, r are how fast the air turns about the body's axes, as it would carry a body along:
q = −∂w/∂x, r = ∂v/∂x along the flight path, p = ∂w/∂y with a filter of its own.

Filters. With dξ = white noise, a = 1/T and c = π V/(4 b), or 3 b for r,

    u' = −a u + √(2a) ξ,    m' = c (u − m)
    z₁' = −a z₁ + √a ξ,     z₂' = a (z₁ − z₂),     v = √3 z₁ + (1 − √3) z₂,     m' = c (v − m)

have unit variance in u, v, w, and q = −(w − m)/(V/c) is the filter of the specification. While V and h stay, the state
after a step is Φ·state + a normal vector of covariance Q = ∫ g gᵀ ds, g the response to an impulse; both are computed
to rounding (`coefficients`), so that samples have the spectrum's covariance whatever the step.
"""

from math import exp, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import compiled

FOOT = 0.3048  # m, exact
LOWEST, LOW, HIGH = (
    10.0,
    1000.0,
    2000.0,
)  # ft above the ground: where the law of low altitude begins and ends; see above
LENGTH_HIGH = 1750.0 * FOOT  # m
SLOWEST = 1.0  # m/s: air passes a resting or slower aircraft at this speed
BASE, SLOPE = 0.177, 0.000823  # of s, the latter per ft

STATES = 9  # u and its mean m; z₁, z₂, m of v; z₁, z₂, m of w; p

ROOT3 = sqrt(3.0)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)  # on −1 … 1

# MIL-F-8785C, figure 7: standard deviation, ft/s, over height, ft, for the curves 1 … 7 of probability of exceedance
# (2·10⁻¹, 10⁻¹, 10⁻², 10⁻³, 10⁻⁴, 10⁻⁵, 10⁻⁶), as read by others (JSBSim, FGWinds)
HEIGHTS = (500.0, 1750.0, 3750.0, 7500.0, 15000.0, 25000.0, 35000.0, 45000.0, 55000.0, 65000.0, 75000.0, 80000.0)
EXCEEDANCE = (
    (3.2, 2.2, 1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (4.2, 3.6, 3.3, 1.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    (6.6, 6.9, 7.4, 6.7, 4.6, 2.7, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0),
    (8.6, 9.6, 10.6, 10.1, 8.0, 6.6, 5.0, 4.2, 2.7, 0.0, 0.0, 0.0),
    (11.8, 13.0, 16.0, 15.1, 11.6, 9.7, 8.1, 8.2, 7.9, 4.9, 3.2, 2.1),
    (15.6, 17.6, 23.0, 23.6, 22.1, 20.0, 16.0, 15.1, 12.1, 7.9, 6.2, 5.1),
    (18.7, 21.5, 28.4, 30.2, 30.7, 31.0, 25.2, 23.1, 17.5, 10.7, 8.4, 7.2),
)

Array = NDArray[np.float64]


def sd_above(height: float, severity: int) -> float:
    """Standard deviation of the turbulence from 2000 ft on, m/s, at a height above the ground, m."""
    return float(np.interp(height / FOOT, HEIGHTS, EXCEEDANCE[severity - 1])) * FOOT


def lengths(model: str, height: float) -> tuple[float, float, float]:
    """L_u, L_v, L_w of a specification at a height above the ground, m, each as it defines it; between: that below."""
    half = 0.5 if model == "mil-hdbk-1797" else 1.0
    feet = height / FOOT
    if feet >= HIGH:
        return LENGTH_HIGH, half * LENGTH_HIGH, half * LENGTH_HIGH
    feet = min(max(feet, LOWEST), LOW)
    along = feet / (BASE + SLOPE * feet) ** 1.2 * FOOT
    return along, half * along, half * feet * FOOT


def spans(model: str) -> tuple[float, float, float]:
    """What T V is over a specification's own L_u, L_v, L_w in its spectra."""
    return (1.0, 2.0, 2.0) if model == "mil-hdbk-1797" else (1.0, 1.0, 1.0)


def deviations(wind_20ft: float, height: float) -> tuple[float, float]:
    """σ_u = σ_v and σ_w of the law of low altitude, m/s, at a height above the ground, m."""
    feet = min(max(height / FOOT, LOWEST), LOW)
    return 0.1 * wind_20ft / (BASE + SLOPE * feet) ** 0.4, 0.1 * wind_20ft


@compiled
def ramp(d: float) -> float:
    """(1 − e⁻ᵈ)/d."""
    if abs(d) > 0.5:
        return (1.0 - exp(-d)) / d
    total, term = 1.0, 1.0
    for i in range(2, 14):
        term *= -d / i
        total += term
    return total


@compiled
def ramp2(d: float) -> float:
    """(d − 1 + e⁻ᵈ)/d²."""
    if abs(d) > 0.5:
        return (d - 1.0 + exp(-d)) / (d * d)
    total, term = 0.5, 0.5
    for i in range(3, 15):
        term *= -d / i
        total += term
    return total


@compiled
def mean_of_first(a: float, c: float, s: float) -> float:
    """Return m after s seconds from z₁ = 1 or u = 1, where m' = c (e^(−a s) − m)."""
    return c * s * exp(-a * s) * ramp((c - a) * s)


@compiled
def mean_of_second(a: float, c: float, s: float) -> float:
    """Return m after s seconds, where m' = c (a s e^(−a s) − m)."""
    return c * a * s * s * exp(-a * s) * ramp2((c - a) * s)


@compiled
def coefficients(a: float, c: float, dt: float, second: bool, f: Array, g: Array) -> None:
    """Transition `f` and the lower Cholesky factor `g` of the noise's covariance, both (3, 3), after a step dt.

    The state is (z₁, z₂, m); without a `second` order (u, 0, m).
    """
    f[:, :] = 0.0
    g[:, :] = 0.0
    e = exp(-a * dt)
    first = mean_of_first(a, c, dt)
    f[0, 0] = e
    f[2, 2] = exp(-c * dt)
    if second:
        f[1, 0], f[1, 1] = a * dt * e, e
        f[2, 0] = ROOT3 * first + (1.0 - ROOT3) * mean_of_second(a, c, dt)
        f[2, 1] = (1.0 - ROOT3) * first
    else:
        f[2, 0] = first
    power = a if second else 2.0 * a
    q00 = q10 = q11 = q20 = q21 = q22 = 0.0
    for i in range(NODES.size):
        s = 0.5 * dt * (1.0 + NODES[i])
        weight = 0.5 * dt * WEIGHTS[i] * power
        x = exp(-a * s)
        y = a * s * x if second else 0.0
        z = mean_of_first(a, c, s)
        if second:
            z = ROOT3 * z + (1.0 - ROOT3) * mean_of_second(a, c, s)
        q00 += weight * x * x
        q10 += weight * x * y
        q11 += weight * y * y
        q20 += weight * x * z
        q21 += weight * y * z
        q22 += weight * z * z
    g[0, 0] = sqrt(q00)
    g[1, 0] = q10 / g[0, 0]
    g[2, 0] = q20 / g[0, 0]
    rest = q11 - g[1, 0] * g[1, 0]
    g[1, 1] = sqrt(rest) if rest > 0.0 else 0.0
    if g[1, 1] > 0.0:
        g[2, 1] = (q21 - g[2, 0] * g[1, 0]) / g[1, 1]
    rest = q22 - g[2, 0] * g[2, 0] - g[2, 1] * g[2, 1]
    g[2, 2] = sqrt(rest) if rest > 0.0 else 0.0


@compiled
def roll_deviation(sd_w: float, length: float, span: float) -> float:
    """Standard deviation of p, rad/s, from that of w, m/s, V·T_w, m, and the wing's span, m."""
    bracket: float = (pi * length / (4.0 * span)) ** (1.0 / 3.0)
    return sd_w * sqrt(0.8 * pi * pi / (8.0 * span * length) * bracket)


@compiled
def advance(state: Array, noise: Array, f: Array, g: Array, chosen: Array) -> None:
    """Take one step of the nine states of one altitude's turbulence.

    Parameters
    ----------
    state : ndarray, shape (9,)
    noise : ndarray, shape (9,)
        Independent standard normal numbers.
    f, g : ndarray, shape (3, 3, 3)
        `coefficients` of u, v and w.
    chosen : ndarray, shape (2,)
        Of p: what remains of it after a step, and the standard deviation of what is added.
    """
    u, m = state[0], state[1]
    state[0] = f[0, 0, 0] * u + g[0, 0, 0] * noise[0]
    state[1] = f[0, 2, 0] * u + f[0, 2, 2] * m + g[0, 2, 0] * noise[0] + g[0, 2, 2] * noise[1]
    for i in (1, 2):
        at = 3 * i - 1
        x, y, z = state[at], state[at + 1], state[at + 2]
        a, b, c = noise[at], noise[at + 1], noise[at + 2]
        state[at] = f[i, 0, 0] * x + g[i, 0, 0] * a
        state[at + 1] = f[i, 1, 0] * x + f[i, 1, 1] * y + g[i, 1, 0] * a + g[i, 1, 1] * b
        state[at + 2] = (
            f[i, 2, 0] * x + f[i, 2, 1] * y + f[i, 2, 2] * z + g[i, 2, 0] * a + g[i, 2, 1] * b + g[i, 2, 2] * c
        )
    state[8] = chosen[0] * state[8] + chosen[1] * noise[8]


def at_rest(f: Array, g: Array, noise: Array) -> Array:
    """Draw a state of filters that have run for ever: the sum of all Φⁿ Q Φⁿᵀ, by doubling.

    Parameters
    ----------
    f, g : ndarray, shape (3, 3, 3)
        `coefficients` of u, v and w.
    noise : ndarray, shape (9,)
        Independent standard normal numbers.
    """
    drawn: list[float] = []
    normal = iter(noise.tolist())
    for transition, root in zip(f, g, strict=True):
        covariance, power = root @ root.T, transition.copy()
        for _ in range(64):  # 2⁶⁴ steps; underflow to 0 is what is meant
            covariance += power @ covariance @ power.T
            power = power @ power
        kept = np.flatnonzero(np.diag(covariance) > 0.0)
        part = np.linalg.cholesky(covariance[np.ix_(kept, kept)])
        drawn += (part @ [next(normal) for _ in kept]).tolist()
    return np.array([*drawn, next(normal)])
