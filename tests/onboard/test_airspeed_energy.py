"""The aided filter's core against the same equations written with matrices, and against a posterior on a grid."""

import math

import numpy as np
import pytest

from uavsim.onboard.airspeed import EnergyFilter
from uavsim.onboard.airspeed.energy import SEVEN_R

NAMES = "vbpsdk"
HEAT = SEVEN_R * 288.15
DENSITY = 1.225


def made(**changes):
    settings = {
        "speed_sd": 2.0, "rest_force": 2.5, "rest_sd": 0.05, "bias_sd": 0.3, "bias_time": 5.0, "slope_rate": 0.7,
        "slope_time": 4.0, "static": 101_325.0, "static_sd": 10.0, "static_walk": 0.3, "difference_sd": 0.2,
        "difference_walk": 0.01, "acceleration_sd": 0.06,
    }  # fmt: skip
    return EnergyFilter(**settings | changes)


def state(f):
    return np.array([getattr(f, name) for name in NAMES])


def covariance(f):
    return np.array([[getattr(f, min(a + b, b + a, key=ORDER.index)) for b in NAMES] for a in NAMES])


ORDER = [a + b for i, a in enumerate(NAMES) for b in NAMES[i:]] + [
    a + b for i, a in enumerate(NAMES) for b in NAMES[:i]
]


def transition(f, dt, gained, railed):
    """F, and the state after, by the equations of the module's docstring."""
    v, b, p, s, d, k = state(f)
    change = gained - dt * (b + s)
    keep, stay = (1.0, 1.0) if railed else (1.0 - dt / 5.0, 1.0 - dt / 4.0)
    matrix = np.diag([1.0, keep, 1.0, stay, 1.0, 1.0])
    matrix[0, 1] = matrix[0, 3] = -dt
    across = -DENSITY * (v + 0.5 * change) * dt
    matrix[2, 0], matrix[2, 3] = -DENSITY * s * dt, across
    return matrix, np.array([v + change, keep * b, p + across * s, stay * s, d, k]), across


def noise(dt, variance, across, railed):
    share = 1e-4 if railed else 1.0
    q_b, q_s = share * 2.0 * 0.3**2 / 5.0 * dt, share * 0.7**2 * dt
    q = np.diag([variance, q_b, 0.3**2 * dt, q_s, 0.01**2 * dt, 0.0])
    if not railed:  # ∫ of the noise of b and s over the interval, seen by V and p
        q[0, 0] += dt * dt / 3.0 * (q_b + q_s)
        q[2, 2] += across**2 / 3.0 * q_s
        q[0, 1] = q[1, 0] = -0.5 * dt * q_b
        q[0, 3] = q[3, 0] = -0.5 * dt * q_s
        q[2, 3] = q[3, 2] = 0.5 * across * q_s
        q[0, 2] = q[2, 0] = -across * dt / 3.0 * q_s
    return q


@pytest.mark.parametrize("railed", [True, False])
def test_equals_the_matrix_filter(railed):
    """30 steps with both updates, state and covariance to 1e-9 of their scales (Kalman 1960 with Joseph's form)."""
    f = made()
    f.v, f.vv = 25.0, 0.04  # the linear case: what h bends is far below the noise
    generator = np.random.default_rng(3)
    for _ in range(30):
        dt, gained = 0.008, generator.normal(0.02, 0.01)
        matrix, after, across = transition(f, dt, gained, railed)
        expected = matrix @ covariance(f) @ matrix.T + noise(dt, 2e-4, across, railed)
        f.predict(dt, gained, 2e-4, DENSITY, railed)
        np.testing.assert_allclose(state(f), after, rtol=1e-12)
        np.testing.assert_allclose(covariance(f), expected, rtol=1e-9, atol=1e-12)

        h = np.array([0.0, 0.0, 1.0, 0.05, 0.0, 0.0])
        before, prior = state(f), covariance(f)
        reading = f.p + generator.normal(0.0, 1.0)
        nis = f.static(reading, 1.44, 0.05)
        check(f, before, prior, h, reading - h @ before, 1.44, nis)

        before, prior = state(f), covariance(f)
        y = 1.0 + f.v**2 / HEAT
        slope = 7.0 * f.p / HEAT * f.v * y**2.5
        h = np.array([slope, 0.0, y**3.5, 0.0, 1.0, 3.0])
        reading = y**3.5 * f.p + generator.normal(0.0, 1.0)
        bend = slope / f.v * prior[0, 0]
        innovation = reading - y**3.5 * f.p - f.d - 3.0 * f.k - 0.5 * bend
        nis = f.total(reading, 1.44, 3.0, HEAT)
        check(f, before, prior, h, innovation, 1.44 + 0.5 * bend**2, nis)


def check(f, before, prior, h, innovation, variance, nis):
    spread = h @ prior @ h + variance
    gain = prior @ h / spread
    joseph = np.eye(6) - np.outer(gain, h)
    np.testing.assert_allclose(state(f), before + gain * innovation, rtol=1e-9)
    np.testing.assert_allclose(
        covariance(f), joseph @ prior @ joseph.T + variance * np.outer(gain, gain), rtol=1e-7, atol=1e-10
    )
    assert nis == pytest.approx(innovation**2 / spread, rel=1e-9)


def test_slopes_of_the_total_pressure_are_its_derivatives():
    """h of the isentropic relation, differentiated by central differences of 1e-4 m/s; 1e-6."""

    def h(v, p):
        return p * (1.0 + v * v / HEAT) ** 3.5

    for v in (5.0, 30.0, 204.0):
        f = made()
        f.v, f.vv, f.p, f.pp = v, 1e-6, 9e4, 1e-12
        f.vb = f.vp = f.vs = f.vd = f.vk = f.dd = f.kk = 0.0
        f.total(h(v, 9e4) + 1.0, 1.0, 0.0, HEAT)
        slope = (h(v + 1e-4, 9e4) - h(v - 1e-4, 9e4)) / 2e-4
        assert f.v - v == pytest.approx(1e-6 * slope / (1.0 + 1e-6 * slope**2), rel=1e-5)


@pytest.mark.parametrize("truth", [6.5, 9.0, 12.0])
def test_wide_prior_is_taken_where_the_reading_leads(truth):
    """V = 9 ± 3 m/s and one reading of 1.2 Pa: mean and deviation of the posterior on a grid, to 2 % of 3 m/s, 10 %."""
    f = made(speed_sd=3.0, static_sd=1e-3, difference_sd=0.0, acceleration_sd=0.0)
    f.v = 9.0
    reading = f.p * (1.0 + truth**2 / HEAT) ** 3.5
    grid = np.linspace(0.0, 30.0, 30_001)
    fit = (reading - 101_325.0 * (1.0 + grid**2 / HEAT) ** 3.5) / 1.2
    density = np.exp(-0.5 * ((grid - 9.0) / 3.0) ** 2 - 0.5 * fit**2)
    density /= density.sum()
    mean = density @ grid
    sd = math.sqrt(density @ (grid - mean) ** 2)
    f.total(reading, 1.44, 0.0, HEAT)
    assert f.v == pytest.approx(mean, abs=0.06)
    assert math.sqrt(f.vv) == pytest.approx(sd, rel=0.10)


def test_second_order_expects_what_a_wide_speed_reads():
    """At rest E[p_t − p] = ρ P/2 and its variance (ρ P)²/2: mean and variance of ½ρV² with V Gaussian, to 1 %.

    The innovation is formed with both, so NIS of draws from that distribution is 1: n = 20 000, 4 deviations of a mean
    of χ²-like values with kurtosis 15 are 4·√(14/n) = 11 %.
    """
    generator = np.random.default_rng(5)
    found = []
    for v in generator.normal(0.0, 0.5, 20_000).tolist():
        f = made(speed_sd=0.5, static_sd=1e-6, difference_sd=0.0, acceleration_sd=0.0)
        found.append(f.total(f.p * (1.0 + v * v / HEAT) ** 3.5 + generator.normal(0.0, 0.05), 0.0025, 0.0, HEAT))
    assert np.mean(found) == pytest.approx(1.0, abs=0.11)


@pytest.mark.parametrize(("each", "static_each"), [(0.63, 0.9), (0.3, 0.7)])
def test_a_difference_that_is_not_known_stays_in_steady_flight(each, static_each):
    """30 s of level flight in still air, d known to 5 Pa: half a minute tells nothing of it, and V is off by as much.

    Its slope is that of a noisy estimate. Corrected by every reading, d walked by 5 to 20 Pa, in either direction, as
    the total pressure was taken with its bend or without; its variance did not change.
    """
    generator = np.random.default_rng(8)
    f = made(difference_sd=5.0, difference_walk=0.0, static_sd=1.0)
    f.v, f.vv, f.s, f.ss, f.bs = 32.0, 25.0 / (DENSITY * 32.0) ** 2 + 0.01, 0.0, 0.1, 0.0
    f.vd = -25.0 / (DENSITY * 32.0)
    f.know_push()
    f.hold_difference()
    total = 101_325.0 * (1.0 + 32.0**2 / HEAT) ** 3.5
    for _ in range(2400):
        f.fly(
            0.0125, generator.normal(0.0, 0.01), 1.25e-4, DENSITY, generator.normal(101_325.0, static_each),
            static_each**2, 0.0, generator.normal(total, each), each**2, HEAT,
        )  # fmt: skip
    assert f.dd == 25.0
    assert f.d == 0.0
    assert abs(f.v - 32.0) < 0.05
    assert math.sqrt(f.vv) == pytest.approx(5.0 / (DENSITY * 32.0), rel=0.05)
