"""The overlapping Allan deviation and its degrees of freedom.

Authorities: the 9 and the 1000 points that NIST publishes (SP 1065, section 12.4), allantools, which is installed for
this alone, and SP 1065's own approximation of the degrees of freedom for white noise. How often an interval holds the
truth is in `test_sensors_characterise`.
"""

import allantools
import numpy as np
import pytest
from allantools.ci import confidence_interval, edf_greenhall

from sensors.allan_record import degrees_of_freedom, interval, overlapping

NINE = np.array([892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0])  # NIST SP 1065, table 30
MULTIPLES = (1, 2, 3, 5, 10, 17, 33, 34, 60, 100, 200, 333, 450, 1000, 1700, 2400)


def thousand() -> np.ndarray:
    """n_0 = 1234567890, n ← 16807 n mod 2147483647, over that number."""
    n = [1234567890]
    while len(n) < 1000:
        n.append(16807 * n[-1] % 2147483647)
    return np.array(n) / 2147483647


def test_nists_published_deviations() -> None:
    """To the last of seven digits."""
    assert overlapping(NINE, [1, 2]) == pytest.approx([91.22945, 85.95287], rel=1e-7)
    assert overlapping(thousand(), [1, 10, 100]) == pytest.approx([2.922319e-1, 9.159953e-2, 3.241343e-2], rel=2e-7)


@pytest.mark.parametrize("size", [9, 33, 100, 1000, 5000])
def test_deviations_are_those_of_allantools(size: int) -> None:
    """A random walk about 100 kPa: the mean, which is taken off, must not cost digits."""
    values = np.random.default_rng(size).standard_normal(size).cumsum() + 1e5
    multiples = [m for m in MULTIPLES if 2 * m <= size]
    _, expected, _, _ = allantools.oadev(values, rate=1.0, data_type="freq", taus=np.array(multiples, dtype=float))
    assert overlapping(values, multiples) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("alpha", [0, -1, -2])
def test_degrees_of_freedom_are_those_of_allantools(alpha: int) -> None:
    """Greenhall and Riley's three cases and both of their sums: short and long averages, short and long records."""
    for size in (9, 33, 64, 100, 1000, 5000, 1 << 20):
        for m in (m for m in (*MULTIPLES, 1 << 17) if 2 * m <= size):
            expected = edf_greenhall(alpha, 2, m, size + 1, overlapping=True)
            assert degrees_of_freedom(alpha, m, size) == pytest.approx(expected, rel=1e-9), (size, m)


@pytest.mark.parametrize("m", [3, 10, 50])
def test_degrees_of_freedom_of_white_noise_are_about_those_of_sp_1065(m: int) -> None:
    """(3 (N − 1)/2m − 2 (N − 2)/N) 4m²/(4m² + 5), SP 1065's approximation, N = 1001: 146.2 for m = 10. Within 15 %.

    At m = 1 Greenhall and Riley have 782 where white noise has 666: they average the phase, which one reading does not.
    """
    n = 1001
    simple = (3.0 * (n - 1) / (2.0 * m) - 2.0 * (n - 2) / n) * 4.0 * m**2 / (4.0 * m**2 + 5.0)
    assert degrees_of_freedom(0, m, n - 1) == pytest.approx(simple, rel=0.15)


@pytest.mark.parametrize("confidence", [0.6826895, 0.95])
def test_intervals_are_chi_squares(confidence: float) -> None:
    deviation, edf = np.array([2.0, 0.3, 5.0]), np.array([1.2, 30.0, 4000.0])
    expected = [confidence_interval(d, f, confidence) for d, f in zip(deviation, edf, strict=True)]
    assert np.transpose(interval(deviation, edf, confidence)) == pytest.approx(np.array(expected), rel=1e-9)


@pytest.mark.parametrize("m", [0, -1, 5])
def test_an_averaging_time_that_the_record_does_not_hold_twice_is_refused(m: int) -> None:
    with pytest.raises(ValueError, match="from 1 to half of the record's 9"):
        overlapping(NINE, [1, m])
