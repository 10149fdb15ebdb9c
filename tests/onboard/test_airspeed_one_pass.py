"""The core's one pass of steady flight against the three calls that it stands for."""

import numpy as np
import pytest

from uavsim.onboard.airspeed.energy import GATE, SEVEN_R, EnergyFilter
from uavsim.onboard.airspeed.one_pass import OnePassFilter

HEAT = SEVEN_R * 288.15
STATE = [*"vbpsd", "vv", "vb", "vp", "vs", "vd", "bb", "bp", "bs", "bd", "pp", "ps", "pd", "ss", "sd", "dd"]
PUSHED = ["vk", "bk", "pk", "sk", "dk", "kk"]


def pair(speed):
    """Both cores as a launch leaves them: k and all else correlated."""
    cores = []
    for core in (EnergyFilter, OnePassFilter):
        f = core(
            speed_sd=1.0, rest_force=2.5, rest_sd=0.05, bias_sd=0.3, bias_time=5.0, slope_rate=0.7, slope_time=4.0,
            static=101_325.0, static_sd=10.0, static_walk=0.3, difference_sd=0.2, difference_walk=0.01,
            acceleration_sd=0.06,
        )  # fmt: skip
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
