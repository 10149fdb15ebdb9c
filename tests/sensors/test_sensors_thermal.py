"""Temperature of a die: its differential equation, and what happens before the first look and without a number."""

from math import isnan, nan

import numpy as np
import pytest
from annotated_types import Interval
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sensors.settings import ThermalSettings
from sensors.thermal import Die
from sensors.unit import REFERENCE_TEMPERATURE

AIR = 288.15


def test_switched_on_for_long_it_is_above_the_air_by_its_self_heating():
    assert Die(ThermalSettings(self_heating=5.0, lag=30.0, powered_for=1e6)).step(0.0, AIR) == AIR + 5.0


def test_just_switched_on_it_has_the_temperature_of_the_air_and_warms_up():
    die = Die(ThermalSettings(self_heating=5.0, lag=30.0, powered_for=0.0))
    assert die.step(0.0, AIR) == AIR
    assert die.step(30.0, AIR) == pytest.approx(AIR + 5.0 * (1 - np.exp(-1)), abs=1e-12)
    assert die.step(1e5, AIR) == pytest.approx(AIR + 5.0, abs=1e-12)


def test_time_it_was_on_before_counts_as_time_it_was_looked_at():
    before = Die(ThermalSettings(self_heating=7.0, lag=20.0, powered_for=13.0))
    watched = Die(ThermalSettings(self_heating=7.0, lag=20.0, powered_for=0.0))
    watched.step(-13.0, AIR)
    assert before.step(0.0, AIR) == pytest.approx(watched.step(0.0, AIR), abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_it_solves_its_equation_for_air_that_is_linear_between_looks(seed):
    """Authority: scipy.integrate.solve_ivp, rtol 1e-10 but for its kinks, over irregular looks; 1e-5 K."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 8.0, 40)) - 0.1
    air = AIR + np.cumsum(rng.normal(0.0, 2.0, 40))
    settings = ThermalSettings(self_heating=4.0, lag=11.0, powered_for=5.0)
    die = Die(settings)
    got = [die.step(t, value) for t, value in zip(times, air, strict=True)]
    solution = solve_ivp(
        lambda t, y: (np.interp(t, times, air) + 4.0 - y) / 11.0, (times[0], times[-1]), [got[0]],
        t_eval=times, rtol=1e-10, atol=1e-10, max_step=0.1,
    )  # fmt: skip
    assert got == pytest.approx(solution.y[0].tolist(), abs=1e-5)
    assert got[0] == pytest.approx(air[0] + 4.0 * (1 - np.exp(-5 / 11)))


def test_at_the_reference_temperature_without_self_heating_it_is_exactly_there():
    """A die at 25 °C has no temperature error at all, not one of 1e-14."""
    die = Die(ThermalSettings())
    assert {die.step(float(t), REFERENCE_TEMPERATURE) for t in range(100)} == {REFERENCE_TEMPERATURE}


def test_what_the_air_does_at_one_instant_the_die_does_not_follow_yet():
    die = Die(ThermalSettings(self_heating=5.0, lag=30.0))
    before = die.step(10.0, AIR)
    assert die.step(10.0, AIR + 20.0) == pytest.approx(before, abs=1e-9)
    assert die.step(40.0, AIR + 20.0) == pytest.approx(before + 20.0 * (1 - np.exp(-1)), abs=1e-6)


def test_air_that_is_no_number_is_forgotten():
    die = Die(ThermalSettings(self_heating=5.0, lag=30.0))
    die.step(0.0, AIR)
    assert isnan(die.step(1.0, nan))
    assert isnan(die.temperature)
    assert die.step(2.0, AIR) == pytest.approx(AIR + 5.0, abs=1e-6)
    late = Die(ThermalSettings(self_heating=5.0, powered_for=1e6))
    assert isnan(late.step(0.0, nan))
    assert late.step(1.0, AIR) == AIR + 5.0


def _bounds(name):
    bound = next(m for m in ThermalSettings.__annotations__[name].__metadata__ if isinstance(m, Interval))
    return st.floats(bound.ge if bound.ge is not None else bound.gt, bound.le, exclude_min=bound.ge is None)


@given(
    _bounds("self_heating"),
    _bounds("lag"),
    _bounds("powered_for"),
    st.lists(st.tuples(st.floats(0.0, 1e4), st.floats(150.0, 400.0)), min_size=1, max_size=20),
)
def test_it_stays_between_the_coldest_air_and_the_warmest_plus_self_heating(heating, lag, powered_for, looks):
    die = Die(ThermalSettings(heating, lag, powered_for))
    t = 0.0
    for wait, air in looks:
        t += wait
        assert min(a for _, a in looks) - 1e-9 <= die.step(t, air) <= max(a for _, a in looks) + heating + 1e-9
