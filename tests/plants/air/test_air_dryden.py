"""The turbulence's law and its forming filters, without statistics.

Authorities: the spectra as MIL-F-8785C and MIL-HDBK-1797 print them (`references.dryden`), Van Loan's matrix
exponential (IEEE Trans. AC-23, 1978) for the step, Lyapunov's equation for what remains, and the closed form of
Dryden's correlation, e^(−x) of u and e^(−x)(1 − x/2) of v and w, x = τ/T. Tolerances are those of rounding.
"""

from math import exp, pi, sqrt

import numpy as np
import pytest
from references import dryden as specification
from scipy.integrate import quad
from scipy.linalg import expm, solve_discrete_lyapunov

from uavsim.plants.air import dryden
from uavsim.plants.air.dryden import FOOT

ROOT3 = sqrt(3.0)
HEIGHTS = (3.048, 5.0, 20.0, 60.0, 250.0, 304.8)  # m


def made(a: float, c: float, dt: float, second: bool) -> tuple[np.ndarray, np.ndarray]:
    """Transition and covariance of a step, as the package has them."""
    f, g = np.zeros((3, 3)), np.zeros((3, 3))
    dryden.coefficients.function(a, c, dt, second, f, g)
    return f, g @ g.T


def written(a: float, c: float, second: bool) -> tuple[np.ndarray, np.ndarray]:
    """A and B of the same filter, from its transfer function; (z₁, z₂, m), or (u, m) of first order."""
    if second:
        return np.array([[-a, 0, 0], [a, -a, 0], [ROOT3 * c, (1 - ROOT3) * c, -c]]), np.array([[sqrt(a)], [0], [0]])
    return np.array([[-a, 0], [c, -c]]), np.array([[sqrt(2 * a)], [0]])


def van_loan(a: float, c: float, dt: float, second: bool) -> tuple[np.ndarray, np.ndarray]:
    matrix, drive = written(a, c, second)
    n = len(matrix)
    big = np.zeros((2 * n, 2 * n))
    big[:n, :n], big[:n, n:], big[n:, n:] = -matrix, drive @ drive.T, matrix.T
    power = expm(big * dt)
    transition = power[n:, n:].T
    return transition, transition @ power[:n, n:]


def kept(matrix: np.ndarray, second: bool) -> np.ndarray:
    return matrix if second else matrix[np.ix_((0, 2), (0, 2))]


def drawn(seed: int) -> tuple[float, float, float]:
    """Poles, 1/s, and a step, s, from a glider in a breath of air to a missile's wing, at 50 Hz … 2 kHz."""
    random = np.random.default_rng(seed)
    dt = float(np.exp(random.uniform(np.log(5e-4), np.log(2e-2))))
    a, c = np.exp(random.uniform(np.log(1e-3), np.log(60.0), 2))
    if seed % 3 == 0:  # equal, or nearly
        c = a * (1.0 + random.choice([0.0, 1e-14, -1e-10, 1e-7, -1e-4, 1e-2]))
    return float(a), float(c), dt


@pytest.mark.parametrize("second", [False, True], ids=["u", "v"])
@pytest.mark.parametrize("seed", range(60))
def test_a_step_is_exact(seed: int, second: bool) -> None:
    """Transition to 1e-12; each covariance to 1e-9 of the two deviations' product, which is Van Loan's own rounding."""
    a, c, dt = drawn(seed)
    f, q = made(a, c, dt, second)
    transition, covariance = van_loan(a, c, dt, second)
    assert kept(f, second) == pytest.approx(transition, rel=1e-12, abs=1e-15)
    sd = np.sqrt(np.diag(covariance))
    assert np.abs(kept(q, second) - covariance).max() < 1e-9 * covariance.max()
    assert np.diag(kept(q, second)) == pytest.approx(sd**2, rel=1e-7)
    if not second:
        assert not f[1].any()
        assert not f[:, 1].any()
        assert not q[1].any()


@pytest.mark.parametrize("second", [False, True], ids=["u", "v"])
@pytest.mark.parametrize("seed", range(20))
def test_two_steps_are_one_of_twice_the_length(seed: int, second: bool) -> None:
    """So a flight's turbulence is that of the law at any rate: each second sample of 1 kHz is as one of 500 Hz."""
    a, c, dt = drawn(seed)
    f, q = made(a, c, dt, second)
    f2, q2 = made(a, c, 2 * dt, second)
    assert f @ f == pytest.approx(f2, rel=1e-12, abs=1e-16)
    assert q + f @ q @ f.T == pytest.approx(q2, rel=1e-10, abs=1e-10 * q2.max())


@pytest.mark.parametrize("second", [False, True], ids=["u", "v"])
@pytest.mark.parametrize("dt", [1e-3, 2e-3, 1e-2])
@pytest.mark.parametrize(("a", "c"), [(0.145, 16.755), (3.2, 12.6), (0.02, 47.0), (12.0, 12.0)])
def test_the_correlation_of_the_samples_is_that_of_the_law(a: float, c: float, dt: float, second: bool) -> None:
    """Of the gust in closed form, 1e-9; of the rotation by the integral of the printed spectrum, 1e-6 of its variance.

    V = 1 m/s, so the filter of q is (iω)/(1 + iω/c).
    """
    f, q = (kept(matrix, second) for matrix in made(a, c, dt, second))
    rest = solve_discrete_lyapunov(f, q)
    of = np.array([ROOT3, 1 - ROOT3, 0.0] if second else [1.0, 0.0])
    mean = np.array([0.0, 0.0, 1.0] if second else [0.0, 1.0])
    lag = c * (of - mean)

    def density(omega: float) -> float:
        x2 = (omega / a) ** 2
        gust = (1 + 3 * x2) / (1 + x2) ** 2 / (pi * a) if second else 2 / (1 + x2) / (pi * a)
        return omega**2 / (1 + (omega / c) ** 2) * gust

    variance = quad(density, 0.0, np.inf, limit=500)[0]
    for steps in (0, 1, 7, 50, 300):
        x = a * steps * dt
        power = np.linalg.matrix_power(f, steps)
        assert of @ power @ rest @ of == pytest.approx(exp(-x) * (1 - x / 2 if second else 1.0), abs=1e-9)
        there = quad(density, 0.0, np.inf, weight="cos", wvar=steps * dt)[0] if steps else variance
        assert lag @ power @ rest @ lag == pytest.approx(there, abs=1e-6 * variance)


def test_what_rests_is_drawn_with_the_filters_own_covariance() -> None:
    """Each draw is a fixed matrix times normal numbers: read off column by column, its square is Lyapunov's, 1e-9."""
    f, g = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
    poles = ((0.145, 16.755, False), (0.145, 16.755, True), (0.533, 12.57, True))
    for i, (a, c, second) in enumerate(poles):
        dryden.coefficients.function(a, c, 1e-3, second, f[i], g[i])
    root = np.array([dryden.at_rest(f, g, one) for one in np.eye(9)]).T
    found = root @ root.T
    asked = np.zeros((9, 9))
    asked[8, 8] = 1.0
    for i, (first, size) in enumerate(((0, 2), (2, 3), (5, 3))):
        part = slice(first, first + size)
        second = size == 3
        asked[part, part] = solve_discrete_lyapunov(kept(f[i], second), kept(g[i] @ g[i].T, second))
    assert found == pytest.approx(asked, abs=1e-9)
    assert found[0, 0] == pytest.approx(1.0)


def test_one_step_leaves_what_rests_as_it_is() -> None:
    """`advance` is linear: its matrices, read off column by column, keep the resting covariance to 1e-9.

    p, too: what remains of it and what is added have unit variance together.
    """
    f, g = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
    for i, (a, c) in enumerate(((0.145, 16.755), (0.145, 16.755), (0.533, 12.57))):
        dryden.coefficients.function(a, c, 1e-3, i > 0, f[i], g[i])
    left = exp(-0.01257)
    p = np.array([left, sqrt(1 - left**2)])

    def after(state: np.ndarray, noise: np.ndarray) -> np.ndarray:
        state = state.copy()
        dryden.advance.function(state, noise, f, g, p)
        return state

    nothing = np.zeros(9)
    transition = np.array([after(one, nothing) for one in np.eye(9)]).T
    added = np.array([after(nothing, one) for one in np.eye(9)]).T
    root = np.array([dryden.at_rest(f, g, one) for one in np.eye(9)]).T
    rest = root @ root.T
    assert transition @ rest @ transition.T + added @ added.T == pytest.approx(rest, abs=1e-9)


# -- the law -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("speed", [8.0, 32.0, 90.0])
def test_both_specifications_give_the_same_air(height: float, speed: float) -> None:
    """Each as printed, with lengths by its own definition: all six spectra agree to rounding."""
    omega = np.geomspace(1e-3, 1e3, 50)
    one, two = (specification.spatial(specification.low(height, 8.0, h), 2.0) for h in (False, True))
    above = [specification.spatial(specification.high(2.0, h), 2.0) for h in (False, True)]
    for name in specification.GUSTS:
        there = specification.in_time(one[name], speed)(omega)
        assert specification.in_time(two[name], speed)(omega) == pytest.approx(there, rel=1e-12)
        assert above[1][name](omega) == pytest.approx(above[0][name](omega), rel=1e-12)


@pytest.mark.parametrize("height", HEIGHTS)
def test_lengths_and_deviations_are_those_of_each_specification(height: float) -> None:
    for model, handbook in (("mil-f-8785c", False), ("mil-hdbk-1797", True)):
        air = specification.low(height, 8.0, handbook)
        assert dryden.lengths(model, height) == pytest.approx((air.along, air.across, air.down), rel=1e-12)
        assert dryden.deviations(8.0, height) == pytest.approx((air.sd_u, air.sd_w), rel=1e-12)
        aloft = specification.high(1.0, handbook)
        for above in (609.6, 900.0, 5000.0):
            assert dryden.lengths(model, above) == pytest.approx((aloft.along, aloft.across, aloft.down), rel=1e-12)
        spans = [s * length for s, length in zip(dryden.spans(model), dryden.lengths(model, height), strict=True)]
        first = specification.low(height, 8.0)
        assert spans == pytest.approx([first.along, first.across, first.down], rel=1e-12)


def test_the_law_is_printed_for_these_numbers() -> None:
    """MIL-F-8785C 3.7.3.4 at 20, 200 and 1000 ft, worked by hand; at 1000 ft the air is isotropic, L = h."""
    assert dryden.lengths("mil-f-8785c", 1000 * FOOT) == pytest.approx((304.8, 304.8, 304.8), rel=1e-12)
    assert dryden.deviations(10.0, 1000 * FOOT) == pytest.approx((1.0, 1.0), rel=1e-12)
    assert dryden.lengths("mil-f-8785c", 20 * FOOT) == pytest.approx((43.79, 43.79, 6.096), rel=1e-3)
    assert dryden.deviations(10.0, 20 * FOOT)[0] == pytest.approx(1.929, rel=1e-3)
    assert dryden.lengths("mil-hdbk-1797", 200 * FOOT) == pytest.approx((221.2, 110.6, 30.48), rel=1e-3)


@pytest.mark.parametrize("height", [-3.0, 0.0, 1.5, 3.0])
def test_below_10_ft_all_is_as_at_10_ft(height: float) -> None:
    for model in ("mil-f-8785c", "mil-hdbk-1797"):
        assert dryden.lengths(model, height) == dryden.lengths(model, 3.048)
    assert dryden.deviations(8.0, height) == dryden.deviations(8.0, 3.048)


def test_aloft_the_deviation_is_that_of_figure_7() -> None:
    """MIL-F-8785C, figure 7, as FGWinds of JSBSim 1.3 reads it: at its heights, between them, and outside."""
    points = {(500, 1): 3.2, (1750, 3): 6.9, (3750, 4): 10.6, (7500, 7): 30.2, (25000, 6): 20.0, (80000, 5): 2.1}
    for (feet, severity), asked in points.items():
        assert dryden.sd_above(feet * FOOT, severity) == pytest.approx(asked * FOOT)
    assert dryden.sd_above(2750 * FOOT, 3) == pytest.approx(7.15 * FOOT)
    assert dryden.sd_above(300 * FOOT, 7) == pytest.approx(18.7 * FOOT)
    assert dryden.sd_above(9e4 * FOOT, 7) == pytest.approx(7.2 * FOOT)
    for feet in np.geomspace(500, 7500, 20):  # the rarer, the rougher
        assert np.all(np.diff([dryden.sd_above(feet * FOOT, s) for s in range(1, 8)]) > 0.0)


@pytest.mark.parametrize("length", [3.048, 60.0, 533.4])
def test_the_deviation_of_p_is_the_integral_of_its_spectrum(length: float) -> None:
    air = specification.Air(length, length, length, 1.3, 1.3, 1.3, False)
    p = specification.spatial(air, 2.0)["p"]
    variance = quad(lambda k: float(p(np.array(k))), 0.0, np.inf)[0]
    assert dryden.roll_deviation.function(1.3, length, 2.0) ** 2 == pytest.approx(variance, rel=1e-6)
