"""Dryden's turbulence as the specifications print it, and the statistics that a record is held against it by.

Written from MIL-F-8785C 3.7.2.2, 3.7.3.4, 3.7.5 and MIL-HDBK-1797 appendix, each with its own lengths, over the spatial
frequency Ω, rad per unit of length; nothing of the package is used. Spectra are one-sided: the variance is their
integral from 0. A record's samples hold the folded spectrum, so that is what a record is compared with.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

Array = NDArray[Any]
Spectrum = Callable[[Array], Array]

FOOT = 0.3048  # m
GUSTS = ("u", "v", "w", "p", "q", "r")
HANN = 1.0 + 2.0 * ((2.0 / 3.0) ** 2 + (1.0 / 6.0) ** 2)  # what its overlap takes of a periodogram's freedom
IMAGES = 12  # on either side that are summed; what is beyond them falls as 1/ω² and is added in closed form


@dataclass(frozen=True)
class Air:
    """Lengths, m, as the specification names them, and standard deviations, m/s, of u, v and w."""

    along: float
    across: float
    down: float
    sd_u: float
    sd_v: float
    sd_w: float
    handbook: bool  # MIL-HDBK-1797; else MIL-F-8785C


def low(height: float, wind_20ft: float, handbook: bool = False) -> Air:
    """Low altitude, 10 … 1000 ft above the ground; height, m, wind, m/s."""
    h = height / FOOT
    shape = 0.177 + 0.000823 * h
    sd_w = 0.1 * wind_20ft
    sd_u = sd_w / shape**0.4
    along = h / shape**1.2 * FOOT
    if handbook:
        return Air(along, along / 2.0, height / 2.0, sd_u, sd_u, sd_w, True)
    return Air(along, along, height, sd_u, sd_u, sd_w, False)


def high(sd: float, handbook: bool = False) -> Air:
    """Above 2000 ft."""
    length = 1750.0 * FOOT
    other = length / 2.0 if handbook else length
    return Air(length, other, other, sd, sd, sd, handbook)


def spatial(air: Air, span: float) -> dict[str, Spectrum]:
    """Return the spectra over Ω, rad/m: (m/s)² or, of p, q and r, (rad/s)² a rad/m."""

    def u(k: Array) -> Array:
        return air.sd_u**2 * 2.0 * air.along / np.pi / (1.0 + (air.along * k) ** 2)

    def lateral(sd: float, length: float) -> Spectrum:
        if air.handbook:
            return lambda k: (
                sd**2 * 2.0 * length / np.pi * (1 + 12 * (length * k) ** 2) / (1 + 4 * (length * k) ** 2) ** 2
            )
        return lambda k: sd**2 * length / np.pi * (1 + 3 * (length * k) ** 2) / (1 + (length * k) ** 2) ** 2

    def p(k: Array) -> Array:
        if air.handbook:
            top = air.sd_w**2 / (2.0 * air.down) * 0.8 * (2.0 * np.pi * air.down / (4.0 * span)) ** (1.0 / 3.0)
        else:
            top = air.sd_w**2 / air.down * 0.8 * (np.pi * air.down / (4.0 * span)) ** (1.0 / 3.0)
        return top / (1.0 + (4.0 * span * k / np.pi) ** 2)

    v, w = lateral(air.sd_v, air.across), lateral(air.sd_w, air.down)
    return {
        "u": u,
        "v": v,
        "w": w,
        "p": p,
        "q": lambda k: k**2 / (1.0 + (4.0 * span * k / np.pi) ** 2) * w(k),
        "r": lambda k: k**2 / (1.0 + (3.0 * span * k / np.pi) ** 2) * v(k),
    }


def in_time(spectrum: Spectrum, speed: float) -> Spectrum:
    """Return the spectrum over ω, rad/s, of air that passes at a speed, m/s (frozen turbulence)."""
    return lambda omega: spectrum(omega / speed) / speed


def turned(speed: float, span: float, factor: float) -> Spectrum:
    """Response, at ω, of how fast the air turns to the gust: (iω/V)/(1 + i factor·b ω/(π V)), without its sign."""
    return lambda omega: 1j * omega / speed / (1.0 + 1j * factor * span * omega / (np.pi * speed))


def folded(spectrum: Spectrum, omega: Array, dt: float) -> Array:
    """Two-sided density over ω, rad/s, of samples each dt of a process whose one-sided spectrum is given.

    Complex ones are taken at signed frequencies; their real part is to fall as 1/ω², their imaginary part as 1/ω.
    """
    turn = 2.0 * np.pi / dt
    total = sum(0.5 * spectrum(omega + k * turn) for k in range(-IMAGES, IMAGES + 1))
    far = 1e4 * turn
    rest = 0.5 * np.real(spectrum(np.array([far])))[0] * far**2
    # of the images k beyond, in pairs: Σ 1/(k turn)² from IMAGES + 1 on is 1/((IMAGES + ½) turn²) to 1e-3 of itself
    return np.asarray(total + 2.0 * rest / ((IMAGES + 0.5) * turn**2))


def of_record(spectrum: Spectrum, steps: int, dt: float) -> tuple[float, float]:
    """Return the variance, and how many independent values of zero mean tell it as surely as a record does.

    The latter is n²/Σ_ij ρ(i − j)², the autocorrelation ρ being that of the folded spectrum.
    """
    omega = 2.0 * np.pi * np.fft.rfftfreq(2 * steps, dt)
    covariance = np.fft.irfft(folded(spectrum, omega, dt))[:steps] * 2.0 * np.pi / dt
    square = (covariance / covariance[0]) ** 2
    pairs = 2.0 * np.arange(steps, 0, -1)
    pairs[0] = steps
    return float(covariance[0]), float(steps**2 / np.sum(pairs * square))


@dataclass(frozen=True)
class Finding:
    """One comparison of a family: what was measured over what is asked, its standard deviation, its probability."""

    name: str
    ratio: float
    sd: float
    p: float


def of_power(name: str, ratio: float, freedom: float) -> Finding:
    """Return the finding of a mean power that is χ² with so many degrees of freedom."""
    below = float(chi2.cdf(ratio * freedom, freedom))
    return Finding(name, ratio, float(np.sqrt(2.0 / freedom)), 2.0 * min(below, 1.0 - below))


def of_normal(name: str, value: float, asked: float, sd: float) -> Finding:
    """Return the finding of a normal value."""
    return Finding(name, value - asked, sd, float(2.0 * norm.sf(abs(value - asked) / sd)))


def transformed(values: Array, dt: float) -> tuple[Array, Array]:
    """ω, rad/s, and the transform under Hann's window, scaled so that its square is the two-sided density over ω."""
    n = len(values)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n) / n)
    scale = np.sqrt(dt / (2.0 * np.pi * np.sum(window**2)))
    found = np.fft.rfft(values * window) * scale
    return 2.0 * np.pi * np.fft.rfftfreq(n, dt)[2:-1], found[2:-1]


def bins(count: int, least: int, number: int) -> list[slice]:
    """Return runs of frequencies, evenly wide on a logarithmic scale, of at least so many each."""
    edges = np.unique(np.geomspace(least, count, number + 1).astype(int))
    edges[0] = 0
    return [slice(a, b) for a, b in pairwise(edges) if b - a >= least // 2]


def holm(findings: Iterable[Finding], level: float = 0.01) -> list[Finding]:
    """Return what is rejected at a level over the whole family (Holm 1979)."""
    ranked = sorted(findings, key=lambda f: f.p)
    rejected = []
    for i, finding in enumerate(ranked):
        if finding.p > level / (len(ranked) - i):
            break
        rejected.append(finding)
    return rejected


def judged(values: Array, laws: dict[str, Spectrum], crossed: dict[str, Spectrum], dt: float) -> list[Finding]:
    """Hold a record against its law: variances, densities in bins, slopes, and cross-spectra of all pairs.

    Parameters
    ----------
    values : ndarray, shape (n, 6)
        u, v, w, p, q, r each dt.
    laws : dict
        One-sided spectrum of each, over ω.
    crossed : dict
        Of a pair that is not independent, as "wq": the one-sided cross-spectrum conj(first)·second, over ω.
    """
    n = len(values)
    found, transforms, densities = [], {}, {}
    for i, name in enumerate(GUSTS):
        omega, transforms[name] = transformed(values[:, i], dt)
        densities[name] = folded(laws[name], omega, dt)
        variance, freedom = of_record(laws[name], n, dt)
        found.append(of_power(f"variance of {name}", float(np.mean(values[:, i] ** 2) / variance), freedom))
        power = np.abs(transforms[name]) ** 2 / densities[name]
        at, off, sure = [], [], []
        for part in bins(len(omega), 24, 12):
            freedom = 2.0 * (part.stop - part.start) / HANN
            mean = float(power[part].mean())
            found.append(of_power(f"density of {name} at {omega[part].mean():.3g} rad/s", mean, freedom))
            at.append(np.log(omega[part]).mean())
            off.append(np.log(mean) + 1.0 / freedom)  # the mean of the logarithm of χ²/ν is −1/ν
            sure.append(freedom / 2.0)
        x, y, weight = np.array(at), np.array(off), np.array(sure)
        x = x - np.average(x, weights=weight)
        spread = float(np.sum(weight * x**2))
        found.append(of_normal(f"slope of {name}", float(np.sum(weight * x * y)) / spread, 0.0, spread**-0.5))
    for i, one in enumerate(GUSTS):
        for two in GUSTS[i + 1 :]:
            law = crossed.get(one + two)
            asked = np.zeros(len(omega), complex) if law is None else folded(law, omega, dt)
            scale = np.sqrt(densities[one] * densities[two])
            product = transforms[one].conj() * transforms[two] / scale
            for part in bins(len(omega), 400, 4):
                share = float((part.stop - part.start) / HANN)
                mean, coherent = product[part].mean(), (asked / scale)[part].mean()
                for axis, side in (("real", 1.0), ("imaginary", -1.0)):
                    of = np.real if axis == "real" else np.imag
                    square = float(np.real(np.mean((asked / scale)[part] ** 2)))
                    sd = float(np.sqrt((1.0 + side * square) / (2.0 * share))) + 1e-3
                    name = f"{axis} cross-spectrum of {one}, {two} at {omega[part].mean():.3g} rad/s"
                    found.append(of_normal(name, float(of(mean)), float(of(coherent)), sd))
    return found
