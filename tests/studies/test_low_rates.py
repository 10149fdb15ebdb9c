"""Slow logs: a low-pass that lets through what it should, who decides on one reading, and what that costs."""

from dataclasses import replace

import numpy as np
import pytest

from uavsim.onboard.launch import DetectorSettings
from uavsim.studies import low_rates
from uavsim.studies.low_rates import Alarms, alarms, bound, decides_alone, delays, lowpass, remark, slowed

OURS = DetectorSettings()
QUICK = replace(OURS, adaptive=replace(OURS.adaptive, confirm=False))
PAPERS = DetectorSettings(kind="multi-level-window")


@pytest.mark.parametrize("rate", [50.0, 100.0, 200.0, 250.0])
def test_the_low_pass_is_flat_and_then_nothing(rate: float) -> None:
    taps = lowpass(rate)
    for share, low, high in ((0.05, 0.99, 1.01), (0.3, 0.99, 1.01), (0.4, 0.0, 2e-3), (0.5, 0.0, 2e-3)):
        phase = np.exp(-2j * np.pi * share * rate / 1000.0 * np.arange(taps.size))
        assert low <= abs(phase @ taps) <= high


def test_what_is_above_half_the_rate_comes_back_unless_it_is_filtered_off() -> None:
    t = np.arange(4000) / 1000.0
    shaken = np.column_stack([np.sin(2.0 * np.pi * 49.0 * t)] * 3)
    assert np.abs(slowed(shaken, 50.0, filtered=False)).max() > 0.99
    assert np.abs(slowed(shaken, 50.0, filtered=True)[20:-20]).max() < 2e-3
    with pytest.raises(ValueError, match="no whole part"):
        slowed(shaken, 70.0, filtered=True)


@pytest.mark.parametrize(("rate", "expected"), [(50.0, (False, True, True)), (104.0, (False, True, False))])
def test_who_decides_on_one_reading(rate: float, expected: tuple[bool, ...]) -> None:
    assert tuple(decides_alone(one, rate) for one in (OURS, QUICK, PAPERS)) == expected


def test_to_decide_on_one_reading_costs_alarms() -> None:
    """Ten minutes of handling."""
    plain = alarms((OURS, QUICK), 50.0, 0.1, seed=3, filtered=False)
    quiet = alarms((OURS, QUICK), 50.0, 0.1, seed=3, filtered=True)
    assert [one.count for one in quiet] == [0, 0]
    assert plain[1].rate > 5.0 * plain[0].rate > 0.0
    assert remark(OURS, 50.0) is None
    assert remark(QUICK, 1000.0) is None


def test_what_it_costs_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def counted(detectors: object, rate: float, hours: float, *, seed: int, filtered: bool) -> list[Alarms]:
        assert (rate, hours) == (1000.0 / 18.0, 1.0)
        return [Alarms(0 if filtered else 1234, hours)]

    monkeypatch.setattr(low_rates, "alarms", counted)
    said = remark(QUICK, 57.0)
    assert said is not None
    for words in (
        "adaptive-cusum decides on one reading at 57 Hz",
        "1.23e+03 alarms an hour",
        ", 0 if what is above 22.2",
    ):
        assert words in said


def test_delays_at_50_hz_and_the_bound() -> None:
    """Two readings, 20 ms apart, against one; none is lost, and the bound is sooner at higher rates."""
    ours, quick = (delays(one, 50.0, 200, seed=4, sigma_g=0.3) for one in (OURS, QUICK))
    assert quick.min() > 0.0
    assert np.median(ours) < 0.050
    assert np.quantile(ours, 0.95) < 0.065
    assert np.median(ours) - np.median(quick) == pytest.approx(0.020, abs=0.004)
    least = [bound(rate, 0.3) for rate in (50.0, 100.0, 200.0)]
    assert least == sorted(least, reverse=True)
    assert 0.02 < least[-1] < least[0] < np.median(ours)
