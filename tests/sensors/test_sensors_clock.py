"""Clocks: times from the integer k, their own rate and phase, jitter that never swaps two events."""

from itertools import islice, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.clock import Clock


def _times(clock, count):
    """Return the first `count` times by `tick`."""
    times = []
    for _ in range(count):
        times.append(clock.due)
        clock.tick()
    return times


def _jittered(sd, rate=833.0, phase=5e-4, seed=1):
    return Clock(rate, phase, jitter=sd, generator=np.random.default_rng(seed))


@pytest.mark.parametrize("rate", [100.0, 498.0, 833.0, 1666.0])
def test_times_are_computed_from_k_and_carry_no_drift(rate):
    """Authority: φ + k/f in plain floats, bit for bit, for twenty minutes at 833 Hz; `later` goes on after `due`."""
    clock = Clock(rate, 3e-4)
    assert clock.due == 3e-4
    times = [clock.later() for _ in range(1_000_000)]
    assert times == [3e-4 + k / rate for k in range(1, 1_000_001)]
    assert _times(Clock(rate, 3e-4), 3000) == [3e-4, *times[:2999]]


def test_a_rate_error_is_a_factor_on_the_rate():
    clock = Clock.drawn(833.0, np.random.default_rng(2), error=0.025)
    assert clock.rate == 833.0 * 1.025
    assert clock.phase == np.random.default_rng(2).random() / clock.rate
    assert _times(clock, 2000) == [clock.phase + k / clock.rate for k in range(2000)]


def test_phase_is_uniform_over_the_time_between_events():
    """Mean 1/2 and variance 1/12 of it; n = 4000, limits at 4.5 sigma: 3.6 % in the mean, 6.4 % in variance."""
    generator = np.random.default_rng(3)
    share = np.array([Clock.drawn(100.0, generator).phase * 100.0 for _ in range(4000)])
    assert share.min() >= 0.0
    assert share.max() < 1.0
    assert share.mean() == pytest.approx(0.5, abs=4.5 / np.sqrt(12 * 4000))
    assert share.var() * 12.0 == pytest.approx(1.0, abs=4.5 * np.sqrt(0.8 / 4000))


def test_without_jitter_nothing_is_drawn():
    generator = np.random.default_rng(4)
    before = generator.bit_generator.state
    still = Clock(833.0, 5e-4, generator=generator)
    assert _times(still, 3000) == [5e-4 + k / 833.0 for k in range(3000)]
    assert generator.bit_generator.state == before


def test_jitter_is_white_and_normal_about_the_clock():
    """n = 102 400; limits at 4.5 sigma of the estimate: 1 % in its standard deviation, 1.4 % correlation is caught."""
    n, sd = 102_400, 1e-5
    jitter = np.array(_times(_jittered(sd), n)) - (5e-4 + np.arange(n) / 833.0)
    assert jitter.mean() == pytest.approx(0.0, abs=4.5 * sd / np.sqrt(n))
    assert jitter.std() == pytest.approx(sd, rel=4.5 / np.sqrt(2 * n))
    assert np.mean(jitter[1:] * jitter[:-1]) / sd**2 == pytest.approx(0.0, abs=4.5 / np.sqrt(n))
    assert np.mean(jitter**4) / sd**4 == pytest.approx(3.0, abs=4.5 * np.sqrt(96 / n))


def test_jitter_changes_neither_phase_nor_rate():
    plain = Clock.drawn(833.0, np.random.default_rng(5))
    shaken = Clock.drawn(833.0, np.random.default_rng(5), jitter=1e-5, jitter_generator=np.random.default_rng(6))
    assert (shaken.phase, shaken.rate) == (plain.phase, plain.rate)
    assert _times(shaken, 100) != _times(plain, 100)


def test_great_jitter_is_held_and_none_is_before_zero():
    times = np.array(_times(_jittered(1.0, phase=0.0), 5000))
    off = np.abs(times - np.arange(5000) / 833.0) * 833.0
    assert off.max() == pytest.approx(0.4, rel=1e-9)
    assert np.mean(off > 0.39) > 0.99
    assert times[0] >= 0.0
    assert any(_times(_jittered(1.0, phase=0.0, seed=seed), 1) == [0.0] for seed in range(10))


@given(st.floats(1e-3, 1e5), st.floats(0.0, 1.0, exclude_max=True), st.floats(0.0, 1e3), st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_events_follow_one_another_whatever_the_jitter(rate, share, jitter, seed):
    clock = _jittered(jitter, rate, share / rate, seed)
    times = list(islice(iter(clock.later, None), 1500))
    assert clock.due >= 0.0
    assert all(earlier < later for earlier, later in pairwise([clock.due, *times]))
    assert times[-1] == pytest.approx((share + 1500) / rate, abs=0.41 / rate)


@pytest.mark.parametrize(
    ("rate", "jitter", "message"),
    [
        (0.0, 0.0, "rate must be above 0 Hz and finite, not 0.0"),
        (-1.0, 0.0, "rate must be above 0 Hz"),
        (float("nan"), 0.0, "rate must be above 0 Hz"),
        (float("inf"), 0.0, "rate must be above 0 Hz"),
        (100.0, -1e-3, "jitter must be at least 0 s and finite, not -0.001"),
        (100.0, float("nan"), "jitter must be at least 0 s"),
        (100.0, 1e-3, "jitter needs a generator"),
    ],
)
def test_what_no_clock_has_is_an_error(rate, jitter, message):
    with pytest.raises(ValueError, match=message):
        Clock(rate, 0.0, jitter=jitter)


@pytest.mark.parametrize("error", [-1.0, -2.0, float("nan")])
def test_a_rate_error_that_stops_the_clock_is_an_error(error):
    with pytest.raises(ValueError, match="rate must be above 0 Hz"):
        Clock.drawn(100.0, np.random.default_rng(7), error=error)
