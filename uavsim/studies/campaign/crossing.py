"""How much of a varied quantity can be afforded: where the probability of meeting a requirement crosses a wanted one.

A sweep gives, for each of m values x_1 < … < x_m, whether each of n flights met the requirement. With p(x) the
probability of meeting it, the limit is x* with p(x*) = w. All that is assumed is that p does not rise going outward
from a cell where it is met (`outward`). Three answers, from the least assumed to the most:

band       by exact tests, cell by cell. Going outward, cells are shown to be good as long as the Clopper-Pearson lower
           bound of p is at least w; the first that is not ends it. Coming inward from the far end, cells are shown to
           be bad as long as the upper bound is below w. A fixed order needs no correction for many tests (Maurer,
           Hothorn and Lehmacher 1995): each end errs with at most (1 - confidence)/2, since only the first cell whose
           hypothesis is true counts, whatever cells have in common; they may be flown with common random numbers. It
           is no finer than the grid, and a good cell needs `fewest` flights.
estimate   isotonic regression of the shares (pool adjacent violators; Barlow et al. 1972), joined between cells by
           straight lines in logit p, as log((k + 1/2)/(n - k + 1/2)).
logistic   logit p = a + b x, by Firth's penalised likelihood (Biometrika 80, 1993, 27-38). Its interval is Fieller's,
           {x : (a + b x - logit w)² ≤ t² var(a + b x)}, with the covariance of a and b from the scores of whole
           flights (Liang and Zeger 1986), since the cells of a flight share its draws. Right only where the curve is
           logistic; not given where fewer than two cells are mixed, where the curve does not fit (Pearson's X², 1 %),
           or for fewer than `FEWEST_LOGISTIC` flights, of which the interval would hold the limit too seldom.

For a number with one bound the direct quantile is another estimate: p(x*) = w says that the w-quantile of the number
is the bound (of 1 - w for a least value); the quantiles of the cells are joined linearly.
"""

from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.intervals import share_interval

Array = NDArray[np.float64]

STEPS = 60  # of Newton's, at most; from a = b = 0 it takes about ten
SETTLED = 1e-8
FEWEST_LOGISTIC = 50  # flights; with 30 the interval at 95 % held the limit in 91 % of 1000 repetitions
MISFIT = 0.01  # chance of a worse X² below which a logistic curve is not believed


@dataclass(frozen=True, slots=True)
class Crossing:
    """Where a requirement breaks, going one way from `start`.

    Attributes
    ----------
    rising
        Whether it is sought toward greater values.
    start
        Value that it is sought from, where most flights meet it.
    state
        "breaks"; "holds": the share is at least the wanted one to the end of the grid; "broken": it is nowhere.
    estimate
        By isotonic regression; None unless it breaks.
    held, lost
        The band: shown to hold up to `held`, shown to be broken from `lost` on; None where no cell is.
    quantile
        By the direct quantile; None without a number, with two bounds, or outside the grid.
    logistic, logistic_low, logistic_high
        By the logistic curve; None outside the grid, and where there is nothing to fit.
    """

    rising: bool
    start: float
    state: str
    estimate: float | None
    held: float | None
    lost: float | None
    quantile: float | None = None
    logistic: float | None = None
    logistic_low: float | None = None
    logistic_high: float | None = None

    @property
    def low(self) -> float | None:
        """Lower end of the band; None where it is open."""
        return self.held if self.rising else self.lost

    @property
    def high(self) -> float | None:
        """Upper end of the band; None where it is open."""
        return self.lost if self.rising else self.held


def fewest(wanted: float, confidence: float = 0.95) -> int:
    """Flights a cell of which all must meet a requirement for the cell to be shown good: w^n ≤ (1 - confidence)/2."""
    return int(np.ceil(log((1.0 - confidence) / 2.0) / log(wanted) - 1e-9))


def crossings(
    x: Array,
    met: Array,
    wanted: float,
    *,
    own: float | None = None,
    confidence: float = 0.95,
    values: Array | None = None,
    minimum: float | None = None,
    maximum: float | None = None,
) -> tuple[Crossing, ...]:
    """Find where a requirement breaks, toward greater values and toward smaller ones.

    Parameters
    ----------
    x
        Values of the cells, rising, shape (m,).
    met
        1 where flight i met it in cell j, 0 where it did not, NaN where it was not flown; shape (n, m).
    wanted
        Probability, 0 … 1 exclusive.
    own
        The scenario's own value: the cell nearest to it is the start if it is good, and of equally good ones else.
    confidence
        Of band and interval; each tail has half of what is left.
    values, minimum, maximum
        The number that is bounded, shape (n, m), NaN where it does not exist, and its bounds.

    Returns
    -------
    tuple of Crossing
        One for each direction in which there are cells.

    Raises
    ------
    ValueError
        If shapes do not fit, x does not rise, a cell has no flight, or a probability lies outside (0, 1).
    """
    if met.shape[1:] != x.shape or x.size < 2 or not np.all(np.diff(x) > 0.0):
        raise ValueError("a limit needs two values or more, rising, and a column of flights for each")
    flown = np.isfinite(met).sum(axis=0)
    if not flown.all():
        raise ValueError("a cell has no flight")
    if not 0.0 < wanted < 1.0 or not 0.0 < confidence < 1.0:
        raise ValueError("probabilities must lie between 0 and 1")
    good = np.nansum(met, axis=0)
    start = _start(x, good / flown, wanted, own)
    direct = None if values is None else _quantiles(values, met, wanted, minimum, maximum)
    found = []
    for rising in (True, False):
        way = np.arange(start, x.size) if rising else np.arange(start, -1, -1)
        if way.size < 2:
            continue
        curve = _logistic(x[way], met[:, way], wanted, confidence)
        state, estimate = _isotonic(x[way], good[way], flown[way], wanted)
        held, lost = _band(x[way], good[way], flown[way], wanted, confidence)
        quantile = None if direct is None else _direct(x[way], direct[way], minimum, maximum)
        found.append(Crossing(rising, float(x[start]), state, estimate, held, lost, quantile, *curve))
    return tuple(found)


def _start(x: Array, share: Array, wanted: float, own: float | None) -> int:
    """Cell that limits are sought from: the scenario's own value where that is good, else one of the best share."""
    if own is not None:
        nearest = int(np.argmin(np.abs(x - own)))
        if share[nearest] >= wanted:
            return nearest
    best = np.flatnonzero(share == share.max())
    return int(best[0] if own is None else best[np.argmin(np.abs(x[best] - own))])


# -- without a model -------------------------------------------------------------------------------------------------


def falling(share: Array, weight: Array) -> Array:
    """Isotonic regression: the nearest values, in weighted squares, that do not rise; shape (m,)."""
    blocks: list[list[float]] = []  # mean, weight, length
    for one, mass in zip(share.tolist(), weight.tolist(), strict=True):
        blocks.append([one, mass, 1])
        while len(blocks) > 1 and blocks[-1][0] > blocks[-2][0]:
            mean, more, length = blocks.pop()
            last = blocks[-1]
            last[0] = (last[0] * last[1] + mean * more) / (last[1] + more)
            last[1] += more
            last[2] += length
    return np.concatenate([np.full(int(length), mean) for mean, _, length in blocks])


def _isotonic(x: Array, good: Array, flown: NDArray[np.int_], wanted: float) -> tuple[str, float | None]:
    """Return the state and the limit, going outward along x."""
    fit = falling(good / flown, flown.astype(np.float64))
    below = np.flatnonzero(fit < wanted - 1e-12)
    if not below.size:
        return "holds", None
    if below[0] == 0:
        return "broken", None
    logits = _logit(fit * flown, flown.astype(np.float64))
    j = int(below[0])
    level = _logit(wanted * flown[j], float(flown[j]))
    return "breaks", _between(x, np.array([max(logits[j - 1], level), min(logits[j], level)]), j, level)


def _logit(good: Any, flown: Any) -> Any:
    """Return the empirical logit, which exists for none and for all."""
    return np.log((good + 0.5) / (flown - good + 0.5))


def _between(x: Array, ends: Array, j: int, level: float) -> float:
    """Where the line between two values, at points j - 1 and j, has a level."""
    first, last = ends
    share = (first - level) / (first - last) if first != last else 1.0
    return float(x[j - 1] + share * (x[j] - x[j - 1]))


def _band(
    x: Array, good: Array, flown: NDArray[np.int_], wanted: float, confidence: float
) -> tuple[float | None, float | None]:
    """Return the last cell outward that is shown to be good, and the first from which on all are shown to be bad."""
    bounds = [share_interval(int(k), int(n), confidence) for k, n in zip(good, flown, strict=True)]
    held = lost = None
    for value, (low, _) in zip(x, bounds, strict=True):
        if low < wanted:
            break
        held = float(value)
    for value, (_, high) in zip(x[::-1], bounds[::-1], strict=True):
        if high >= wanted:
            break
        lost = float(value)
    return held, lost


def _quantiles(values: Array, met: Array, wanted: float, minimum: float | None, maximum: float | None) -> Array | None:
    """Quantile of each cell that must not leave the bound; a flight without the number is beyond it."""
    if (minimum is None) == (maximum is None):
        return None
    beyond = np.inf if maximum is not None else -np.inf
    filled = np.where(np.isnan(values), beyond, values)
    share = wanted if maximum is not None else 1.0 - wanted
    found = []
    for column, there in zip(filled.T, np.isfinite(met).T, strict=True):
        ordered = np.sort(column[there])
        place = share * (ordered.size - 1)
        low, high = int(np.floor(place)), int(np.ceil(place))
        part = place - low
        found.append(ordered[low] if not part else (1.0 - part) * ordered[low] + part * ordered[high])
    return np.array(found)


def _direct(x: Array, quantile: Array, minimum: float | None, maximum: float | None) -> float | None:
    """Where the quantile passes the bound, going outward; None if it does not, or the cell beyond has none."""
    sign, bound = (1.0, maximum) if maximum is not None else (-1.0, minimum)
    assert bound is not None
    excess = sign * (quantile - bound)
    beyond = np.flatnonzero(excess > 0.0)
    if not beyond.size or beyond[0] == 0 or not np.isfinite(excess[beyond[0]]):
        return None
    j = int(beyond[0])
    if not np.isfinite(excess[j - 1]):
        return None
    return _between(x, -excess[j - 1 : j + 1], j, 0.0)


# -- logistic --------------------------------------------------------------------------------------------------------


def _logistic(
    x: Array, met: Array, wanted: float, confidence: float
) -> tuple[float | None, float | None, float | None]:
    """Return the limit of a logistic curve and its interval; None outside the grid, and where it is not believed."""
    there = np.isfinite(met)
    good, flown = np.nansum(met, axis=0), there.sum(axis=0).astype(np.float64)
    mixed = (good > 0.0) & (good < flown)
    if mixed.sum() < 2 or met.shape[0] < FEWEST_LOGISTIC:
        return None, None, None
    inner = (x - x[0]) / (x[-1] - x[0])  # 0 … 1 going outward
    a, b, p, information = _firth(inner, good, flown)
    if b >= 0.0 or not _fits(good, flown, p):
        return None, None, None
    level = log(wanted / (1.0 - wanted))
    found = (level - a) / b
    if not 0.0 <= found <= 1.0:
        return None, None, None
    residual = np.where(there, met - p, 0.0)
    scores = np.stack([residual.sum(axis=1), residual @ inner])  # a column a flight
    count = met.shape[0]
    spread = scores @ scores.T * (count / (count - 1))
    covariance = np.linalg.solve(information, np.linalg.solve(information, spread).T).astype(np.float64)
    ends = [
        _outer(x, end) if 0.0 <= end <= 1.0 else None for end in _fieller(a, b, covariance, level, count, confidence)
    ]
    low, high = ends if x[-1] > x[0] else ends[::-1]
    return _outer(x, found), low, high


def _outer(x: Array, inner: float) -> float:
    return float(x[0] + inner * (x[-1] - x[0]))


def _firth(x: Array, good: Array, flown: Array) -> tuple[float, float, Array, Array]:
    """Fit logit p = a + b x; return a, b, p and the information matrix."""
    a = b = 0.0
    design = np.stack([np.ones_like(x), x])
    for _ in range(STEPS):
        p = 1.0 / (1.0 + np.exp(-np.clip(a + b * x, -35.0, 35.0)))
        weight = flown * p * (1.0 - p)
        information = (design * weight) @ design.T
        inverse = np.linalg.inv(information)
        leverage = weight * np.einsum("im,ij,jm->m", design, inverse, design)
        step = inverse @ (design @ (good - flown * p + leverage * (0.5 - p)))
        step *= min(1.0, 5.0 / max(float(np.abs(step).max()), 1e-12))
        a, b = a + float(step[0]), b + float(step[1])
        if np.abs(step).max() < SETTLED:
            break
    return a, b, p, information


def _fits(good: Array, flown: Array, p: Array) -> bool:
    """Whether Pearson's X² does not refute a curve with two parameters."""
    from scipy.special import gammaincc

    if p.size < 3:
        return True
    squares = (good - flown * p) ** 2 / np.maximum(flown * p * (1.0 - p), 1e-12)
    return bool(gammaincc(0.5 * (p.size - 2), 0.5 * float(squares.sum())) >= MISFIT)


def _fieller(a: float, b: float, covariance: Array, level: float, count: int, confidence: float) -> tuple[float, float]:
    """Return where a + b x may have a level; infinite where the slope may be none."""
    from scipy.special import stdtrit

    t2 = float(stdtrit(count - 1, 0.5 * (1.0 + confidence))) ** 2
    square = b * b - t2 * covariance[1, 1]
    half = b * (a - level) - t2 * covariance[0, 1]
    rest = (a - level) ** 2 - t2 * covariance[0, 0]
    root = half * half - square * rest
    if square <= 0.0 or root < 0.0:
        return -np.inf, np.inf
    return float((-half - root**0.5) / square), float((-half + root**0.5) / square)
