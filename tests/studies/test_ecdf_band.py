"""The band of an empirical distribution, against its definition and its promise."""

import numpy as np
import pytest
from scipy.stats import binom

from uavsim.studies.quantiles import ecdf_band


@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
@pytest.mark.parametrize("n", [1, 10, 57])
def test_bounds_are_where_the_binomial_tails_are(n: int, confidence: float) -> None:
    """Clopper and Pearson's definition: at the bounds the tail beyond k has half of the error rate; to 1e-9."""
    band = ecdf_band(np.arange(float(n)), confidence)
    k, tail = np.arange(n + 1), (1.0 - confidence) / 2.0
    assert band.value.tolist() == [-np.inf, *range(n)]
    np.testing.assert_allclose(band.share, k / n)
    np.testing.assert_allclose(binom.sf(k[1:] - 1, n, band.low[1:]), tail, rtol=1e-9)
    np.testing.assert_allclose(binom.cdf(k[:-1], n, band.high[:-1]), tail, rtol=1e-9)
    assert (band.low[0], band.high[-1]) == (0.0, 1.0)


def test_a_textbook_interval() -> None:
    """0 and 5 of 10 at 95 %: 0 to 0.3085 and 0.1871 to 0.8129 (Clopper & Pearson 1934; R's binom.test)."""
    band = ecdf_band(np.arange(10.0))
    assert band.high[0] == pytest.approx(0.3085, abs=5e-5)
    assert (band.low[5], band.high[5]) == pytest.approx((0.1871, 0.8129), abs=5e-5)


@pytest.mark.parametrize("truth", [0.02, 0.3, 0.5, 0.97])
def test_the_band_covers_what_it_promises(truth: float) -> None:
    """Summed over all outcomes of 25 flights, so without chance: F(x) lies in the band with 95 % or more."""
    n = 25
    band = ecdf_band(np.arange(float(n)), 0.95)
    inside = (band.low <= truth) & (truth <= band.high)
    assert binom.pmf(np.arange(n + 1), n, truth)[inside].sum() >= 0.95


def test_what_never_happened_counts_in_the_number_only() -> None:
    band = ecdf_band(np.array([3.0, np.inf, 1.0, 3.0]))
    assert band.value.tolist() == [-np.inf, 1.0, 3.0]
    assert band.share.tolist() == [0.0, 0.25, 0.75]
    assert band.high[-1] < 1.0
    assert ecdf_band(np.array([np.inf])).value.tolist() == [-np.inf]


@pytest.mark.parametrize(("sample", "confidence"), [([], 0.95), ([1.0, np.nan], 0.95), ([1.0], 1.0), ([1.0], 0.0)])
def test_what_is_no_sample_is_refused(sample: list[float], confidence: float) -> None:
    with pytest.raises(ValueError, match=r"must lie|needs at least"):
        ecdf_band(np.array(sample), confidence)
