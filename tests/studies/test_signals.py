"""The signals that detectors are judged on, against the distributions and equations they are written down with.

Statistical tests draw with fixed seeds; n and the error rate α stand beside each. At α = 0.001 the Kolmogorov–Smirnov
test of 2000 draws sees a distribution function that is 0.06 off with a probability above 0.9.
"""

from collections.abc import Callable
from dataclasses import replace
from math import asin, cos, pi, radians, sin

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.stats import chi2, chisquare, kstest, norm, poisson

from sensors.streams import Streams
from uavsim.studies import signals
from uavsim.studies.signals import (
    CATAPULT_TIME,
    CROSSING,
    G0,
    MEASURED_CATAPULT,
    SOFT_DROP,
    SOFT_DROPS,
    CentrifugeSettings,
    Launch,
    LaunchSettings,
    Mix,
    MixSettings,
    RunUpSettings,
    Shock,
    ShockSettings,
    Stroke,
    WalkSettings,
    band_noise,
    centrifuge,
    draw_launch,
    draw_shock,
    record_launches,
    run_up,
    sense,
    walk,
)

ALPHA = 0.001
QUIET = MixSettings(shock_rate=0.0, vibration_g=(0.0,), elevation_deg=(0.0, 0.0), sigma_g=0.0)


def draws(settings: LaunchSettings, n: int, seed: int = 1) -> list[Launch]:
    return [draw_launch(settings, Streams(seed, index)) for index in range(n)]


# --- launches: distributions


LAUNCHES = draws(LaunchSettings(), 2000)
RANGES: list[tuple[str, Callable[[Launch], float], float, float]] = [
    ("peak", lambda x: x.stroke.peak / G0, 5.0, 15.0),
    ("duration", lambda x: x.stroke.duration, 0.1, 0.4),
    ("rise", lambda x: x.stroke.rise, 0.010, 0.040),
    ("elevation", lambda x: np.degrees(x.elevation), 5.0, 35.0),
    ("wait", lambda x: x.onset, 0.5, 1.0),
]


@pytest.mark.parametrize(("name", "value", "low", "high"), RANGES, ids=[r[0] for r in RANGES])
def test_launches_have_the_distributions_of_the_issue(
    name: str, value: Callable[[Launch], float], low: float, high: float
) -> None:
    values = np.array([value(launch) for launch in LAUNCHES])
    assert low <= values.min() <= values.max() <= high, name
    assert kstest(values, "uniform", (low, high - low)).pvalue > ALPHA, name


def test_shapes_come_half_and_half() -> None:
    """n = 2000, α = 0.001: a share outside 0.463 … 0.537 is refused."""
    share = np.mean([launch.stroke.shape == "trapezoid" for launch in LAUNCHES])
    assert abs(share - 0.5) < norm.isf(ALPHA / 2) * 0.5 / np.sqrt(len(LAUNCHES))
    assert {launch.stroke.shape for launch in LAUNCHES} == {"half-sine", "trapezoid"}


def test_draws_do_not_lean_on_each_other() -> None:
    """n = 2000: every pair of quantities is uncorrelated at α = 0.001 over the ten pairs."""
    table = np.array([[value(launch) for launch in LAUNCHES] for _, value, _, _ in RANGES])
    pairs = np.corrcoef(table)[np.triu_indices(len(table), 1)]
    assert np.abs(pairs).max() < norm.isf(ALPHA / 20) / np.sqrt(len(LAUNCHES))


def test_a_fault_or_a_bump_leaves_the_other_draws_as_they_were() -> None:
    plain = draws(LaunchSettings(), 5)
    for change in ({"bump": True}, {"fault": "hang-fire"}, {"fault": "broken"}):
        for one, other in zip(plain, draws(replace(LaunchSettings(), **change), 5), strict=True):
            assert (one.onset, one.elevation) == (other.onset, other.elevation)
            assert (one.stroke.peak, one.stroke.duration) == (other.stroke.peak, other.stroke.duration)


# --- launches: curves and truth


@pytest.mark.parametrize("duration", [0.1, 0.25, 0.4])
def test_half_sine_is_the_formula(duration: float) -> None:
    stroke = Stroke("half-sine", 60.0, duration)
    t = np.linspace(0.0, duration, 101)
    np.testing.assert_allclose(stroke.force(t), 60.0 * np.sin(pi * t / duration), atol=1e-12)
    assert stroke.force(np.array([duration / 2])).item() == 60.0
    assert np.all(stroke.force(np.array([-1.0, -1e-9, duration + 1e-9, 9.0])) == 0.0)


def test_trapezoid_rises_holds_and_falls() -> None:
    t = np.array([-0.01, 0.0, 0.01, 0.02, 0.05, 0.08, 0.09, 0.1, 0.2])
    np.testing.assert_allclose(
        Stroke("trapezoid", 60.0, 0.1, 0.02).force(t), [0, 0, 30, 60, 60, 60, 30, 0, 0], atol=1e-12
    )


def test_catapult_is_the_measured_one() -> None:
    """66 m/s² to 0.18 s, 53 at 0.28 to 0.47, zero at 0.61; its speed and way, 30.6 m/s and 10.6 m."""
    stroke = Stroke("catapult", 66.0, CATAPULT_TIME, rise=0.03)
    knots = np.array([0.03, 0.18, 0.23, 0.28, 0.47, 0.54, 0.61])
    np.testing.assert_allclose(stroke.force(knots), [66.0, 66.0, 59.5, 53.0, 53.0, 26.5, 0.0], atol=1e-12)
    t = np.linspace(0.0, 0.61, 61_001)
    speed = cumulative_trapezoid(stroke.force(t), t, initial=0.0)
    assert speed[-1] == pytest.approx(30.6, abs=0.05)
    assert cumulative_trapezoid(speed, t)[-1] == pytest.approx(10.6, abs=0.05)
    for launch in draws(MEASURED_CATAPULT, 20):
        assert launch.stroke.peak == pytest.approx(66.0, rel=1e-12)
        assert launch.stroke.duration == CATAPULT_TIME
        assert 0.020 <= launch.stroke.rise <= 0.040


def test_a_catapult_of_another_peak_and_time_keeps_its_shape() -> None:
    t = np.linspace(0.0, 0.61, 200)
    long, short = Stroke("catapult", 66.0, 0.61, 0.03), Stroke("catapult", 132.0, 0.305, 0.03)
    np.testing.assert_allclose(short.force(t / 2), 2 * long.force(t), atol=1e-9)


@pytest.mark.parametrize("elevation_deg", [0.0, 5.0, 35.0])
@pytest.mark.parametrize("peak_g", [5.0, 8.0, 15.0])
def test_crossing_is_where_the_curve_says(peak_g: float, elevation_deg: float) -> None:
    """Closed forms: half-sine T/π asin(a/P), trapezoid rise·a/P, with a = 4.5 g - g sin θ. Tolerance 20 ns."""
    elevation = radians(elevation_deg)
    share = (CROSSING - G0 * sin(elevation)) / (peak_g * G0)
    for stroke, expected in (
        (Stroke("half-sine", peak_g * G0, 0.2), 0.2 / pi * asin(share)),
        (Stroke("trapezoid", peak_g * G0, 0.2, 0.03), 0.03 * share),
    ):
        truth = Launch(stroke, elevation, onset=0.7, length=2.0).truth()
        assert truth.crossing == pytest.approx(0.7 + expected, abs=2e-8)
        assert truth.peak == pytest.approx(peak_g * G0 + G0 * sin(elevation), rel=1e-12)
        assert (truth.onset, truth.end) == (0.7, pytest.approx(0.9))


def test_a_launch_that_stays_below_has_no_crossing() -> None:
    launch = Launch(Stroke("half-sine", 4.0 * G0, 0.2), radians(20), 0.5, 1.0)
    assert launch.truth().crossing is None
    assert launch.truth(crossing=4.0 * G0).crossing is not None


def test_truth_of_drawn_launches_agrees_with_a_fine_reading() -> None:
    for launch in [*LAUNCHES[:20], *draws(LaunchSettings(fault="hang-fire"), 20), *draws(MEASURED_CATAPULT, 5)]:
        t = np.arange(0.0, launch.length, 1e-5)
        force, truth = launch.axial(t), launch.truth()
        assert truth.crossing == pytest.approx(t[np.argmax(force > CROSSING)], abs=1.1e-5)
        assert truth.peak == pytest.approx(force.max(), rel=1e-6)
        moving = np.flatnonzero(force != force[0])
        assert t[moving[0]] == pytest.approx(truth.onset, abs=2e-5)
        assert t[moving[-1]] == pytest.approx(truth.end, abs=2e-5)


def test_gravity_is_on_the_rail() -> None:
    launch = Launch(Stroke("half-sine", 50.0, 0.1), radians(20), 0.5, 1.0)
    force = launch.force(np.array([0.0, 0.55, 0.99]))
    np.testing.assert_allclose(force[:, 0] - [0, 50, 0], G0 * sin(radians(20)), rtol=1e-12)
    assert np.all(force[:, 1] == 0.0)
    np.testing.assert_allclose(force[:, 2], -G0 * cos(radians(20)), rtol=1e-12)


def test_hang_fire_is_weak_and_then_the_stroke() -> None:
    for launch in draws(LaunchSettings(fault="hang-fire"), 50):
        stroke = launch.stroke
        assert 0.1 <= stroke.hang <= 0.5
        assert 0.1 <= stroke.weak <= 0.4
        waiting = stroke.force(np.linspace(signals.WEAK_RISE, stroke.hang, 50))
        np.testing.assert_allclose(waiting, stroke.weak * stroke.peak, rtol=1e-12)
        t = np.linspace(0.0, stroke.duration, 400)
        whole = replace(stroke, hang=0.0, weak=0.0).force(t)
        delayed = stroke.force(stroke.hang + t)
        assert np.all(delayed >= whole - 1e-9)
        np.testing.assert_allclose(delayed[200:], whole[200:], atol=1e-6)


def test_a_broken_stroke_is_without_force_in_its_gap() -> None:
    for launch in draws(LaunchSettings(fault="broken"), 50):
        stroke, ramp = launch.stroke, signals.BREAK_RAMP
        assert 0.1 <= stroke.break_at / stroke.duration <= 0.6
        assert 0.020 <= stroke.gap <= 0.060
        gone = stroke.break_at + ramp
        assert np.all(stroke.force(np.linspace(gone + 1e-9, gone + stroke.gap - 1e-9, 20)) == 0.0)
        outside = np.concatenate(
            [np.linspace(0.0, stroke.break_at, 20), np.linspace(gone + stroke.gap + ramp + 1e-9, 0.5, 20)]
        )
        np.testing.assert_array_equal(stroke.force(outside), replace(stroke, gap=0.0).force(outside))


def test_bumps_strike_in_the_last_0_4_seconds_and_leave_the_truth_alone() -> None:
    plain, bumped = draws(LaunchSettings(), 1000), draws(LaunchSettings(bump=True), 1000)
    for one, other in zip(plain, bumped, strict=True):
        assert one.bump is None
        assert other.bump is not None
        assert other.onset - 0.4 <= other.bump.start
        assert other.bump.start + other.bump.duration <= other.onset
        assert 20 <= abs(other.bump.peak) / G0 <= 50
    for one, other in zip(plain[:20], bumped[:20], strict=True):
        assert one.truth() == other.truth()
    before = [  # uniform between its own length and 0.4 s, n = 1000
        (x.onset - x.bump.start - x.bump.duration) / (0.4 - x.bump.duration) for x in bumped if x.bump is not None
    ]
    assert kstest(before, "uniform").pvalue > ALPHA


# --- launches: readings


def test_noise_has_its_sigma_and_is_white() -> None:
    """n = 300 000 normal samples, α = 0.001: a σ 0.5 % off is refused."""
    n = 300_000
    noise = sense(np.zeros(n), 0.3, 1e3, np.random.default_rng(3)) / G0
    low, high = chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], n)
    assert low < np.sum(noise**2) / 0.09 < high
    assert kstest(noise, "norm", (0.0, 0.3)).pvalue > ALPHA
    assert abs(np.corrcoef(noise[:-1], noise[1:])[0, 1]) < norm.isf(ALPHA / 2) / np.sqrt(n)


def test_readings_are_clipped_at_the_range() -> None:
    wide = record_launches(LaunchSettings(peak_g=(15.0, 15.0), bump=True, clip_g=1e4, sigma_g=1.0), 2, 20)
    for clip_g in (16.0, 4.0):
        narrow = record_launches(LaunchSettings(peak_g=(15.0, 15.0), bump=True, clip_g=clip_g, sigma_g=1.0), 2, 20)
        assert np.abs(narrow.f).max() == clip_g * G0
        np.testing.assert_array_equal(narrow.f, np.clip(wide.f, -clip_g * G0, clip_g * G0))


def test_a_trial_is_the_same_whichever_others_are_read() -> None:
    settings = LaunchSettings(bump=True, vibration_g=1.0)
    many, two = record_launches(settings, 5, 10), record_launches(settings, 5, 2, first=7)
    np.testing.assert_array_equal(many.f[7:9], two.f)
    assert many.launches[7:9] == two.launches
    assert many.truths[7:9] == two.truths
    assert not np.array_equal(record_launches(settings, 6, 1).f, many.f[:1])


@pytest.mark.parametrize("rate", [38.0, 50.0, 1000.0, 4000.0])
def test_any_rate_reads_the_same_launch(rate: float) -> None:
    settings = LaunchSettings(sigma_g=0.0, clip_g=1e3)
    read = record_launches(settings, 1, 3, rate)
    assert read.f.shape == (3, read.t.size, 3)
    assert settings.length - 1 / rate < read.t[-1] <= settings.length
    np.testing.assert_array_equal(read.t, np.arange(read.t.size) / rate)
    assert read.launches == tuple(LAUNCHES[:3])
    for row, launch in zip(read.f, read.launches, strict=True):
        np.testing.assert_array_equal(row, launch.force(read.t))
        assert launch.truth().end < settings.length


def test_vibration_is_added_to_a_launch() -> None:
    quiet, shaken = (record_launches(LaunchSettings(vibration_g=level, clip_g=1e3), 1, 20).f for level in (0.0, 2.0))
    assert np.std(shaken - quiet) / G0 == pytest.approx(2.0, rel=0.02)  # 20 x 3 x 780 amplitudes: σ is 0.3 %


# --- shocks


@pytest.mark.parametrize("settings", [ShockSettings(), SOFT_DROP], ids=["shock", "soft drop"])
def test_shocks_have_their_distributions(settings: ShockSettings) -> None:
    """n = 3000, α = 0.001 for each."""
    generator = np.random.default_rng(7)
    shocks = [draw_shock(settings, 0.0, generator) for _ in range(3000)]
    for values, (low, high) in (
        ([abs(x.peak) / G0 for x in shocks], settings.peak_g),
        ([x.duration for x in shocks], settings.duration),
        ([x.ring for x in shocks], settings.ring),
        ([x.ring_hz for x in shocks], settings.ring_hz),
        ([x.ring_decay for x in shocks], settings.ring_decay),
    ):
        assert kstest(values, "uniform", (low, high - low)).pvalue > ALPHA
    sides = np.bincount([2 * x.axis + (x.peak > 0) for x in shocks], minlength=6)
    assert chisquare(sides).pvalue > ALPHA


def test_the_issues_figures_are_the_defaults() -> None:
    assert (ShockSettings().peak_g, ShockSettings().duration) == ((20, 50), (0.002, 0.005))
    assert (SOFT_DROP.peak_g, SOFT_DROP.duration) == ((6, 12), (0.015, 0.025))
    mix = MixSettings()
    assert (mix.shock_rate, mix.vibration_g, mix.band_hz, mix.sigma_g, mix.clip_g) == (
        0.5,
        (0, 1, 2, 3),
        (5, 200),
        0.3,
        16,
    )
    assert SOFT_DROPS.shock_rate * 3600 == 1800


@pytest.mark.parametrize("peak", [400.0, -250.0])
def test_a_shock_is_a_half_sine_and_its_ring(peak: float) -> None:
    shock = Shock(1.0, 0, peak, 0.004, ring=0.4, ring_hz=125.0, ring_decay=0.01)
    t = np.array([0.9999, 1.0, 1.001, 1.002, 1.003, 1.004])
    expected = peak * np.array([0.0, 0.0, np.sqrt(0.5), 1.0, np.sqrt(0.5), 0.0])
    np.testing.assert_allclose(shock.force(t), expected, atol=1e-9)
    since = np.array([0.002, 0.006, 0.010])  # a quarter, three quarters, five quarters of the ring's 8 ms
    ring = -0.4 * peak * np.exp(-since / 0.01) * np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(shock.force(1.004 + since), ring, rtol=1e-9)
    assert shock.end == pytest.approx(1.104)
    assert np.all(shock.force(np.array([shock.end + 1e-9, 9.0])) == 0.0)
    assert np.abs(shock.force(np.linspace(1.1, 1.104, 99))).max() < 1e-4 * abs(peak)


# --- vibration


@pytest.mark.parametrize("rate", [1000.0, 4000.0])
def test_vibration_has_a_flat_spectrum_in_its_band_and_unit_rms(rate: float) -> None:
    """60 s of 5-200 Hz hold 11 701 lines, each exponential in power: their sum is χ² with twice as many degrees.

    α = 0.001 each: an rms 2.2 % off is refused, and a slope of the spectrum that makes its halves differ by 10 %.
    """
    n, lines = round(60 * rate), 11_701
    noise = band_noise(n, rate, (5.0, 200.0), np.random.default_rng(11)).astype(float)
    low, high = chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], 2 * lines) / (2 * lines)
    assert low < np.mean(noise**2) < high
    hz, power = np.fft.rfftfreq(n, 1 / rate), np.abs(np.fft.rfft(noise)) ** 2
    band = (hz > 5.0 - 1e-9) & (hz < 200.0 + 1e-9)
    assert np.sum(band) == lines
    assert power[~band].max() < 1e-9 * power[band].mean()
    assert kstest(power[band] / (n * n / 2 / lines), "expon").pvalue > ALPHA
    lower, upper = np.array_split(power[band], 2)
    assert np.mean(lower) / np.mean(upper) == pytest.approx(1.0, abs=norm.isf(ALPHA / 2) * 2 / np.sqrt(lines))
    assert kstest(noise[:: round(rate / 10)], "norm").pvalue > ALPHA  # every 0.1 s: 600 nearly independent ones


def test_a_rate_that_cannot_hold_the_band_is_refused() -> None:
    with pytest.raises(ValueError, match="400 Hz cannot hold"):
        Mix(MixSettings(), 1, rate=400.0)
    with pytest.raises(ValueError, match="does not fit"):
        record_launches(LaunchSettings(vibration_g=1.0), 1, 1, rate=100.0)
    assert Mix(SOFT_DROPS, 1, rate=50.0).read_spell(0).shape == (1500, 3)


# --- the mix


def test_shocks_come_as_a_poisson_process() -> None:
    """4000 spells, 60 000 shocks expected, α = 0.001 each: total (a rate 1.4 % off is refused), dispersion, times."""
    mix = Mix(MixSettings(), 3)
    spells = [mix.shocks(k) for k in range(4000)]
    counts = np.array([len(shocks) for shocks in spells])
    assert poisson.ppf(ALPHA / 2, 60_000) < counts.sum() < poisson.ppf(1 - ALPHA / 2, 60_000)
    low, high = chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], counts.size - 1)
    assert low < np.sum((counts - counts.mean()) ** 2) / counts.mean() < high
    starts = np.array([shock.start for shocks in spells for shock in shocks])
    assert np.all(np.diff(starts) >= 0.0)
    assert kstest(np.diff(starts), "expon", (0.0, 2.0)).pvalue > ALPHA


def test_levels_are_equally_probable() -> None:
    mix = Mix(MixSettings(), 3)
    levels, counts = np.unique([mix.level(k) for k in range(2000)], return_counts=True)
    assert levels.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert chisquare(counts).pvalue > ALPHA


@pytest.mark.parametrize("level", [1.0, 3.0])
def test_a_spells_vibration_has_its_rms_on_each_axis(level: float) -> None:
    mix = Mix(replace(QUIET, vibration_g=(level,), clip_g=1e3), 4)
    spell = mix.read_spell(2).astype(float)
    inner = spell[50:-50] + np.array([0.0, 0.0, G0])  # away from the fades
    assert np.sqrt(np.mean(inner**2, axis=0)) / G0 == pytest.approx(np.full(3, level), rel=0.03)  # σ 0.65 %
    assert np.abs(np.corrcoef(inner.T)[np.triu_indices(3, 1)]).max() < 0.05
    assert np.abs(spell[[0, -1], :2]).max() < 1e-3  # nothing at the seam


@pytest.mark.parametrize("size", [1, 997, 30_000, 70_000])
def test_blocks_are_the_same_however_they_are_read(size: int) -> None:
    samples, start = (70_000, 0) if size > 1 else (200, 29_900)
    mix = Mix(MixSettings(), 9, index=2)
    whole = next(mix.blocks(90_000, 90_000))
    blocks = list(mix.blocks(size, samples, start))
    assert [len(block) for block in blocks[:-1]] == [size] * (len(blocks) - 1)
    assert np.concatenate(blocks).tobytes() == whole[start : start + samples].copy().tobytes()


def test_an_axis_is_the_same_alone() -> None:
    whole = next(Mix(MixSettings(), 9).blocks(60_000, 60_000))
    for axes in ((0,), (2,), (2, 0)):
        part = next(Mix(MixSettings(), 9, axes=axes).blocks(60_000, 60_000))
        np.testing.assert_array_equal(part, whole[:, list(axes)])
        assert part.dtype == np.float32
        assert part[:, 0].flags.c_contiguous


def test_seed_and_index_each_make_another_stream() -> None:
    first, again, *others = (next(Mix(MixSettings(), *key).blocks(500, 500)) for key in ((1,), (1, 0), (2, 0), (1, 1)))
    np.testing.assert_array_equal(first, again)
    assert all(abs(np.corrcoef(first[:, 1], other[:, 1])[0, 1]) < 0.2 for other in others)


def test_shocks_fall_where_they_were_drawn_and_ring_over_the_seam() -> None:
    """Nothing but shocks, and long rings: the stream is the sum of what was drawn, to float32."""
    ringing = ShockSettings(ring_decay=(0.3, 0.5))
    mix = Mix(replace(QUIET, shock=ringing, shock_rate=2.0, clip_g=1e3), 5)
    read = next(mix.blocks(90_000, 90_000)) + np.array([0.0, 0.0, G0], np.float32)
    t, expected = np.arange(90_000) / 1000.0, np.zeros((90_000, 3))
    shocks = [shock for k in range(3) for shock in mix.shocks(k)]
    for shock in shocks:
        expected[:, shock.axis] += shock.force(t)
    assert any(shock.start < seam < shock.end for shock in shocks for seam in (30.0, 60.0))
    np.testing.assert_allclose(read, expected, atol=1e-3)


def test_the_mix_is_clipped_and_shocks_reach_the_clip() -> None:
    read = next(Mix(MixSettings(), 6).blocks(300_000, 300_000))
    limit = np.float32(16.0 * G0)
    assert np.array_equal([read.min(), read.max()], [-limit, limit])


def test_rest_and_noise_of_the_mix() -> None:
    """60 spells of noise alone: σ within its χ² interval (n = 1.8e6, α = 0.001), elevation of each within 5-35°."""
    mix = Mix(replace(QUIET, elevation_deg=(5.0, 35.0), sigma_g=0.3), 8)
    spells = np.array([mix.read_spell(k) for k in range(60)], float) / G0
    mean = spells.mean(axis=1)
    np.testing.assert_allclose(np.hypot(mean[:, 0], mean[:, 2]), 1.0, atol=0.01)
    elevation = np.degrees(np.arctan2(mean[:, 0], -mean[:, 2]))
    assert kstest(elevation, "uniform", (5.0, 30.0)).pvalue > ALPHA
    n = spells[:, :, 1].size
    low, high = chi2.ppf([ALPHA / 2, 1 - ALPHA / 2], n)
    assert low < np.sum(spells[:, :, 1] ** 2) / 0.09 < high


# --- centrifuge, run-up, walking


def test_centrifuge_holds_its_level_and_rises_with_the_square_of_speed() -> None:
    force = centrifuge(CentrifugeSettings(level_g=4.1, hold=60.0, ramp=5.0), rate=100.0)
    assert force.shape == (7001, 3)
    assert np.sum(force[:, 0] == 4.1 * G0) == 6001
    np.testing.assert_allclose(force[[0, 250, 400, 6750, 7000], 0] / (4.1 * G0), [0, 0.25, 0.64, 0.25, 0], atol=1e-12)
    assert np.all(force[:, 1:] == [0.0, -G0])


def test_run_up_shakes_with_the_orders_of_its_speed() -> None:
    settings = RunUpSettings(elevation_deg=(20.0, 20.0), shake_g=(1.5, 1.5))
    force = run_up(settings, Streams(1))
    full = force[12_000:20_000] - [G0 * sin(radians(20)), 0.0, -G0 * cos(radians(20))]
    assert np.abs(full.mean(axis=0)).max() < 0.01 * G0  # thrust is not felt
    amplitude = 2 * np.abs(np.fft.rfft(full[:, 0])) / len(full) / G0
    hz = np.fft.rfftfreq(len(full), 1e-3)
    assert hz[np.argsort(amplitude)[-2:]].tolist() == [240.0, 120.0]
    np.testing.assert_allclose(np.sort(amplitude)[-2:], [0.75, 1.5], rtol=1e-3)
    idle = np.std(force[:2000, 0]) / np.std(full[:, 0])
    assert idle == pytest.approx((30 / 120) ** 2, rel=0.02)


def test_walking_reaches_what_was_recorded_and_not_much_more() -> None:
    """Recorded in 248 s: 2.7 m/s² forward, 4.5 m/s² in all (kinematic). 40 walks of a minute, within 15 %."""
    walks = np.array([walk(WalkSettings(sway_deg=(0.0, 0.0)), Streams(1, i), 100.0) for i in range(40)])
    kinematic = walks + np.array([0.0, 0.0, G0])
    assert np.abs(kinematic[:, :, 0]).max() == pytest.approx(2.7, rel=0.15)
    assert np.linalg.norm(kinematic, axis=2).max() == pytest.approx(4.5, rel=0.15)
    np.testing.assert_array_equal(walk(WalkSettings(), Streams(3), 100.0), walk(WalkSettings(), Streams(3), 100.0))


# --- what is refused


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: LaunchSettings(peak_g=(9.0, 5.0)), "peak_g must be two numbers"),
        (lambda: LaunchSettings(wait=(0.1, 1.0), bump=True), "wait must be"),
        (lambda: LaunchSettings(shapes=()), "shapes"),
        (lambda: LaunchSettings(rise=(0.01, 0.06)), "trapezoid of 0.1 s cannot rise"),
        (lambda: Stroke("trapezoid", 50.0, 0.1, 0.06), "cannot rise in 0.06 s"),
        (lambda: Stroke("catapult", 50.0, 0.3, 0.2), "catapult of 0.3 s"),
        (lambda: Stroke("half-sine", 50.0, 0.3, hang=0.1, weak=0.7), "weak"),
        (lambda: ShockSettings(ring_decay=(0.01, 5.0)), "ring_decay must be"),
        (lambda: MixSettings(vibration_g=()), "at least one level"),
        (lambda: MixSettings(vibration_g=(-1.0,)), "negative"),
        (lambda: Mix(MixSettings(), -1), "seed and index"),
        (lambda: Mix(MixSettings(), 1, axes=()), "axes"),
        (lambda: Mix(MixSettings(), 1, axes=(3,)), "axes"),
        (lambda: next(Mix(MixSettings(), 1).blocks(0, 5)), "size"),
    ],
)
def test_what_makes_no_sense_is_refused(build: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        build()
