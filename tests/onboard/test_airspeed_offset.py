"""A constant offset and a wandering angle of attack as one process: its variance and its short-time density.

Authority: for independent processes variances and densities add (Papoulis 1991, 9-3); of a Gauss-Markov process of
deviation σ and correlation time τ they are σ² and 2σ²/τ (Brown & Hwang, ch. 3).
"""

import pytest

from uavsim.onboard.airspeed import NoiseModel
from uavsim.onboard.airspeed.aided import AidedFilter
from uavsim.onboard.airspeed.frozen import FrozenTest
from uavsim.onboard.airspeed.offset import with_offset
from uavsim.onboard.airspeed.settings import AidedSettings, EstimatorSettings


@pytest.mark.parametrize("offset", [0.2, 2.0, 10.0])
def test_variances_and_densities_add(offset: float) -> None:
    wander = AidedSettings(bias_sd=0.3, bias_time=5.0)
    both = with_offset(wander, offset)
    assert both.bias_sd**2 == pytest.approx(0.3**2 + offset**2)
    assert 2.0 * both.bias_sd**2 / both.bias_time == pytest.approx(2.0 * 0.3**2 / 5.0)


def test_without_an_offset_nothing_changes() -> None:
    assert with_offset(AidedSettings(), 0.0) == AidedSettings()


def test_the_filter_starts_with_both_and_keeps_slope_and_bias_tied() -> None:
    """At rest b + s is what f_x reads, known to the noise of its mean; b alone is not."""
    noise = NoiseModel(5.0, 5.0, 0.5, accelerometer_offset_sd=2.0, accelerometer_sd=0.1)
    aided = AidedFilter(EstimatorSettings(), noise)
    for n in range(2000):
        aided.accelerometer(n / 1000.0, 4.1, 0.0, -9.6)
    aided.launched(2.0)
    energy = aided.energy
    assert energy.bb == pytest.approx(4.09)
    assert energy.s + energy.b == pytest.approx(4.1)
    assert energy.bb + 2.0 * energy.bs + energy.ss < 0.03**2


def test_the_watch_grants_the_offset() -> None:
    assert FrozenTest(9.0, 0.002, False, 2.0).lost_variance == pytest.approx(0.5**2 + 2.0**2)
