"""Exact intervals for counts.

k of n trials    Clopper-Pearson: B(a; k, n - k + 1) … B(1 - a; k + 1, n - k), quantiles of the beta distribution
                 (Biometrika 26, 1934, 404-413)
k in a time T    Garwood: χ²(a; 2k) / 2T … χ²(1 - a; 2k + 2) / 2T (Biometrika 28, 1936, 437-442)

Each tail has a = (1 - confidence)/2. They cover with at least that confidence, whatever the truth is.
"""


def share_interval(count: int, trials: int, confidence: float = 0.95) -> tuple[float, float]:
    """Bounds of a probability of which `count` of `trials` came true.

    Raises
    ------
    ValueError
        If there are no trials, the count is not among them, or the confidence lies outside (0, 1).
    """
    from scipy.special import betaincinv

    if trials < 1 or not 0 <= count <= trials:
        raise ValueError(f"{count} of {trials} is no share")
    tail = _tail(confidence)
    low = float(betaincinv(count, trials - count + 1, tail)) if count > 0 else 0.0
    return low, float(betaincinv(count + 1, trials - count, 1.0 - tail)) if count < trials else 1.0


def rate_interval(count: int, time: float, confidence: float = 0.95) -> tuple[float, float]:
    """Bounds of the rate of a Poisson process that came `count` times in `time`, one over the unit of time.

    Raises
    ------
    ValueError
        If the time is not above 0, the count negative, or the confidence lies outside (0, 1).
    """
    from scipy.special import gammaincinv

    if not time > 0.0 or count < 0:
        raise ValueError(f"{count} in a time of {time:g} is no rate")
    tail = _tail(confidence)
    low = float(gammaincinv(count, tail)) / time if count > 0 else 0.0
    return low, float(gammaincinv(count + 1, 1.0 - tail)) / time


def _tail(confidence: float) -> float:
    if not 0.0 < confidence < 1.0:
        raise ValueError("the confidence must lie between 0 and 1")
    return (1.0 - confidence) / 2.0
