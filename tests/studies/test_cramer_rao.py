"""The bound against what it must be where that is known: Kalman's covariance and the Riccati equation."""

import numpy as np
import pytest

from uavsim.airdata import STANDARD_PRESSURE, STANDARD_TEMPERATURE
from uavsim.onboard.airspeed import AidedSettings, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.hand_over import AROUND
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.studies.cramer_rao import AirspeedBound, Courses, Information, Schedule, Start

NOISE = NoiseModel(total_sd=1.2, static_sd=1.2, temperature_sd=0.0, walk=3e-5, acceleration_sd=0.01)


def cruise(duration=40.0, flights=2, speed=30.0):
    """Level cruise at rest force 0: every flight alike, so that no expectation is involved."""
    t = np.arange(0.0, duration, 0.01)
    shape = (flights, t.size)
    return Courses(
        t, np.full(shape, speed), np.zeros(shape), np.full(shape, STANDARD_PRESSURE), np.zeros(shape),
        STANDARD_TEMPERATURE,
    )  # fmt: skip


def bound(courses, noise=NOISE, rate=100.0, **changes):
    told = np.arange(1, int(courses.t[-1] * rate)) / rate
    settings = EstimatorSettings(kind="aided", wind_sd=1.0, aided=AidedSettings(**changes))
    return AirspeedBound(courses, Schedule(0.0, told, told, told), settings, noise, Start(0.05, 1e-4))


def test_linear_gaussian_is_kalman():
    """With the same F for all the recursion is the information filter: J⁻¹ = Kalman's P to 1e-10."""
    generator = np.random.default_rng(2)
    f, root = np.eye(3) + 0.1 * generator.normal(size=(3, 3)), generator.normal(size=(3, 3))
    q, h, r = root @ root.T + np.eye(3), generator.normal(size=3), 0.7
    p = np.diag([1.0, 4.0, 9.0])
    information = Information(np.linalg.inv(p))
    for _ in range(20):
        p = f @ p @ f.T + q
        p = p - np.outer(p @ h, h @ p) / (h @ p @ h + r)
        information.predict(np.repeat(f[None], 7, axis=0), q)
        information.update(np.repeat(h[None], 7, axis=0), r)
        np.testing.assert_allclose(information.covariance(), p, rtol=1e-10)


def test_settles_at_the_riccati_equation():
    """Cruise at 30 m/s, 100 Hz: the bound on V after 40 s is the discrete Riccati equation's, to 1e-6.

    Authority: scipy.linalg.solve_discrete_are on F, Q and H written here by hand. Without effect and left out: k
    in cruise, and the pair's difference d, which V cannot be told from and whose walk would never settle.
    """
    from scipy.linalg import solve_discrete_are

    dt, v = 0.01, 30.0
    aided = AidedSettings()
    rho_v = STANDARD_PRESSURE / (SEVEN_R / 7.0 * STANDARD_TEMPERATURE) * v
    f = np.diag([1.0, 1.0 - dt / aided.bias_time, 1.0, 1.0 - dt / aided.slope_time])
    f[0, 1] = f[0, 3] = -dt
    f[2, 3] = -rho_v * dt
    q_b, q_s = 2.0 * aided.bias_sd**2 / aided.bias_time * dt, aided.slope_rate**2 * dt
    q = np.diag([0.0, q_b, aided.static_walk**2 * dt, q_s])
    q[0, 0] = 2.0 * 0.2**2 * v / aided.gust_length * dt + NOISE.accelerometer_sd**2 / 1000.0 * dt + q_b * dt**2 / 3.0
    reach = np.array([dt, rho_v * dt])
    q[np.ix_((0, 2), (0, 2))] += q_s / 3.0 * np.outer(reach, reach)
    q[0, 1] = q[1, 0] = -0.5 * dt * q_b
    q[[0, 2], 3] = q[3, [0, 2]] = -0.5 * q_s * reach
    y = 1.0 + v**2 / (SEVEN_R * STANDARD_TEMPERATURE)
    h = np.array([[0.0, 0.0, 1.0, 0.0], [rho_v * y**2.5, 0.0, y**3.5, 0.0]])
    r = np.diag([1.44, 1.44])
    prior = solve_discrete_are(f.T, h.T, q, r)
    after = prior - prior @ h.T @ np.linalg.solve(h @ prior @ h.T + r, h @ prior)
    assert bound(cruise()).sd()[-1] ** 2 == pytest.approx(after[0, 0], rel=1e-6)


def test_more_noise_and_more_gust_cost():
    courses = cruise(5.0)
    quiet = bound(courses).sd()[-1]
    assert bound(courses, NoiseModel(2.7, 2.7, 0.0, walk=3e-5)).sd()[-1] > 1.3 * quiet
    assert bound(courses, gust_sd=1.0).sd()[-1] > 1.5 * quiet
    assert bound(courses, gust_sd=0.05).sd()[-1] == bound(courses, gust_sd=0.2).sd()[-1]  # calm is the floor


def test_lag_costs_what_happens_meanwhile():
    """What is told is predicted over the lag: its variance grows by the gust's, q·Δ, and a little more."""
    courses = cruise(5.0)
    late = NoiseModel(1.2, 1.2, 0.0, walk=3e-5, acceleration_sd=0.01, total_lag=0.02, static_lag=0.02)
    grown = bound(courses, late).sd()[-1] ** 2 - bound(courses).sd()[-1] ** 2
    gust = (2.0 * 0.2**2 * 30.0 / 200.0 + 1.0 / 1000.0) * 0.02
    assert gust < grown < 1.5 * gust


def test_expectations_are_over_flights():
    """Half the flights at rest read nothing of V from p_t: the mean information of E[H²]/R, not (E[H])²/R."""
    half = Information(np.eye(1))
    half.update(np.array([[0.0], [2.0]]), 1.0)
    assert half.matrix[0, 0] == pytest.approx(1.0 + 2.0)


@pytest.mark.parametrize("speed_sd", [1.0, 0.03])
def test_constants_of_a_flight_are_those_of_batch_least_squares(speed_sd):
    """0.3 s of cruise with a share of V and a position error that are constants: the posterior of all at once, to 1e-4.

    Authority: numpy, every reading and every step's noise in one Gaussian, its conditional variance. Where nothing else
    tells V the constants come whole on top; where the start tells it, it tells of them.
    """
    noise = NoiseModel(
        total_sd=1.2, static_sd=1.2, temperature_sd=2.0, static_offset_sd=100.0, walk=3e-5, accelerometer_sd=0.1,
        head=HeadErrors(position_sd=0.01),
    )  # fmt: skip
    n, dt, v, p = 30, 0.01, 30.0, STANDARD_PRESSURE
    told = dt * np.arange(1, n + 1)
    aided = AidedSettings()
    settings = EstimatorSettings(kind="aided", aided=aided)
    start = Start(0.05, 1e-4, speed_sd)
    found = AirspeedBound(cruise(1.0), Schedule(0.0, told, told, told), settings, noise, start).sd()

    heat = SEVEN_R * STANDARD_TEMPERATURE
    y = 1.0 + v**2 / heat
    rho_v, impact = 7.0 * p / heat * v, p * (y**3.5 - 1.0)
    f = np.diag([1.0, 1.0 - dt / aided.bias_time, 1.0, 1.0 - dt / aided.slope_time, 1.0, 1.0, 1.0])
    f[0, 1] = f[0, 3] = -dt
    f[2, 3] = -rho_v * dt
    gust = 2.0 * 0.2**2 * v / aided.gust_length * dt + 0.1**2 / 1000.0 * dt
    q_b, q_s = 2.0 * aided.bias_sd**2 / aided.bias_time * dt, aided.slope_rate**2 * dt
    q = np.diag([gust + q_b * dt**2 / 3.0, q_b, aided.static_walk**2 * dt, q_s, 3e-5**2 * dt, 0.0, 0.0])
    reach = np.array([dt, rho_v * dt])
    q[np.ix_((0, 2), (0, 2))] += q_s / 3.0 * np.outer(reach, reach)
    q[0, 1] = q[1, 0] = -0.5 * dt * q_b
    q[[0, 2], 3] = q[3, [0, 2]] = -0.5 * q_s * reach
    share = 0.5 * np.hypot(2.0 / STANDARD_TEMPERATURE, 100.0 / p)
    prior = np.diag([speed_sd**2, 0.09, AROUND**2, 0.09 + 0.05**2, 1e-8, share**2, 0.01**2])
    prior[1, 3] = prior[3, 1] = -0.09
    h = np.array([[0, 0, 1, 0, 0, 0, impact], [rho_v * y**2.5, 0, y**3.5, 0, 1, rho_v * y**2.5 * v, 0]])

    sources = np.zeros((7, 7 * (n + 1)))  # of the state, in independent deviations of 1
    sources[:, :7] = np.linalg.cholesky(prior)
    roots = np.linalg.cholesky(q[:5, :5])
    rows = []
    for k in range(1, n + 1):
        sources = f @ sources
        sources[:5, 7 * k : 7 * k + 5] = roots
        rows.append(h @ sources)
    a = np.concatenate(rows)
    tied = sources[0] @ a.T
    left = sources[0] @ sources[0] - tied @ np.linalg.solve(a @ a.T + 1.44 * np.eye(2 * n), tied)
    assert found[-1] == pytest.approx(np.sqrt(left), rel=1e-4)
    unseen = v * np.hypot(share, 0.5 * 0.01)
    if speed_sd == 1.0:
        assert found[-1] > 0.98 * unseen
    else:
        assert found[-1] < 0.5 * unseen


def test_a_wind_across_the_rail_goes_into_the_airspeed_and_its_error_stays_with_the_open_tare():
    """10 ± 1 m/s across, a push to 24 m/s along. By hand: ½ρw² of the tare is off by ρ w σ, V in cruise by w σ/V.

    Under a cover the tared pair reads the wind itself, and nothing of it is left.
    """
    t = np.arange(-0.3, 4.0, 0.002)
    pushed = np.where((t > 0.0) & (t < 0.3), 80.0, 0.0)
    along = np.clip(80.0 * t, 0.0, 24.0)
    speed = np.hypot(along, 10.0)
    shape = (2, t.size)
    one = {"airspeed": speed, "slope": 0.0 * t, "static": np.full(t.size, STANDARD_PRESSURE), "force": pushed}
    courses = Courses(
        t, *(np.broadcast_to(column, shape) for column in one.values()), STANDARD_TEMPERATURE,
        np.broadcast_to(along, shape),
    )  # fmt: skip
    told = np.arange(-29, 390) / 100.0
    settings = EstimatorSettings(kind="aided", aided=AidedSettings(rail_wind_side=10.0, rail_wind_sd=1.0))

    def at_the_end(difference_sd):
        start = Start(0.05, difference_sd, 1.0, 0.2)
        return AirspeedBound(courses, Schedule(-0.295, told, told, told), settings, NOISE, start).sd()

    opened, covered = at_the_end(80.0), at_the_end(0.1)
    assert opened[25] == pytest.approx(1.0, rel=0.05)  # on the rail: V is w, as well as that is declared
    assert opened[-1] == pytest.approx(10.0 * 1.0 / 26.0, rel=0.05)
    assert covered[-1] < 0.05
