"""The clipped sum whose limit follows the roughness: its equations read naively, and what it does with odd samples."""

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uavsim.onboard.launch import AdaptiveCusum, AdaptiveCusumSettings, Cusum, DetectorSettings, build

NAN = math.nan
G = 9.80665  # m/s², ISO 80000-3


def recognised(detector, force, rate=1000.0, start=0):
    """Indices at which `step` is True for samples along x."""
    return [k for k, f in enumerate(force) if detector.step((start + k) / rate, f, 0.0, -9.8)]


def noisy(level, sigma, n, seed=1):
    draw = random.Random(seed)
    return [G * (level + sigma * draw.gauss(0.0, 1.0)) for _ in range(n)]


def after(sigma, force, rest=1000):
    """Where a launch is recognised that follows a second of rest with noise; counted from its first sample."""
    detector = AdaptiveCusum(1000.0)
    assert recognised(detector, noisy(0.3, sigma, rest)) == []
    return recognised(detector, force, start=rest)


def read_naively(force, rate=1000.0):
    """The module's equations in numbers of g and ms; the first sample that is recognised."""
    total, mean, rough, dt = 0.0, 0.0, 16.0 / 15.0, 1000.0 / rate
    most = 2.0 * 16.0 / 15.0
    for k, f in enumerate(force):
        away = max(-most, min(most, f / G - mean))
        mean += min(1.0, dt / 2.0) * away
        rough += (abs(away) - rough) * dt / 200.0
        total = max(0.0, total + max(-1.5, min(1.0, f / G - 4.5)) * dt)
        if total > max(9.0, min(16.0, dt), min(16.0, 15.0 * rough)) * (1.0 + 1e-6):
            return [k]
    return []


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32), st.floats(0.0, 1.5), st.floats(3.5, 9.0), st.sampled_from([100.0, 1000.0, 3200.0]))
def test_the_equations_read_naively(seed, sigma, level, rate):
    force = noisy(0.3, sigma, 300, seed) + noisy(level, sigma, 300, seed + 1)
    assert recognised(AdaptiveCusum(rate), force, rate) == read_naively(force, rate)


def test_a_smooth_force_needs_9_g_ms_and_a_rough_one_up_to_16():
    """6 g is more than 1 g above the reference; hand-computed: nine samples reach 9 g·ms, the tenth passes."""
    assert after(0.0, [6.0 * G] * 40) == [9]
    assert 12 <= after(1.0, [6.0 * G] * 40)[0] <= 15
    assert 15 <= after(3.0, [6.0 * G] * 40)[0] <= 16


def test_it_begins_rough():
    """Nothing is known of the noise before the first samples: the limit is near the highest, sixteen samples."""
    assert 14 <= recognised(AdaptiveCusum(1000.0), [6.0 * G] * 40)[0] <= 16


def test_the_limit_is_between_its_bounds():
    detector = AdaptiveCusum(1000.0)
    assert detector.limit == pytest.approx(0.016 * G, rel=1e-5)
    recognised(detector, noisy(0.3, 0.1, 1000))
    assert detector.limit == pytest.approx(0.009 * G, rel=1e-5)
    recognised(detector, noisy(0.3, 0.9, 1000), start=1000)
    assert 0.010 * G < detector.limit < 0.015 * G
    recognised(detector, noisy(0.3, 5.0, 1000), start=2000)
    assert detector.limit == pytest.approx(0.016 * G, rel=1e-5)


def test_in_smooth_air_a_launch_is_seen_sooner_than_by_the_fixed_sum():
    weak = [5.3 * G] * 60
    assert after(0.2, weak)[0] < recognised(Cusum(1000.0), weak)[0] - 4


def test_shocks_are_no_launches():
    """One shock of 5 ms adds 5 g·ms; two that touch 10 g·ms, but they are rough."""
    assert after(0.1, [50.0 * G] * 5 + [0.0] * 100) == []
    assert after(0.1, [50.0 * G] * 5 + [-25.0 * G] * 2 + [50.0 * G] * 5 + [0.0] * 100) == []
    assert after(0.1, [50.0 * G] * 9 + [0.0] * 100) == []


def test_a_bump_leaves_no_trace_after_half_a_second():
    bump = [50.0 * G] * 5 + [-20.0 * G] * 3 + [0.3 * G] * 500
    assert after(0.0, bump + [6.0 * G] * 40) == [len(bump) + 9]


def test_unknown_forces_take_off_and_make_rough_but_leave_the_mean():
    detector = AdaptiveCusum(1000.0)
    recognised(detector, [0.3 * G] * 2000)
    recognised(detector, [6.0 * G] * 5, start=2000)
    held, rough = detector.sum, detector.roughness
    detector.step(2.005, NAN, 0.0, 0.0)
    assert detector.sum == pytest.approx(held - 1.5e-3 * G)
    assert detector.roughness > rough
    recognised(detector, [NAN] * 3000, start=2006)
    assert detector.limit == pytest.approx(0.016 * G, rel=1e-5)
    assert recognised(detector, [0.3 * G] * 2000 + [6.0 * G] * 40, start=5006) == [2009]


@pytest.mark.parametrize("odd", [math.inf, -math.inf, 1e300, -1e300])
def test_no_force_spoils_it_for_good(odd):
    detector = AdaptiveCusum(1000.0)
    recognised(detector, [0.3 * G] * 100 + [odd] * 8)
    assert recognised(detector, [0.3 * G] * 2000 + [6.0 * G] * 40, start=200) == [2009]


def test_a_gap_counts_three_periods_and_keeps_the_sum():
    detector = AdaptiveCusum(1000.0)
    recognised(detector, [0.3 * G] * 2000 + [6.0 * G] * 4)
    held = detector.sum
    detector.step(3.0, 6.0 * G, 0.0, 0.0)
    assert detector.sum == pytest.approx(held + 3e-3 * G)


@pytest.mark.parametrize("rate", [10.0, 38.0, 50.0, 62.0, 104.0, 111.0])
def test_one_sample_alone_never_decides_unless_it_is_let(rate):
    """However strong it is, and whatever came before; two in a row do."""
    rest = [0.3 * G] * round(2.0 * rate)
    for confirm in (True, False):
        settings = DetectorSettings(adaptive=AdaptiveCusumSettings(confirm=confirm))
        alone = recognised(build(settings, rate), rest + [50.0 * G, 0.3 * G] * 20 + rest, rate)
        assert bool(alone) is not confirm
        assert recognised(build(settings, rate), [*rest, 50.0 * G, 50.0 * G], rate) == [len(rest) + confirm]


@pytest.mark.parametrize("rate", [38.0, 50.0, 104.0, 833.0, 4000.0])
def test_it_keeps_time_at_every_rate(rate):
    """A step to 6 g after two seconds of rest: 9 g·ms, or what two samples add up to 10, or one; and one more."""
    rest = round(2.0 * rate)
    detector = build(DetectorSettings(), rate)
    (found,) = recognised(detector, [0.3 * G] * rest + [6.0 * G] * rest, rate)
    assert (
        0.009
        <= (found + 1 - rest) / rate
        <= max(0.009, 1.0 / rate, min(2.0 / rate, 0.010)) + 1.01 / rate + (0.001 if rate > 1000.0 else 0.0)
    )


@pytest.mark.parametrize("rate", [63.0, 80.0, 100.0, 110.0, 400.0, 1000.0])
def test_one_sample_is_no_launch(rate):
    """However strong it is; below 62 Hz a launch may show no more than one."""
    rest = [0.3 * G] * round(2 * rate)
    assert recognised(AdaptiveCusum(rate), [*rest, 50.0 * G, *rest], rate) == []


@pytest.mark.parametrize("rate", [1000.0, 2000.0, 4000.0])
def test_roughness_of_white_noise(rate):
    """d has the variance σ² (1 + w/(2 - w)), w = min(1, dt/τ_m); the mean of a normal |d| that is clipped is known.

    Within 3 %: 100 s hold 500 memories of the roughness, and the clip bends the short mean a little.
    """
    detector, seen = AdaptiveCusum(rate), []
    n = int(100 * rate)
    for k, f in enumerate(noisy(0.0, 1.0, n)):
        detector.step(k / rate, f, 0.0, 0.0)
        seen.append(detector.roughness / G)
    weight, most = min(1.0, 1.0 / rate / 0.002), 2.0 * 16.0 / 15.0
    sd = math.sqrt(1.0 + weight / (2.0 - weight))
    below = sd * math.sqrt(2.0 / math.pi) * (1.0 - math.exp(-((most / sd) ** 2) / 2.0))
    expected = below + most * math.erfc(most / sd / math.sqrt(2.0))
    assert sum(seen[n // 50 :]) / (n - n // 50) == pytest.approx(expected, rel=0.03)


def test_the_reference_follows_the_threshold_unless_it_is_set():
    assert build(DetectorSettings(), 1000.0)._reference == pytest.approx(4.5 * G, abs=0.01)
    assert build(DetectorSettings(threshold=30.0), 1000.0)._reference == pytest.approx(30.0 - 0.1 * G)
    own = DetectorSettings(threshold=30.0, adaptive=AdaptiveCusumSettings(reference=25.0))
    assert build(own, 1000.0)._reference == 25.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"reference": NAN},
        {"rise": 0.0},
        {"fall": math.inf},
        {"limit": -1.0},
        {"highest": 0.05},
        {"highest": math.inf},
        {"gain": 0.0},
        {"mean": 0.0},
        {"memory": NAN},
        {"axis": "x"},
    ],
)
def test_settings_out_of_bounds_are_refused(wrong):
    with pytest.raises(ValueError, match="must"):
        AdaptiveCusum(1000.0, **wrong)
    with pytest.raises(ValueError, match="rate"):
        AdaptiveCusum(0.0)
