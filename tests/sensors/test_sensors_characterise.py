"""The statistics of a record against published figures, closed forms and processes that are known.

Statistical tests have fixed seeds, so they pass or fail for good; what is said of them is how often an equally good
program would fail with other seeds (α), and how wrong it must be to fail nearly always.
"""

from itertools import islice
from math import exp, inf, log, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter
from scipy.stats import binom

from sensors import allan, noise
from sensors.accelerometer_description import AccelerometerErrors
from sensors.bench import blocks, columns_of, on_bench
from sensors.catalogue import presets
from sensors.characterise import Pyramid, _allan, allan_deviation, characterise
from sensors.noise_fit import fit_noise
from sensors.pressure_description import PressureDescription, PressureErrors
from sensors.promise import promised, promises

G0 = 9.80665
NINE = (892, 809, 823, 798, 671, 644, 883, 903, 677)  # NIST SP 1065, table 30


def thousand():
    """Return the 1000 points of NIST SP 1065, section 12.4: n_0 = 1234567890, n = 16807 n mod 2147483647."""
    n = [1234567890]
    while len(n) < 1000:
        n.append(16807 * n[-1] % 2147483647)
    return np.array(n) / 2147483647


# -- published figures -----------------------------------------------------------------------------------------------


def test_nine_points_of_nist_sp_1065():
    assert allan_deviation(NINE, 1.0, [1, 2]).deviation == pytest.approx([91.22945, 85.95287], rel=1e-6)


def test_thousand_points_of_nist_sp_1065():
    """Through the function, and through the very path of a record."""
    published = pytest.approx([2.922319e-1, 9.159953e-2, 3.241343e-2], rel=1e-6)
    assert allan_deviation(thousand(), 1.0, [1, 10, 100]).deviation == published
    (found,) = characterise([np.column_stack((np.arange(1000.0), thousand()))], ["x"])
    at = [int(np.flatnonzero(found.allan.tau == tau)[0]) for tau in (1.0, 10.0, 100.0)]
    assert found.allan.deviation[at] == published


def test_rate_scales_the_averaging_times_only():
    one, fast = (allan_deviation(thousand(), rate, [1, 10]) for rate in (1.0, 50.0))
    assert fast.tau == pytest.approx(one.tau / 50.0)
    assert fast.deviation == pytest.approx(one.deviation)


# -- closed forms ----------------------------------------------------------------------------------------------------

X = np.geomspace(1e-6, 1e5, 2_000_001)  # π f τ

PROCESSES = {
    "white": (allan.white, allan.density_white),
    "flicker": (allan.flicker, allan.density_flicker),
    "random walk": (allan.random_walk, allan.density_random_walk),
    "gauss-markov": (
        lambda tau: allan.gauss_markov(tau, 3.0),
        lambda f: allan.density_gauss_markov(f, 3.0),
    ),
}


@pytest.mark.parametrize("name", PROCESSES)
@pytest.mark.parametrize("tau", [0.01, 0.7, 20.0, 3000.0])
def test_variance_is_the_density_through_the_allan_window(name, tau):
    """IEEE Std 952, eq. C.1: σ² = ∫ S(f) 2 sin⁴(πfτ)/(πfτ)² df over one-sided S, to 1e-3 by Simpson's rule."""
    variance, density = PROCESSES[name]
    f = X / (pi * tau)
    integral = simpson(density(f) * 2.0 * np.sin(X) ** 4 / X**2 * f, x=np.log(f))
    assert float(variance(tau)) == pytest.approx(integral, rel=1e-3)


def test_gauss_markov_has_its_peak_where_it_is_said_and_no_step_where_the_series_ends():
    peak = minimize_scalar(lambda x: -float(allan.gauss_markov(x, 1.0)), bounds=(1.0, 3.0), method="bounded")
    assert peak.x == pytest.approx(1.8926, abs=1e-3)
    assert sqrt(-peak.fun) == pytest.approx(0.61736, abs=1e-5)
    assert sqrt(-peak.fun) == pytest.approx(allan.INSTABILITY * sqrt(2.0 * log(2.0) / pi), rel=1e-6)
    edge = allan.SHORT
    below, above = allan.gauss_markov([edge * (1 - 1e-9), edge], 1.0)
    assert below == pytest.approx(above, rel=1e-7)
    assert float(allan.gauss_markov(1e-9, 1.0)) == pytest.approx(2e-9 / 3.0, rel=1e-6)


def test_sampled_walk_has_the_factor_that_sampling_gives():
    """Second differences of sums of K √τ_0 ξ: σ²(m τ_0) = K² τ_0 (2m² + 1)/(6m), counted out for m = 1 to 4."""
    for m in (1, 2, 3, 4):
        inner = np.concatenate((np.arange(1, m + 1), np.arange(m - 1, 0, -1))) / m  # weights of steps in ȳ_2 - ȳ_1
        counted = 0.5 * float(inner @ inner)
        assert float(allan.random_walk(m) * allan.sampled(m, 1.0)) == pytest.approx(counted, rel=1e-12)


@pytest.mark.parametrize("pole", [0.05, 0.7, 0.99])
def test_one_pole_in_closed_form_is_the_sum_over_its_covariance(pole):
    tau = np.array([1, 2, 5, 40, 1000])
    covariance = allan.autocovariance((1.0 - pole) * pole ** np.arange(5000.0))
    assert allan.one_pole(tau, 1.0, pole) == pytest.approx(allan.correlated(tau, 1.0, covariance), rel=1e-8)
    assert allan.one_pole(tau, 1.0, 0.0) == pytest.approx(1.0)
    f = np.array([1e-4, 0.1, 0.5])
    assert allan.gain_one_pole(f, 1.0, pole) == pytest.approx(allan.shape(f, 1.0, covariance), rel=1e-8)


@pytest.mark.parametrize(("poles", "bandwidth"), [(1, 20.0), (2, 20.0), (2, 180.0)])
def test_low_pass_is_3_db_down_and_passes_what_scipy_says(poles, bandwidth):
    """Rate 500 Hz. The Allan variance behind it against 2^21 filtered draws, within 5 sd of what χ² has."""
    response = allan.low_pass(bandwidth, 500.0, poles)
    assert response.sum() == pytest.approx(1.0)
    covariance = allan.autocovariance(response)
    assert float(allan.shape(bandwidth, 1 / 500.0, covariance)) == pytest.approx(0.5, abs=1e-9)
    f, tau = np.array([1.0, 30.0, 210.0]), np.array([1, 2, 7.5, 40, 3000]) / 500.0
    closed = allan.gain_low_pass(f, 1 / 500.0, bandwidth / 500.0, poles)
    assert closed == pytest.approx(allan.shape(f, 1 / 500.0, covariance), rel=1e-6, abs=1e-12)
    whole = tau * 500.0 == np.round(tau * 500.0)
    closed = allan.low_passed(tau, 1 / 500.0, bandwidth / 500.0, poles)
    assert closed[whole] == pytest.approx(allan.correlated(tau, 1 / 500.0, covariance)[whole], rel=1e-8)
    white = np.random.default_rng(3).normal(size=2**21)
    behind = lfilter(response, [1.0], white)[len(response) :]
    found = allan_deviation(behind, 500.0, [1, 2, 5, 20, 100])
    expected = allan.correlated(found.tau, 1 / 500.0, covariance) / (found.tau * 500.0)
    correlated = 500.0 / (2.0 * bandwidth)  # so many readings say as much as one
    sd = np.sqrt(2.0 / found.edf * max(correlated, 1.0))
    assert np.all(np.abs(found.deviation**2 / expected - 1.0) < 5.0 * sd)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("pole", [0.3, 0.9, 0.99])
def test_rounding_error_of_correlated_noise(ratio, pole):
    """R_k of 2^21 rounded draws behind one pole, k = 0 to 20: within 0.02 of the variance; 1/12 at k = 0 to 1 %.

    The estimates scatter by up to 0.3 % for a pole of 0.99, and what is left out at a ratio of 1/2 is 0.7 %.
    """
    rng, sd = np.random.default_rng(16), ratio * sqrt(1.0 - pole**2)
    noise_only = lfilter([sd], [1.0, -pole], rng.normal(size=2**21)) + 0.3
    error = np.round(noise_only) - noise_only
    error -= error.mean()
    found = np.array([np.mean(error[: error.size - k] * error[k:]) for k in range(21)])
    expected = allan.rounding(pole ** np.arange(21.0), ratio)
    assert 12.0 * found == pytest.approx(12.0 * expected, abs=0.02)
    assert 12.0 * found[0] == pytest.approx(1.0, abs=0.02)


# -- the path of long records ----------------------------------------------------------------------------------------


def test_pyramid_holds_means_of_every_grain_whatever_the_blocks():
    values = np.random.default_rng(4).normal(size=(10_007, 2)) + 1e5
    for cuts in ([], [1, 2, 3, 5000], list(range(97, 10_007, 97))):
        pyramid = Pyramid(2)
        for block in np.split(values, cuts):
            pyramid.add(block)
        assert pyramid.count == 10_007
        assert pyramid.mean == pytest.approx(values.mean(axis=0), rel=1e-14)
        for k, level in enumerate(pyramid.levels()):
            whole = 10_007 // 4**k
            means = values[: whole * 4**k].reshape(whole, 4**k, 2).mean(axis=1) - values[0]
            assert level == pytest.approx(means, abs=1e-9)


def test_pyramid_is_bounded():
    pyramid = Pyramid(1, rows=100)
    for _ in range(64):
        pyramid.add(np.ones((64, 1)))
    assert pyramid.count == 4096
    assert [len(level) for level in pyramid.levels()] == [100, 100, 100, 64, 16, 4, 1]


def test_long_records_have_the_allan_deviation_of_all_their_readings():
    """Averaged over 4^k and overlapped 16 times a τ, instead of at each reading: within a tenth of the interval."""
    values = np.cumsum(np.random.default_rng(5).normal(size=400_000)) * 0.01 + np.random.default_rng(6).normal(
        size=400_000
    )
    (found,) = characterise([np.column_stack((np.arange(values.size) * 0.01, values))], ["x"])
    assert found.allan.tau[-1] * 100.0 > 80_000
    direct = allan_deviation(values, 100.0, [round(tau * 100.0) for tau in found.allan.tau])
    assert found.allan.tau == pytest.approx(direct.tau)
    assert np.all(np.abs(found.allan.deviation - direct.deviation) < 0.1 * (direct.high - direct.low) / 2.0)
    assert found.allan.edf == pytest.approx(direct.edf, rel=0.08)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """68.3 % intervals of white noise at 4 averaging times in 300 records of 4000: α = 1e-4, 60 or 77 % would fail."""
    held = np.zeros(4)
    for seed in range(300):
        found = allan_deviation(np.random.default_rng(seed).normal(size=4000), 1.0, [1, 10, 100, 1000])
        truth = 1.0 / np.sqrt(found.tau)
        held += (found.low < truth) & (truth < found.high)
    low, high = binom.interval(1.0 - 1e-4 / 4, 300, 0.683)
    assert np.all((held >= low) & (held <= high)), held


@pytest.mark.parametrize("interval", [1.0, 2.5e-3])
def test_density_of_white_noise_and_of_a_random_walk(interval):
    """2^18 readings, several grains: 2 % over all, 25 % in each band: those of few lines scatter by 5 %, α = 1e-5."""
    rng, count = np.random.default_rng(7), 2**18
    t = np.arange(count) * interval
    walk = np.cumsum(rng.normal(size=count)) * 3.0 * sqrt(interval)
    white, drift = characterise([np.column_stack((t, rng.normal(size=count), walk))], ["white", "walk"])
    f, density = white.spectrum.frequency, white.spectrum.density
    assert np.mean(density**2) == pytest.approx(2.0 * interval, rel=0.02)
    assert density[f > 0.002 / interval] == pytest.approx(sqrt(2.0 * interval), rel=0.25)
    f, density = drift.spectrum.frequency, drift.spectrum.density
    inside = (f > 0.002 / interval) & (f < 0.02 / interval)  # above, sampling folds it
    assert density[inside] == pytest.approx(np.sqrt(9.0 * allan.density_random_walk(f[inside])), rel=0.25)


def test_histogram_is_of_the_noise_and_on_the_readings_grid():
    """Steps of 0.5 under noise of 1 (with rounding √(1 + 1/48)) and a slow swing of 20."""
    t = np.arange(200_000) * 0.01
    values = np.random.default_rng(8).normal(size=t.size) + 20.0 * np.sin(2.0 * pi * t / 1000.0)
    (found,) = characterise([np.column_stack((t, 0.5 * np.round(2.0 * values) + 1e5))], ["x"])
    h = found.histogram
    assert h.resolution == pytest.approx(0.5)
    assert h.sd == pytest.approx(sqrt(1.0 + 0.5**2 / 12.0), rel=0.02)
    assert np.diff(h.edges) == pytest.approx(0.5)
    assert np.sum(h.density * np.diff(h.edges)) == pytest.approx(1.0, abs=1e-3)
    middle = h.density[np.abs(h.edges[:-1] + 0.25) < 1e-9]
    assert middle == pytest.approx(1.0 / sqrt(2.0 * pi * (1 + 1 / 48)), rel=0.02)


def test_readings_on_no_grid_have_no_step():
    values = np.random.default_rng(9).normal(size=5000)
    (found,) = characterise([np.column_stack((np.arange(5000.0), values))], ["x"])
    assert found.histogram.resolution is None
    assert found.histogram.sd == pytest.approx(1.0, rel=0.05)


def test_a_record_that_does_not_move_has_no_fit():
    (found,) = characterise([np.column_stack((np.arange(1000.0), np.full(1000, 1e5)))], ["x"])
    assert found.fit is None
    assert (found.mean, found.count, found.duration) == (1e5, 1000, 999.0)
    assert np.all(found.allan.deviation == 0.0)


def test_too_few_readings_are_refused():
    with pytest.raises(ValueError, match="63 readings are too few: at least 64"):
        characterise([np.zeros((63, 2)) + np.arange(63.0)[:, None]], ["x"])
    with pytest.raises(ValueError, match="0 readings"):
        characterise([], ["x"])


# -- N, B, K and Q ---------------------------------------------------------------------------------------------------

TAU = np.geomspace(0.01, 2000.0, 54)


def flicker_kept(tau, interval, pole):
    """Return the share of flicker noise's Allan variance that passes a one-pole filter, by Simpson's rule."""
    x = X[::50]
    f = x / (pi * tau)
    inside = f < 0.5 / interval
    window = (np.sin(x) ** 4 / x**2)[inside]
    passed, whole = (
        simpson(window * gain, x=np.log(f[inside])) for gain in (allan.gain_one_pole(f[inside], interval, pole), 1.0)
    )
    return passed / whole


@pytest.mark.parametrize(
    ("N", "B", "K", "Q", "time", "pole"),
    [
        (1.0, 0.0, 0.0, 0.0, None, 0.0),
        (1.0, 0.5, 0.02, 0.0, None, 0.0),
        (1.0, 0.9, 0.01, 0.0, 60.0, 0.0),
        (0.3, 0.5, 0.03, 0.0, None, 0.9),
        (0.3, 0.5, 0.01, 0.0, 40.0, 0.7),
        (0.2, 0.3, 0.02, 0.5, None, 0.0),
    ],
)
def test_a_fit_finds_what_an_exact_curve_was_made_of(N, B, K, Q, time, pole):
    """No statistics: the points are on the curve. 3 % in each term, 10 % in what shapes it."""
    if time is not None:
        drift = allan.drift_behind(TAU, time, 0.01, pole) / allan.INSTABILITY**2
    else:
        drift = np.array([allan.FLICKER_FLAT**2 * flicker_kept(tau, 0.01, pole) for tau in TAU])
    walk = 0.5e9 * allan.drift_behind(TAU, 1e9, 0.01, pole)
    variance = 3 * Q**2 / TAU**2 + N**2 * allan.one_pole(TAU, 0.01, pole) / TAU + B**2 * drift + K**2 * walk
    edf = np.maximum(1e7 / TAU * 0.01, 1e4)
    fit = fit_noise(TAU, np.sqrt(variance), edf, 100.0)
    assert fit is not None
    for coefficient, true in ((fit.N, N), (fit.B, B), (fit.K, K), (fit.Q, Q)):
        assert coefficient.value == pytest.approx(true, rel=0.03, abs=0.02 * max(N, B) if true == 0.0 else None)
        assert coefficient.resolved is (true > 0.0)
        assert 0.99 * coefficient.low <= true <= 1.01 * coefficient.high
    assert (fit.correlation_time is None) is (time is None)
    if time is not None:
        assert fit.correlation_time == pytest.approx(time, rel=0.1)
    expected = inf if pole == 0.0 else 100.0 * np.arccos(1.0 - (1.0 - pole) ** 2 / (2.0 * pole)) / (2.0 * pi)
    assert fit.bandwidth == pytest.approx(expected, rel=0.05)
    assert fit.deviation(TAU) == pytest.approx(np.sqrt(variance), rel=0.03)


def drawn(name, generator, dt):
    """Return blocks of one process whose N, B or K is 2."""
    return {
        "N": lambda: noise.white(generator, 2.0 / sqrt(dt)),
        "B, Gauss-Markov": lambda: noise.gauss_markov(generator, 2.0 / allan.INSTABILITY, 100.0, dt),
        "B, flicker": lambda: noise.flicker(generator, 2.0, dt, 1, dt, 1e6),
        "K": lambda: noise.random_walk(generator, 2.0, dt),
    }[name]()


@pytest.mark.parametrize("name", ["N", "B, Gauss-Markov", "B, flicker", "K"])
def test_each_process_alone_gives_its_coefficient_back(name):
    """Within 5 %: 2^19 exactly discretised readings, streamed; N at 100 Hz, the others at 1 Hz.

    The estimates scatter by 0.3 % (N), 0.9 % (B, 5200 correlation times), 0.4 % (flicker) and 1 % (K): α is below
    1e-5, and a density that is two-sided by mistake (√2), or a B without its 0.664, would always fail.
    """
    dt = 0.01 if name == "N" else 1.0
    source = drawn(name, np.random.default_rng(10), dt)
    pieces = (np.column_stack((dt * (k * noise.BLOCK + np.arange(len(b))), b)) for k, b in
              enumerate(islice(source, 2**19 // noise.BLOCK)))  # fmt: skip
    (found,) = characterise(pieces, ["x"], drift=100.0 if "Gauss" in name else "flicker")
    assert found.fit is not None
    coefficient = getattr(found.fit, name[0])
    assert coefficient.value == pytest.approx(2.0, rel=0.05)
    assert coefficient.resolved
    if "B" in name:
        return  # sampled once a second, drift itself is a little white
    assert not any(getattr(found.fit, other).resolved for other in "NBKQ" if other != name)


def test_a_search_tells_a_gauss_markov_process_from_flicker_noise():
    """5200 correlation times against 5000 hours of 1/f: the shape is found, the time within 10 %."""
    for name, time in (("B, Gauss-Markov", 100.0), ("B, flicker", None)):
        source = drawn(name, np.random.default_rng(11), 1.0)
        values = np.concatenate(list(islice(source, 512)))
        (found,) = characterise([np.column_stack((np.arange(len(values), dtype=float), values))], ["x"])
        assert found.fit is not None
        assert found.fit.correlation_time == (None if time is None else pytest.approx(time, rel=0.10))
        assert found.fit.B.value == pytest.approx(2.0, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("pole", [0.0, 0.9])
def test_intervals_of_a_fit_hold_the_truth(pole):
    """95 % intervals of N, B and K in 80 records of white noise (N = 1), drift (s = 1, T = 100 s) and random walk.

    An hour at 100 Hz each, T given. Bounds of 85 % mean: binomial, α = 1e-3 if 95 % is true, and 75 % would fail.
    """
    truth = {"N": 1.0, "B": allan.INSTABILITY, "K": 0.03}
    held = dict.fromkeys(truth, 0)
    count, dt = 360_000, 0.01
    phi = exp(-dt / 100.0)
    for seed in range(80):
        rng = np.random.default_rng(seed)
        values = lfilter([1.0 - pole], [1.0, -pole], rng.normal(size=count) / sqrt(dt))
        values += lfilter([sqrt(1.0 - phi**2)], [1.0, -phi], rng.normal(size=count))
        values += np.cumsum(rng.normal(size=count)) * truth["K"] * sqrt(dt)
        (found,) = characterise([np.column_stack((np.arange(count) * dt, values))], ["x"], drift=100.0)
        assert found.fit is not None
        for name, true in truth.items():
            coefficient = getattr(found.fit, name)
            held[name] += coefficient.low <= true <= coefficient.high
    assert min(held.values()) >= binom.ppf(1e-3, 80, 0.95) - 2, held


# -- what is promised ------------------------------------------------------------------------------------------------


def test_promised_terms_make_up_the_total():
    tau = np.array([0.01, 1.0, 100.0])
    found = promised(on_bench("bmp390"), tau)
    terms = [found[name] for name in ("white noise", "quantisation", "bias instability", "random walk")]
    assert found["total"] == pytest.approx(np.sqrt(sum(term**2 for term in terms)))
    assert promised(on_bench("adxl345"), tau, "fz")["total"][0] > promised(on_bench("adxl345"), tau)["total"][0]


def test_promise_in_the_datasheets_own_numbers():
    """BMP390 x1: 3.7 Pa at 200 Hz, K = 5e-3. LSM6DSO32 at 32 g: 220 µg/√Hz, N = n/√2 beside its rounding."""
    (p,) = promises(on_bench("bmp390"))
    assert p.K == 5e-3
    assert p.N * sqrt(200.0) == pytest.approx(3.7)
    assert p.deviation(1 / 200.0) == pytest.approx(3.7, rel=1e-3)
    x = promises(on_bench("lsm6dso32"))[0]
    rounding = 32 * G0 / 2**15 / sqrt(12.0 * 833.0)
    assert x.N / sqrt((220e-6 * G0) ** 2 / 2.0 + rounding**2) == pytest.approx(1.0)
    assert x.density(100.0) == pytest.approx(sqrt(2.0) * x.N, rel=1e-3)


def test_without_errors_only_the_noise_is_promised():
    quiet = on_bench("lsm6dso32").scaled(1.0, AccelerometerErrors(drift=0.0, random_walk=0.0, quantisation=False))
    x = promises(quiet)[0]
    assert (x.B, x.K) == (0.0, 0.0)
    tau = np.array([0.1, 10.0, 1000.0])
    assert x.deviation(tau) * np.sqrt(tau) == pytest.approx(220e-6 * G0 / sqrt(2.0), rel=1e-6)


def test_flicker_is_flat_at_the_peak_of_the_gauss_markov_process():
    """Flat means: within 4 % from a twentieth of the correlation time to twenty of them."""
    part = on_bench("bmp390")
    humped, flat = (
        promises(part.scaled(0.0, PressureErrors(random_walk=0.0, quantisation=False, drift_model=model)))[0]
        for model in ("gauss-markov", "flicker")
    )
    tau = np.geomspace(5.0, 2000.0, 40)
    assert flat.correlation_time is None
    assert flat.terms(tau)["bias instability"] == pytest.approx(humped.deviation(189.26), rel=0.04)
    assert humped.B == flat.B


# -- presets as a whole ----------------------------------------------------------------------------------------------


def settings_of(name, *, every):
    """Return settings of a part: its default and slowest and fastest, or all."""
    part = on_bench(name)
    if isinstance(part, PressureDescription):
        modes = [mode.name for mode in part.modes]
        chosen = modes if every else sorted({modes[0], modes[len(modes) // 2], modes[-1]})
        return [{"mode": mode} for mode in chosen]
    rates = [rate for rate, width in zip(part.rates, part._passed, strict=True) if width]
    if not every:
        return [{"rate": rate} for rate in sorted({rates[0], part.rate, rates[-1]})]
    return [
        {"rate": rate, "filter": own, "range_g": range_g}
        for f, own in enumerate(part.filters)
        for r, rate in enumerate(part.rates)
        if part.bandwidths[f][r] and (f == 0 or rate in (part.rates[0], part.rate, part.rates[-1]))
        for range_g in (part.ranges_g if rate == part.rate and own == part.filter else part.ranges_g[-1:])
    ]


def white_level(name, settings):
    """Return measured N over the datasheet's, channels together, and how many degrees of freedom that has.

    The Allan variance at τ = 30/bandwidth of the part as a whole, less what drift and rounding add at that τ. Where
    drift is more than a fifth of the noise there, which is so for quiet parts at low rates, a shorter τ is taken, and
    what the low-pass leaves of N²/τ at it is counted in.
    """
    part = on_bench(name, **settings)
    first = multiple = max(round(30.0 * part.rate / part.bandwidth), 1)
    while multiple > 1 and share_of_drift(part, multiple / part.rate) > 0.2:
        multiple //= 2
    lengths = 4000 if isinstance(part, PressureDescription) else 1500
    record = np.concatenate(list(blocks(part, duration=lengths * first / part.rate, seed=12)))
    ratios, freedom = [], 0.0
    for column, promise in enumerate(promises(part), start=1):
        found = allan_deviation(record[:, column], part.rate, [multiple])
        terms = {name: float(term[0]) ** 2 for name, term in promise.terms(found.tau).items()}
        noise_only = found.deviation[0] ** 2 - sum(terms.values()) + terms["white noise"]
        kept = terms["white noise"] * found.tau[0] / promise._white**2
        ratios.append(float(noise_only * found.tau[0] / kept) / datasheet(part, column) ** 2)
        freedom += float(found.edf[0])
    return sqrt(np.mean(ratios)), freedom


def share_of_drift(part, tau):
    """Return the Allan variance of the drift over that of the noise."""
    terms = promises(part)[0].terms(tau)
    return float(terms["bias instability"] ** 2 + terms["random walk"] ** 2) / float(terms["white noise"] ** 2)


def datasheet(part, column):
    """Return N as the datasheet has it, rounding apart: n/√2 of a density, σ √τ_0 of a figure a conversion."""
    if isinstance(part, PressureDescription):
        return sqrt((part.mode.noise_sd**2 - part.resolution**2 / 12.0) / part.rate)
    density = part.noise_densities[part.ranges_g.index(part.range_g)][column - 1]
    return density * sqrt(0.5 * max(1.0, part.noise_rate_floor / part.rate))


@pytest.mark.parametrize("name", presets())
def test_a_part_as_a_whole_has_its_datasheets_n_at_three_rates_or_modes(name):
    """Within 5 %, with everything on. Records of 4000 τ, or 1500 on each of three axes, leave 4500 degrees of
    freedom or more, 1.1 % of N (1 sd).

    α is 1e-5 a setting; a density taken as two-sided (√2), or a filter that takes noise away, would always fail.
    """
    for settings in settings_of(name, every=False):
        ratio, freedom = white_level(name, settings)
        assert freedom > 3500
        assert ratio == pytest.approx(1.0, abs=0.05), settings


@pytest.mark.slow
@pytest.mark.parametrize("name", presets())
def test_a_part_as_a_whole_has_its_datasheets_n_in_every_setting(name):
    """As above over all modes; over all rates, all ranges, and all filters at the slowest, default and fastest rate.

    But where a low-pass leaves less noise than half a step: rounding is then no noise of its own, nor is it promised.
    """
    for settings in settings_of(name, every=True):
        part = on_bench(name, **settings)
        if not isinstance(part, PressureDescription) and min(part.noise_sd) < 0.5 * part.resolution:
            continue
        ratio, _ = white_level(name, settings)
        assert ratio == pytest.approx(1.0, abs=0.05), settings


FILTERED = [
    ("lsm6dso32", {"rate": 833, "filter": "rate/20"}),
    ("lsm6dso32", {"rate": 104}),
    ("bmi088", {"rate": 400, "filter": "osr4"}),
    ("bmp390", {"mode": "x1/x1", "iir": 8}),
    ("bmp581", {"mode": "x16/x1", "iir": 31}),
    ("ms5611", {}),
]


@pytest.mark.parametrize(("name", "settings"), FILTERED)
def test_the_whole_allan_deviation_is_as_promised(name, settings):
    """At all τ with 40 degrees of freedom or more, behind each kind of filter and with all drifts.

    Each within 5 standard deviations of χ² (α = 1e-6 a point, 1e-4 a record; at short τ, 5 sd are 2 % in σ).
    """
    part = on_bench(name, **settings)
    record = np.concatenate(list(blocks(part, duration=200_000 / part.rate, seed=13)))
    channels = columns_of(part)[1 : 1 + len(promises(part))]
    for found, promise in zip(characterise([record], channels), promises(part), strict=True):
        tau, sure = found.allan.tau, found.allan.edf > 40.0
        correlated = max(1.0, part.rate / (2.0 * min(promise.bandwidth, part.rate)))
        sd = np.sqrt(2.0 / found.allan.edf * correlated)
        ratio = found.allan.deviation**2 / promise.deviation(tau) ** 2
        assert np.all((np.abs(ratio - 1.0) < 5.0 * sd + 0.01)[sure]), np.round(ratio, 3)


def test_density_and_histogram_of_a_part_are_as_promised():
    """BMP390 x1 with IIR 8, 200 000 readings: densities above 2 Hz within 15 %, the standard deviation within 4 %."""
    part = on_bench("bmp390", iir=8)
    (promise,) = promises(part)
    record = np.concatenate(list(blocks(part, duration=1000.0, seed=14)))
    (found,) = characterise([record], ["pressure"])
    f, density = found.spectrum.frequency, found.spectrum.density
    inside = (f > 2.0) & (f < 99.0)
    assert density[inside] == pytest.approx(promise.density(f[inside]), rel=0.15)
    assert promise.noise_sd == pytest.approx(part.noise_sd)
    assert found.histogram.sd == pytest.approx(promise.noise_sd, rel=0.04)
    assert found.fit is not None
    assert found.fit.bandwidth == pytest.approx(promise.bandwidth, rel=0.1)


def test_levels_can_be_looked_at_alone():
    """A pyramid of one level is the plain Allan deviation."""
    values = np.random.default_rng(15).normal(size=3000)
    one, plain = _allan([values], 10.0), allan_deviation(values, 10.0)
    assert one.deviation == pytest.approx(plain.deviation)
    assert one.tau == pytest.approx(plain.tau)
