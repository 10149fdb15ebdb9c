"""The earliest that any detector can tell a launch from a lesser load: the Neyman-Pearson bound.

The launch's force s_k (m/s², sample k at k·T after its onset) is known in shape and time and read in independent
Gaussian noise of deviation σ. It has to be told from every load that stays at or below a level L, say a run on the
centrifuge at 4.1 g. The load hardest to tell from it follows it up to L and stays there, min(s_k, L): what is left to
see is the part above L. For two known means in white noise the likelihood ratio is the best test; after samples 0 … k

    d_k² = Σ_{j ≤ k} max(s_j - L, 0)² / σ²,        P_D = Q(Q⁻¹(P_FA) - d_k),        Q(x) = 1 - Φ(x)

Source: Kay, Fundamentals of Statistical Signal Processing II: Detection Theory, 1998, 4.3.2 (matched filter); Lehmann &
Romano, Testing Statistical Hypotheses, 3rd ed., theorem 3.8.1 (least favourable distribution: a test that keeps P_FA
for min(s, L) keeps it for all loads below L, because it adds readings with weights that are not negative).

A real detector knows neither onset nor shape, so that none can be faster. P_FA is that of one decision, not a rate.
"""

import numpy as np
from numpy.typing import NDArray


def detection_probability(
    curve: NDArray[np.float64], *, level: float, sigma: float, false_alarm: float = 1e-6
) -> NDArray[np.float64]:
    """Probability with which the best test has recognised the launch, at each deadline.

    Parameters
    ----------
    curve
        Shape (n,): mean reading of each sample from the onset on, gravity along the rail included, m/s².
    level
        L, the largest load that is not a launch, m/s².
    sigma
        Standard deviation of a reading, m/s².
    false_alarm
        P_FA at each deadline, for any load up to the level.

    Returns
    -------
    ndarray
        Shape (n,): entry k is the largest P_D that samples 0 … k allow; P_FA while the curve has not exceeded L.

    Raises
    ------
    ValueError
        If the curve is empty or not finite, sigma not above 0, or the probability outside (0, 1).
    """
    from scipy.special import ndtr, ndtri

    if curve.ndim != 1 or curve.size == 0 or not np.isfinite(curve).all() or not np.isfinite(level):
        raise ValueError("curve must hold at least one value, and it and level be finite")
    if not 0.0 < sigma < np.inf:
        raise ValueError("sigma must be above 0 and finite")
    if not 0.0 < false_alarm < 1.0:
        raise ValueError("false_alarm must lie between 0 and 1")
    excess = np.maximum(curve - level, 0.0) / sigma
    distance = np.sqrt(np.cumsum(excess**2))
    return np.asarray(ndtr(ndtri(false_alarm) + distance), dtype=np.float64)


def earliest_deadline(
    curve: NDArray[np.float64],
    *,
    level: float,
    sigma: float,
    probability: float = 0.99,
    false_alarm: float = 1e-6,
    period: float = 1e-3,
) -> float | None:
    """Time after the onset before which no detector reaches a detection probability.

    Parameters
    ----------
    curve, level, sigma, false_alarm
        As for `detection_probability`.
    probability
        P_D that is wanted.
    period
        T, time between samples, s.

    Returns
    -------
    float or None
        k·T of the first sample k that is enough, s; None if all samples are not: then no detector can do it at all.

    Raises
    ------
    ValueError
        As `detection_probability`; also if the wanted probability lies outside (0, 1) or the period is not above 0.
    """
    if not 0.0 < probability < 1.0:
        raise ValueError("probability must lie between 0 and 1")
    if not 0.0 < period < np.inf:
        raise ValueError("period must be above 0 and finite")
    enough = detection_probability(curve, level=level, sigma=sigma, false_alarm=false_alarm) >= probability
    return float(np.argmax(enough)) * period if enough.any() else None
