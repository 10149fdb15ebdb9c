"""The error budget: each cause by its law, all of them by drawing readings and asking what airspeed they give."""

from dataclasses import replace
from math import exp, hypot, sqrt

import numpy as np
import pytest

from sensors import known_of_head
from sensors.settings import AirDataSettings, PressureSettings, StaticPortSettings, ThermalSettings, TubeSettings
from uavsim import airdata
from uavsim.scenario import load_scenario
from uavsim.studies.error_budget import TERMS, Conditions, budget, of_scenario
from uavsim.views.error_budget import draw

HIGH = Conditions(static=70_000.0, temperature=260.0)
HEAD = AirDataSettings()


def pair(preset: str, **settings: object) -> AirDataSettings:
    return replace(HEAD, total=PressureSettings(preset=preset), static=PressureSettings(preset=preset), **settings)


@pytest.mark.parametrize("preset", ["bmp390", "bmp280"])
def test_noise_tare_and_thermometer_are_what_drawn_readings_have(preset: str) -> None:
    """Monte Carlo: 200 000 readings of both sensors, the tare's error and the thermometer's; tolerance 1 %."""
    air, c = pair(preset), HIGH
    part = air.total.description()
    found = budget(air, c, (15.0, 30.0, 60.0))
    rng = np.random.default_rng(20261129)
    n = 200_000
    count = air.tare_duration * min(air.rate, part.rate)
    tare = rng.normal(0.0, part.noise_sd * sqrt(2.0 / count), n)
    warm = hypot(part.temperature_noise_sd, part.temperature_offset_sd)
    for i, speed in enumerate(found.speeds):
        total = airdata.total_at_airspeed(airspeed=float(speed), static=c.static, temperature=c.temperature)
        read = airdata.airspeed(
            total=total + rng.normal(0.0, part.noise_sd, n) + tare,
            static=c.static + rng.normal(0.0, part.noise_sd, n),
            temperature=c.temperature + rng.normal(0.0, warm, n),
        )
        expected = hypot(*(found.terms[name][i] for name in ("noise", "tare", "thermometer")))
        assert read.std() == pytest.approx(expected, rel=0.01)


def test_each_cause_follows_its_law_over_the_speed() -> None:
    """A pressure error falls as 1/(ρ_t V), a share of q_c and the thermometer grow as V, the lag in a push stays."""
    air = pair(
        "bmp390",
        static_port=StaticPortSettings(error=0.02),
        calibration="none",
        pipe=0.3,
        acceleration_sensitivity=True,
    )
    c = replace(HIGH, climb=0.0)
    found = budget(air, c, (20.0, 40.0))
    part = air.total.description()
    density = c.static / (287.05287 * c.temperature)
    at = {name: sd[0] for name, sd in found.terms.items()}
    ratio = {name: sd[1] / sd[0] for name, sd in found.terms.items()}
    for name in ("noise", "tare", "drift", "warming", "force"):
        assert ratio[name] == pytest.approx(0.5, rel=0.01), name
    for name in ("position", "thermometer"):
        assert ratio[name] == pytest.approx(2.0, rel=0.01), name
    assert ratio["lag"] == pytest.approx(1.0, rel=0.01)
    assert at["noise"] == pytest.approx(sqrt(2.0) * part.noise_sd / (density * 20.0), rel=0.01)
    left = hypot(0.02, HEAD.static_port.error_mach2 * 0.3**2)
    assert at["position"] == pytest.approx(left * 20.0 / 2.0, rel=0.01)  # δV/V = ½ δq/q
    assert at["drift"] == pytest.approx(part.walk * sqrt(2.0 * 60.0) / (density * 20.0), rel=0.01)
    assert at["warming"] == pytest.approx(part.offset_tc_sd * sqrt(2.0) / (density * 20.0), rel=0.01)
    lag = found.terms["lag"][0]
    assert lag > c.acceleration * 0.5 * part.mode.conversion_time  # the tube's share on top
    plain = budget(pair("bmp390"), c, (20.0,))
    assert plain.terms["lag"][0] == pytest.approx(0.5 * part.mode.conversion_time, rel=0.01)
    assert plain.terms["position"][0] < 0.1 * at["position"]  # a calibration has found all but a thousandth of q
    assert plain.terms["force"][0] == 0.0
    assert found.total[0] == pytest.approx(hypot(*at.values()))


def test_a_climb_is_felt_by_the_difference_of_the_ages() -> None:
    """6 m/s through 70 kPa at 260 K, 9.2 Pa/m: both alike are no error, a tube on one side is."""
    c = replace(HIGH, acceleration=0.0, climb=6.0)
    assert budget(pair("bmp390"), c, (30.0,)).terms["lag"][0] == 0.0
    tube = StaticPortSettings(tube=TubeSettings(length=2.0, diameter=1e-3))
    found = budget(pair("bmp390", static_port=tube), c, (30.0,)).terms["lag"][0]
    age = known_of_head(pair("bmp390", static_port=tube)).static.lag
    assert found == pytest.approx(9.80665 * 6.0 * age / 30.0, rel=0.01)  # ρ g c Δt over ρ V


def test_what_the_tare_leaves_depends_on_how_it_is_taken() -> None:
    part = HEAD.total.description()
    covered, wind, none = (
        budget(pair("bmp390", tare=tare), HIGH, (40.0,)).terms["tare"][0] for tare in ("covered", "open", "none")
    )
    density = HIGH.static / (287.05287 * HIGH.temperature)
    assert wind == pytest.approx(hypot(covered, 0.5 * 3.0**2 / 40.0), rel=0.01)
    assert none == pytest.approx(known_of_head(pair("bmp390", tare="none")).difference_sd / (density * 40.0), rel=0.05)
    assert none * density * 40.0 > sqrt(2.0) * part.offset_sd


def test_a_part_that_is_tared_cold_goes_on_warming() -> None:
    cold = pair("bmp280", thermal=ThermalSettings(self_heating=6.0, lag=30.0, powered_for=15.0))
    warm = pair("bmp280", thermal=ThermalSettings(self_heating=6.0, lag=30.0, powered_for=600.0))
    sd = [budget(air, HIGH, (30.0,)).terms["warming"][0] for air in (cold, warm)]
    assert sd[0] / sd[1] == pytest.approx(hypot(6.0 * exp(-0.5), 1.0), rel=1e-6)


def test_below_v_star_the_slope_of_the_root_is_stopped() -> None:
    """An untared pair: at rest the error of the airspeed is V*-like and finite, not σ/(ρ V) without bound."""
    found = budget(pair("bmp390", tare="none"), HIGH, (0.5, 5.0))
    assert found.total[0] == pytest.approx(found.total[1], rel=0.05)


def test_a_scenarios_budget_is_in_the_air_of_its_place_and_can_be_drawn() -> None:
    found = of_scenario(load_scenario("high-field"))
    assert found.conditions.static == pytest.approx(68_800.0, rel=0.01)
    assert tuple(found.terms) == TERMS
    figure = draw(found)
    drawn = {str(line.get_label()) for line in figure.axes[0].lines}
    assert {"noise", "tare", "all"} <= drawn
    assert "force" not in drawn  # there is none
