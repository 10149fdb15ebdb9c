"""The generated model against derivatives by complex steps, and its one pass against three."""

import ast
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from references.gaussian import NAMES, MatrixFilter

import uavsim
from uavsim.onboard.airspeed import EnergyFilter
from uavsim.onboard.airspeed.energy import SEVEN_R
from uavsim.onboard.airspeed.energy_model import (
    GATE,
    RAIL_SHARE,
    covariance_at_rest,
    isentropic,
    isentropic_speed,
    process_noise,
    static_slopes,
    step,
    total_pressure,
    total_slopes,
    transition,
)

HEAT = SEVEN_R * 288.15
STATE = [*"vbpsd", "vv", "vb", "vp", "vs", "vd", "bb", "bp", "bs", "bd", "pp", "ps", "pd", "ss", "sd", "dd"]
PUSHED = ["vk", "bk", "pk", "sk", "dk", "kk"]
TINY = 1e-30  # complex step: no difference is taken, so nothing is lost
UNEQUAL = {
    "speed_sd": 1.1, "rest_force": 2.5, "rest_sd": 0.05, "bias_sd": 0.31, "bias_time": 5.3, "slope_rate": 0.7,
    "slope_time": 4.1, "static": 101_325.0, "static_sd": 10.0, "static_walk": 0.33, "difference_sd": 0.2,
    "difference_walk": 0.013, "acceleration_sd": 0.06,
}  # fmt: skip


def filled(entries, start):
    for where, value in entries.items():
        start[where] = value
    return start


def full(entries):
    row = np.zeros(6)
    for state, slope in entries.items():
        row[state] = slope
    return row


def arbitrary(seed):
    """A filter in any state, its covariance without an entry that is 0 or equals another."""
    generator = np.random.default_rng(seed)
    f = MatrixFilter(**UNEQUAL)
    root = generator.normal(size=(6, 6)) * np.array([0.3, 0.2, 3.0, 0.4, 0.5, 0.05])[:, None]
    f.put(np.array([31.7, 0.23, 99_871.0, 1.3, 0.9, -0.04]), root @ root.T)
    return f


def test_transition_is_the_derivative_of_the_step():
    """Complex steps, 1e-12. F takes the airspeed of the middle for known: what that leaves out of ṗ is ρ s dt²/2."""
    x, dt, rho, keep, stay = np.array([31.7, 0.23, 99_871.0, 1.3]), 0.013, 1.17, 0.97, 0.95
    jacobian = np.empty((4, 4))
    for j in range(4):
        moved = x.astype(complex)
        moved[j] += 1j * TINY
        found = step(*moved, dt=dt, gained=0.21, density=rho, keep=keep, stay=stay)
        jacobian[:, j] = [part.imag / TINY for part in found]
    jacobian[2, [1, 3]] -= 0.5 * rho * x[3] * dt**2
    middle = x[0] + 0.5 * (0.21 - dt * (x[1] + x[3]))
    f = filled(transition(x[3], middle, density=rho, dt=dt, keep=keep, stay=stay), np.eye(6))
    np.testing.assert_allclose(f[:4, :4], jacobian, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(f[4:], np.eye(6)[4:])
    np.testing.assert_array_equal(f[:, 4:], np.eye(6)[:, 4:])


def test_noise_is_the_integral_of_what_the_step_carries_on():
    """Q = ∫ Φ W Φᵀ with Φ from `transition` in level flight, by Gauss and Legendre, exact for cubes; 1e-12."""
    dt, rho, v = 0.013, 1.17, 31.7
    gained = np.array([3e-4, 2e-4, 1e-3, 7e-3, 2e-6, 0.0])
    nodes, weights = leggauss(4)
    wanted = np.zeros((6, 6))
    for node, weight in zip(0.5 * dt * (nodes + 1.0), 0.5 * dt * weights, strict=True):
        phi = filled(transition(0.0, v, density=rho, dt=node, keep=1.0, stay=1.0), np.eye(6))
        wanted += weight * phi @ np.diag(gained / dt) @ phi.T
    variance, bias, walk, slope, drift, _ = gained
    found = process_noise(-rho * v * dt, dt=dt, variance=variance, bias=bias, slope=slope, walk=walk, drift=drift)
    np.testing.assert_allclose(filled(found, np.zeros((6, 6))), wanted, rtol=1e-12, atol=1e-18)


def test_slopes_are_derivatives_of_the_total_pressure():
    """Complex steps, 1e-12, at low speed and at Mach 0.6."""
    for v in (3.1, 31.7, 204.0):
        x, slopes = np.array([v, 0.23, 99_871.0, 1.3, 0.9, -0.04]), []
        for j in range(6):
            moved = x.astype(complex)
            moved[j] += 1j * TINY
            slopes.append(total_pressure(*moved[[0, 2, 4, 5]], pushed=37.0, heat=HEAT).imag / TINY)
        np.testing.assert_allclose(full(total_slopes(v, x[2], pushed=37.0, heat=HEAT)), slopes, rtol=1e-12)


def test_functions_take_arrays():
    """Element by element what floats give."""
    v, p, s = np.array([3.1, 31.7]), np.array([99_871.0, 90_000.0]), np.array([1.3, -0.4])
    for i in range(2):
        for function, arrays, floats in (
            (total_slopes, (v, p), (v[i], p[i])),
            (static_slopes, (s,), (s[i],)),
        ):
            more = {"pushed": 37.0, "heat": HEAT} if function is total_slopes else {}
            many, one = function(*arrays, **more), function(*floats, **more)
            assert {k: np.broadcast_to(x, 2)[i] for k, x in many.items()} == pytest.approx(one, rel=1e-15)
        many = transition(s, v, density=p / 9e4, dt=0.013, keep=0.97, stay=0.95)
        one = transition(s[i], v[i], density=p[i] / 9e4, dt=0.013, keep=0.97, stay=0.95)
        assert {k: np.broadcast_to(x, 2)[i] for k, x in many.items()} == pytest.approx(one, rel=1e-15)


@pytest.mark.parametrize("railed", [True, False])
def test_prediction_is_that_of_the_matrices(railed):
    """F P Fᵀ + Q and f of the model's own functions; 1e-12 of each entry's scale."""
    f = arbitrary(1)
    (x, p), dt, gained, rho = f.gaussian(), 0.013, 0.21, 1.17
    matrix = f.jacobian(dt, gained, rho, railed)
    keep, stay = f.shares(dt, railed)
    share = RAIL_SHARE if railed else 1.0
    noise = filled(
        process_noise(
            matrix[2, 3], dt=dt, variance=3e-4, bias=share * 2.0 * 0.31**2 / 5.3 * dt, slope=share * 0.7**2 * dt,
            walk=0.33**2 * dt, drift=0.013**2 * dt,
        ),
        np.zeros((6, 6)),
    )  # fmt: skip
    if railed:  # what b and s gain there makes nothing of v and p
        noise = np.diag([3e-4, *np.diag(noise)[1:2], 0.33**2 * dt, *np.diag(noise)[3:]])
    f.predict(dt, gained, 3e-4, rho, railed)
    after, spread = f.gaussian()
    np.testing.assert_allclose(
        after, [*step(*x[:4], dt=dt, gained=gained, density=rho, keep=keep, stay=stay), *x[4:]], rtol=1e-14
    )
    wanted = matrix @ p @ matrix.T + noise
    scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    np.testing.assert_allclose(spread / scale, wanted / scale, atol=1e-12)


def test_updates_are_those_of_the_matrices():
    """Kalman's with h of the model's own functions, both readings with every state correlated; 1e-9."""
    for name in ("static", "total"):
        f = arbitrary(2)
        x, p = f.gaussian()
        p[0] *= 0.01  # so that h is straight over what is not known of v
        p[:, 0] *= 0.01
        f.put(x, p)
        if name == "static":
            h, expected, bend = full(static_slopes(0.7)), x[2] + 0.7 * x[3], 0.0
            nis = f.static(expected + 1.7, 2.9, 0.7)
        else:
            h = full(total_slopes(x[0], x[2], pushed=37.0, heat=HEAT))
            bend = h[0] / x[0] * p[0, 0]
            expected = total_pressure(x[0], x[2], x[4], x[5], pushed=37.0, heat=HEAT) + 0.5 * bend
            nis = f.total(expected + 1.7, 2.9, 37.0, HEAT)
        spread = h @ p @ h + 2.9 + 0.5 * bend**2
        gain = p @ h / spread
        after, left = f.gaussian()
        assert nis == pytest.approx(1.7**2 / spread, rel=1e-8)
        np.testing.assert_allclose(after, x + gain * 1.7, rtol=1e-9)
        np.testing.assert_allclose(left, p - np.outer(gain, h @ p), rtol=1e-9, atol=1e-12)


def test_bent_update_is_the_iterated_one_of_the_matrices():
    """Near rest, all correlated, pushed: Gauss-Newton with matrices, four turns (Bell & Cathey 1993); 1e-9."""
    f = arbitrary(5)
    x, p = f.gaussian()
    x[0] = 4.0
    p[0] *= 3.0
    p[:, 0] *= 3.0
    f.put(x, p)
    x, p = f.gaussian()
    reading, variance, pushed = total_pressure(5.1, *x[[2, 4, 5]], pushed=37.0, heat=HEAT), 2.9, 37.0
    at = x.copy()
    for _ in range(4):
        h = full(total_slopes(at[0], at[2], pushed=pushed, heat=HEAT))
        spread = h @ p @ h + variance
        innovation = reading - total_pressure(*at[[0, 2]], *x[[4, 5]], pushed=pushed, heat=HEAT)
        innovation -= h[0] * (x[0] - at[0]) + h[2] * (x[2] - at[2])
        left = p[0, 0] - (p @ h)[0] ** 2 / spread
        bend = h[0] / at[0] * left
        spread, innovation = spread + 0.5 * bend**2, innovation - 0.5 * bend
        at = x + p @ h / spread * innovation
    before = 7.0 * x[2] / HEAT * p[0, 0]
    assert before**2 > 0.01 * variance  # it is bent
    f.total(reading, variance, pushed, HEAT)
    after, found = f.gaussian()
    assert f.taken
    np.testing.assert_allclose(after, at, rtol=1e-9)
    np.testing.assert_allclose(found, p - np.outer(p @ h, h @ p) / spread, rtol=1e-7, atol=1e-10)


def test_a_spike_near_rest_is_left_out():
    """Beyond the gate nothing changes; told are the innovation with its second-order part, and NIS by both."""
    f = MatrixFilter(**UNEQUAL)
    bend = 7.0 * f.p / HEAT * f.vv
    expected, spread = f.p + 0.5 * bend, f.pp + f.dd + 2.9 + 0.5 * bend**2
    before = f.gaussian()
    nis = f.total(expected + 200.0, 2.9, 0.0, HEAT)
    assert bend**2 > 0.01 * 2.9
    assert not f.taken
    assert (f.innovation, nis) == pytest.approx((200.0, 200.0**2 / spread), rel=1e-9)
    for one, other in zip(before, f.gaussian(), strict=True):
        np.testing.assert_array_equal(one, other)


def test_start_knows_the_sum_of_bias_and_slope():
    """At rest f_x reads b + s: its variance is rest_sd², that of b alone bias_sd²; both are not independent of s."""
    known = filled(
        covariance_at_rest(
            speed_sd=1.1, bias_sd=0.31, static_sd=10.0, rest_sd=0.05, difference_sd=0.2, acceleration_sd=0.06
        ),
        np.zeros((6, 6)),
    )
    total = np.array([0.0, 1.0, 0.0, 1.0, 0.0, 0.0])
    assert total @ known @ total == pytest.approx(0.05**2, rel=1e-12)
    np.testing.assert_allclose(np.diag(known), [1.21, 0.0961, 100.0, 0.0961 + 0.0025, 0.04, 0.0036])
    np.testing.assert_array_equal(MatrixFilter(**UNEQUAL).gaussian()[1], known)
    assert len(NAMES) == 21


def pair(speed):
    """Both as a launch leaves them: k and all else correlated."""
    cores = []
    for core in (MatrixFilter, EnergyFilter):
        f = core(**UNEQUAL)
        f.v = speed
        f.predict(0.01, 0.05, 1e-3, 1.2, False)
        f.static(101_320.0, 7.0, 0.1)
        f.total(101_325.0 * (1.0 + speed * speed / HEAT) ** 3.5, 7.0, 40.0, HEAT)
        cores.append(f)
    return cores


def test_know_push_leaves_nothing_of_k_but_its_value():
    f, _ = pair(30.0)
    k, variance = f.k, f.kk
    assert variance > 0.0
    assert any(getattr(f, name) for name in PUSHED[:5])
    assert f.know_push() == variance
    assert f.k == k
    assert [getattr(f, name) for name in PUSHED] == [0.0] * 6
    assert f.know_push() == 0.0


@pytest.mark.parametrize("speed", [0.5, 3.0, 32.0, 204.0])
def test_one_pass_equals_the_three_calls(speed):
    """400 rows, some beyond the gate, from rest, where h bends, to Mach 0.6; state and covariance to 1e-9."""
    three, one = pair(speed)
    generator = np.random.default_rng(round(speed))
    beyond = 0
    for f in (three, one):
        f.know_push()
        f.hold_difference()
    for k in range(400):
        dt, gained, ahead = generator.uniform(0.004, 0.012), generator.normal(0.0, 0.02), generator.normal(0.0, 0.2)
        spike = 100.0 if k % 50 == 49 else 0.0
        static = three.p + generator.normal(0.0, 2.0) + spike * (k % 100 == 49)
        total = three.p * (1.0 + three.v**2 / HEAT) ** 3.5 + generator.normal(0.0, 2.0) + spike * (k % 100 == 99)
        row = (dt, gained, 3e-4, 1.2, static, 4.0, ahead, total, 4.0, HEAT)
        expected = three.fly(*row)
        assert one.fly(*row) == pytest.approx(expected, rel=1e-6, abs=1e-9)
        beyond += max(expected) > GATE
        for name in STATE:
            scale = abs(getattr(three, name)) + 1e-9
            assert abs(getattr(one, name) - getattr(three, name)) <= 1e-9 * scale + 1e-12, (k, name)
    assert beyond >= 8 * (speed > 10.0)
    assert [getattr(one, name) for name in PUSHED] == [0.0] * 6


def written_to(path):
    """Names of the attributes of other objects than itself that a module assigns to."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        for target in targets if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign) else ():
            for part in ast.walk(target):
                if isinstance(part, ast.Attribute) and getattr(part.value, "id", "") != "self":
                    yield part.attr


def test_state_and_covariance_change_only_in_the_filter(tmp_path):
    """Whoever else knows something tells it by a method of `EnergyFilter`; the numbers are its own."""
    own = {*NAMES.values(), *"vbpsdk"}
    package = Path(uavsim.__file__).parent
    for path in package.rglob("*.py"):
        assert not own & set(written_to(path)), path
    for text in ("energy.vv += 1.0", "self.energy.bb = 0.0", "a, core.bs = 1.0, 0.0"):  # it would be seen
        (tmp_path / "one.py").write_text(text)
        assert own & set(written_to(tmp_path / "one.py"))


def test_what_the_filter_is_told_is_what_changes():
    """Each of the short methods changes the numbers that it names and no other."""
    for method, arguments, changed in (
        ("shift_speed", (-3.0,), {"v": -3.0}),
        ("widen_speed", (0.7,), {"vv": 0.7}),
        ("widen_bias", (0.7,), {"bb": 0.7}),
        ("widen_static", (0.7,), {"pp": 0.7}),
    ):
        f, before = arbitrary(3), arbitrary(3)
        getattr(f, method)(*arguments)
        for name in (*NAMES.values(), *"vbpsdk"):
            assert getattr(f, name) == getattr(before, name) + changed.get(name, 0.0), (method, name)
    f = arbitrary(3)
    f.leave_rail(0.9)
    assert (f.bs, f.ss) == (0.0, 0.9)


def test_foretelling_is_a_prediction_without_noise():
    """Airspeed and its variance are those of `predict` with no noise; nothing of the filter changes."""
    f, ahead = arbitrary(4), arbitrary(4)
    v, variance, p = f.foretell(0.013, 0.21, 1.17)
    np.testing.assert_array_equal(np.column_stack(f.gaussian()), np.column_stack(arbitrary(4).gaussian()))
    ahead.predict(0.013, 0.21, 0.0, 1.17, True)
    assert (v, variance) == pytest.approx((ahead.v, ahead.vv), rel=1e-13)
    assert p == pytest.approx(f.p - 1.17 * f.v * f.s * 0.013, rel=1e-15)


def test_isentropic_and_its_inverse():
    """Liepmann & Roshko, table III: p/p₀ = 0.7840 at M = 0.6, to its four digits; there and back 1e-12."""
    v = 0.6 * (HEAT / 5.0) ** 0.5  # 7 R T/5 = γ R T
    assert 1.0 / isentropic(v, 1.0, HEAT) == pytest.approx(0.7840, abs=5e-5)
    assert isentropic_speed(isentropic(v, 1.0, HEAT) - 1.0, HEAT) == pytest.approx(v, rel=1e-12)
    assert isentropic(31.7, 99_871.0, HEAT) == pytest.approx(
        total_pressure(31.7, 99_871.0, 0.0, 0.0, pushed=0.0, heat=HEAT), rel=1e-15
    )
