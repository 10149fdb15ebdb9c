"""The wind on the rail, the head's known errors, and where the air comes from: figures by hand.

Authority: V² = u² + c²; the posterior of two Gaussian numbers by one reading that is nearly linear in both; the lift
curve α = a n/(ρ V²) + α₀.
"""

import math

import numpy as np
import pytest

from sensors.probe import static_port, total_port
from sensors.settings import StaticPortSettings, TotalPortSettings
from uavsim.onboard.airspeed import AidedFilter, AidedSettings, EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.flow_angles import FOLDED, FlowAngles
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.airspeed.rail_wind import RailWind

STATIC, TEMPERATURE = 101_325.0, 288.15
HEAT = 7.0 * 287.0528 * TEMPERATURE
DENSITY = STATIC / (287.0528 * TEMPERATURE)
TUBE = HeadErrors(
    limit=math.radians(20.0), error=0.02, error_alpha=0.1, error_alpha2=-0.55, error_beta2=-0.5, error_mach2=0.3,
    total_slipstream=0.2, static_slipstream=0.4,
)  # fmt: skip


def impact(speed: float) -> float:
    return STATIC * ((1.0 + speed * speed / HEAT) ** 3.5 - 1.0)


@pytest.mark.parametrize(("alpha", "beta"), [(0.0, 0.0), (0.1, -0.05), (0.3, 0.2), (-0.4, 1.2), (2.8, 0.1)])
def test_the_law_on_board_is_that_of_the_simulated_head(alpha: float, beta: float) -> None:
    total = total_port(TotalPortSettings(probe="plain", slipstream=0.2))
    static = static_port(StaticPortSettings(0.02, 0.1, -0.55, -0.5, 0.3, slipstream=0.4))
    assert total is not None
    assert static is not None
    air = (STATIC + 600.0, STATIC, 0.3, alpha, beta, 0.5)
    found = TUBE.shares(math.cos(alpha) * math.cos(beta), math.sin(beta), math.sin(alpha) * math.cos(beta), 0.09, 0.5)
    assert found == pytest.approx(((total(*air) - STATIC) / 600.0, (static(*air) - STATIC) / 600.0))


def test_what_a_calibration_leaves_is_a_share_of_the_impact_pressure() -> None:
    left = HeadErrors(error_beta2=-0.5, position_sd=3e-3, beta2_sd=0.1, alpha_sd=0.05)
    assert left.spread(0.0, 0.0, 0.0, 0.0) == 3e-3
    assert left.spread(0.04, 0.01, 0.1, 0.0) == pytest.approx(math.hypot(3e-3, 0.1 * 0.04, 0.5 * 0.01, 0.05 * 0.1))


def wind(along: float = 0.0, side: float = 0.0, sd: float = 1.0, head: HeadErrors | None = None) -> RailWind:
    declared = AidedSettings(rail_wind_along=along, rail_wind_side=side, rail_wind_sd=sd)
    return RailWind(declared, HeadErrors() if head is None else head)


def begin(of: RailWind, seen: tuple[float, float] | None, tared: bool) -> tuple[float, float, float, float]:
    return of.begin(seen, tared=tared, air=(STATIC, HEAT, 0.0))


def test_a_tared_pair_corrects_the_wind_that_is_declared() -> None:
    """10 m/s declared from ahead, 11 read to 1 Pa: V is 11 to σ/(ρ w) = 0.1 m/s; from the side V is, not u₀.

    Of u₀ what the wind across is not known by is off, too: c² = 1 ± √2 m²/s² make 1/22 ± √2/22 m/s.
    """
    ahead = wind(along=10.0)
    along, sd, *_ = begin(ahead, (impact(11.0), 1.0), tared=True)
    assert ahead.told(along, sd * sd)[0] == pytest.approx(11.0, abs=0.02)
    assert along == pytest.approx(11.0 - 1.0 / 22.0, abs=0.02)
    assert sd == pytest.approx(math.hypot(1.0 / (DENSITY * 11.0), math.sqrt(2.0) / 22.0), rel=0.05)
    across = wind(side=10.0)
    along, sd, *_ = begin(across, (impact(11.0), 1.0), tared=True)
    assert (along, sd) == (pytest.approx(0.0, abs=5e-3), pytest.approx(1.0, rel=5e-3))
    assert across.told(along, sd * sd)[0] == pytest.approx(11.0, abs=0.02)


def test_what_a_pair_reads_at_rest_is_known_though_the_wind_is_not() -> None:
    """10 m/s from ahead, known to 1 m/s, of a pair that reads 5 Pa more: the sum is known but for the wind across."""
    along, sd, off, variance = begin(wind(along=10.0), (impact(10.0) + 5.0, 0.5), tared=False)
    assert (along, sd) == (10.0, 1.0)
    assert off == pytest.approx(impact(10.0) + 5.0)
    assert variance == pytest.approx(0.5 + (0.5 * DENSITY) ** 2 * 2.0, rel=0.02)  # c² = 1 ± √2 m²/s²


def test_the_push_finds_the_tare_that_the_wind_has_hidden() -> None:
    """Tared in a wind that is declared as 6 ± 1.7 m/s, quiet parts: d by the end of the push within its bar.

    From 2.6 to 9.4 m/s; of filters that have d and u₀ for states those at the ends are 5 standard deviations off.
    """
    for miss in (-2.0, -1.0, 0.0, 1.0, 2.0):
        generator = np.random.default_rng(round(10 + miss))
        u0 = 6.0 + 1.7 * miss
        settings = EstimatorSettings(aided=AidedSettings(rail_wind_along=6.0, rail_wind_sd=1.7, unfolding_rate=0.0))
        noise = NoiseModel(0.1, 0.1, 0.0, accelerometer_sd=0.1, accelerometer_rate=200.0, covered=False)
        estimator, gained, before = AidedFilter(settings, noise, (0.5, 1.5)), 0.0, 0.0
        for k in range(481):
            t = k * 5e-3
            force = 80.0 if 1.999 < t < 2.299 else 0.0
            gained, before = gained + 0.5 * (before + force) * 5e-3, force
            estimator.accelerometer(t, force + 0.1 * generator.standard_normal(), 0.0, -9.6)
            if k == 408:
                estimator.launched(t)
            if k % 2 == 0:
                a, b = 0.1 * generator.standard_normal(2)
                estimator.step(t, STATIC + 20.0 + impact(u0 + gained) + a, STATIC + b, TEMPERATURE, t, t)
        off = estimator._corrections.tare + estimator.energy.d - 20.0
        assert abs(off) < 3.0 * math.sqrt(estimator.energy.dd), miss
        assert math.sqrt(estimator.energy.dd) < 6.0  # by the declared wind alone ρ u₀ σ, 12.5 Pa
        assert not estimator.energy.learns


@pytest.mark.parametrize(("along", "side"), [(0.0, 9.0), (-7.0, 0.0), (9.0, 0.0), (5.0, -6.0)])
def test_a_stroke_through_a_wind_from_any_side_ends_with_its_airspeed(along: float, side: float) -> None:
    """80 m/s² for 0.3 s in a declared wind; noise of 1 Pa, 40 strokes: within 4 σ, NEES about 1."""
    sd, errors = 0.7, []
    for seed in range(40):
        generator = np.random.default_rng(seed)
        u0, c = along + sd * generator.standard_normal(), side + sd * generator.standard_normal()
        settings = EstimatorSettings(
            aided=AidedSettings(rail_wind_along=along, rail_wind_side=side, rail_wind_sd=sd, unfolding_rate=0.0)
        )
        noise = NoiseModel(1.0, 1.0, 0.0, accelerometer_sd=0.1, accelerometer_rate=200.0, covered=True)
        estimator, estimate = AidedFilter(settings, noise, (0.5, 1.5)), None
        for k in range(461):
            t = k * 5e-3
            estimator.accelerometer(t, (80.0 if t > 2.0 else 0.0) + 0.1 * generator.standard_normal(), 0.0, -9.6)
            if k == 408:
                estimator.launched(t)
            speed = 0.0 if t <= 1.5 else math.hypot(u0 + 80.0 * max(t - 2.0, 0.0), c)
            if k % 2 == 0:
                a, b = generator.standard_normal(2)
                estimate = estimator.step(t, STATIC + impact(speed) + a, STATIC + b, TEMPERATURE, t, t)
        assert estimate is not None
        assert estimator.news == []
        errors.append((estimate[1] - speed) / estimate[2])
    assert np.abs(errors).max() < 4.0
    assert 0.3 < np.mean(np.square(errors)) < 2.0


def test_the_swing_of_the_first_seconds_dies_away() -> None:
    angles = FlowAngles(AidedSettings(lift_slope=9.45, lift_zero=-0.0695))
    angles.leave(2.0, 0.3)
    first, later = angles.side(2.0, 25.0)[0], angles.side(3.5, 25.0)[0]
    assert first == pytest.approx(0.09, rel=0.02)
    assert later == pytest.approx(0.09 * math.exp(-2.0), rel=0.02)
    assert angles.side(20.0, 25.0)[0] == pytest.approx(1e-4)


def test_lift_tells_the_angle_of_attack_once_the_wings_are_out() -> None:
    """9.45 · 9.81/(1.225 · 625) − 0.0695 = 0.0516 rad at 25 m/s in level flight."""
    angles = FlowAngles(AidedSettings(lift_slope=9.45, lift_zero=-0.0695))
    assert angles.down(25.0, 1.225) == FOLDED
    angles.lift = 9.81
    assert angles.down(25.0, 1.225)[0] == pytest.approx(0.0516, abs=2e-4)
    assert angles.down(12.0, 1.225)[0] == 0.35  # no wing lifts so


# -- where a filter begins ---------------------------------------------------------------------------------------------


def begun(force: float, speed: float, tare: tuple[float, float] | None, rest: float) -> AidedFilter:
    """Told of a launch after a rest of so long, s; then two tenths of a second of a force, m/s², at an airspeed."""
    noise = NoiseModel(1.0, 1.0, 0.0, accelerometer_sd=0.1, accelerometer_rate=200.0, difference_sd=50.0)
    estimator = AidedFilter(EstimatorSettings(), noise, tare)
    for k in range(round(200 * (rest + 0.2))):
        t = k * 5e-3
        moving = t >= rest
        estimator.accelerometer(t, force if moving else 2.0, 0.0, -9.6)
        total = STATIC + (impact(speed + force * (t - rest)) if moving else 0.0)
        estimator.step(t, total, STATIC, TEMPERATURE, t, t)
        if t >= rest + 0.05 and not estimator.flying:
            estimator.launched(t)
    return estimator


def test_a_log_that_begins_in_a_push_or_in_flight_has_the_airspeed_of_its_pressures() -> None:
    """With an untared pair: known to 50 Pa/(ρ V), 1 m/s at 40 m/s."""
    pushed, flown = begun(60.0, 40.0, None, 0.0), begun(0.0, 40.0, None, 0.0)
    assert pushed.energy.v == pytest.approx(52.0, abs=1.0)
    assert flown.energy.v == pytest.approx(40.0, abs=0.5)
    assert 0.5 < math.sqrt(flown.energy.vv) < 1.5


def test_a_launch_from_the_rail_begins_there() -> None:
    estimator = begun(80.0, 0.0, (0.5, 1.5), 2.0)
    assert estimator.energy.v == pytest.approx(80.0 * 0.2, abs=1.0)
    assert estimator.energy.s == pytest.approx(2.0, abs=0.1)  # what f_x reads on the rail
