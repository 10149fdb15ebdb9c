"""The channel of a differential sensor on board: what is read of a row, and what the filters make of it."""

import math
from math import inf, nan

import pytest

from uavsim import airdata
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel, build
from uavsim.onboard.airspeed.difference import ZERO, Difference
from uavsim.onboard.airspeed.energy_model import isentropic, total_pressure, total_slopes
from uavsim.onboard.airspeed.measured import limits
from uavsim.onboard.airspeed.rail import RailCheck
from uavsim.onboard.airspeed.stroke import StrokeTest
from uavsim.onboard.flow_through import MOVED, FlowThrough, FlowThroughSettings

STATIC, WARM = 101_325.0, 288.15
HEAT = 7.0 * airdata.GAS_CONSTANT_DRY_AIR * WARM
NOISE = NoiseModel(total_sd=1.5, static_sd=4.0, temperature_sd=0.0, differential=True, total_range=(-6895.0, 6895.0))


def test_a_reading_that_repeats_itself_is_the_same_number_again():
    """The row's sum rounds it to 1e-11 Pa, another way with each static pressure."""
    read = Difference(True).read
    readings = {read((101_325.0 + 0.7331 * k) + 612.264, 101_325.0 + 0.7331 * k) for k in range(1000)}
    assert len(readings) == 1
    assert readings.pop() - ZERO == pytest.approx(612.264, abs=1e-6)


def test_while_the_static_sensor_is_silent_the_last_pressure_counts():
    channel = Difference(True)
    assert channel.read(STATIC + 50.0, STATIC) == pytest.approx(ZERO + 50.0)
    assert channel.read(STATIC + 60.0, nan) == pytest.approx(ZERO + 60.0)
    assert math.isnan(channel.read(nan, STATIC))
    assert math.isnan(channel.read(inf, STATIC))
    assert math.isnan(Difference(True).read(STATIC, nan))
    assert Difference(False).read(102_000.0, nan) == 102_000.0


@pytest.mark.parametrize("speed", [1.0, 32.0, 150.0])
def test_relative_to_the_static_pressure_an_error_of_it_hardly_counts(speed):
    """∂Δp/∂p = (1 + v²/7RT)^3.5 − 1: q_c/p, 0.6 % at 32 m/s; against the difference quotient."""
    h = total_slopes(speed, STATIC, pushed=0.0, heat=HEAT, relative=1.0)
    up, down = (
        total_pressure(speed, STATIC + step, 0.0, 0.0, pushed=0.0, heat=HEAT, relative=1.0) for step in (1.0, -1.0)
    )
    assert h[2] == pytest.approx(0.5 * (up - down), rel=1e-6)
    assert h[2] == pytest.approx(isentropic(speed, STATIC, HEAT) / STATIC - 1.0, rel=1e-9)
    assert h[0] == total_slopes(speed, STATIC, pushed=0.0, heat=HEAT)[0]


@pytest.mark.parametrize("kind", ["paper", "paper-filterpy", "constant-velocity", "jump-adaptive"])
def test_a_filter_of_the_pressures_has_the_airspeed_of_the_difference_and_its_bar(kind):
    """32 m/s after a tare: σ_V = σ/(ρV) of the difference's filter alone, the static noise is not in it."""
    noise = NoiseModel(total_sd=1.5, static_sd=40.0, temperature_sd=0.0, differential=True)
    estimator = build(EstimatorSettings(kind=kind), noise, (0.0, 1.0))
    total = isentropic(32.0, STATIC, HEAT)
    for k in range(400):
        t, swing = 0.01 * k, 30.0 * (-1) ** k  # the static sensor's noise is in both columns of the row
        flying = total - STATIC if t > 1.5 else 0.0
        told = estimator.step(t, STATIC + swing + 7.0 + flying, STATIC + swing, WARM, t, t)
    assert told is not None
    assert told[1] == pytest.approx(32.0, abs=0.05)  # a swing of the static pressure is one of the density
    assert told[3] == pytest.approx(32.0, abs=0.01)
    assert told[4] - told[5] == pytest.approx(total - STATIC, abs=0.1)
    assert 0.005 < told[2] < 1.5 / (1.225 * 32.0) + 1e-3
    assert told[6]


def test_a_scale_error_is_half_of_it_in_the_bar():
    noise = NoiseModel(total_sd=1.5, static_sd=4.0, temperature_sd=0.0, differential=True, difference_scale_sd=0.03)
    estimator = build(EstimatorSettings(kind="paper"), noise)
    total = isentropic(32.0, STATIC, HEAT)
    told = [estimator.step(0.01 * k, total, STATIC, WARM, 0.01 * k, 0.01 * k) for k in range(200)][-1]
    assert told is not None
    assert told[2] == pytest.approx(0.5 * 0.03 * 32.0, rel=0.01)


def test_ends_of_the_range_are_those_of_the_difference():
    low, high = limits(NOISE)[0]
    assert (low - ZERO, high - ZERO) == (-6895.0, 6895.0)


def test_a_differential_sensor_that_is_stuck_on_the_rail_is_told():
    """Its row moves with the static sensor's noise all the same."""
    check, channel = RailCheck(NOISE, -inf), Difference(True)
    for k in range(200):
        t, static = 0.01 * k, STATIC + 3.0 * math.sin(1.7 * k)
        check.add(t, channel.read(static + 5.0, static), static, WARM, t, t)
    assert check.broken(2.0) == {"total": "stuck"}


@pytest.mark.parametrize(
    ("differential", "sign", "found"),
    [(True, 1.0, ""), (True, 0.0, "frozen"), (True, -1.0, "swapped"), (False, -1.0, "frozen")],
)
def test_in_the_stroke_a_difference_that_falls_is_of_swapped_tubes(differential, sign, found):
    """A total pressure that falls says nothing of the static port."""
    test = StrokeTest(differential)
    rest = [(0.01 * k, ZERO, STATIC, WARM, 0.01 * k, 0.01 * k) for k in range(20)]
    test.begin(rest, tare_end=-inf, end=0.2, variance=1.5**2, wind=(0.0, 0.0), sided=True, density=1.225)
    said = ""
    for u in range(3, 26, 2):
        if test.open and not said:
            said = test.add(ZERO + sign * 0.5 * 1.225 * u * u, STATIC, u, 0.0)
    assert said == found
    assert (test.shut > 0.9) == (sign <= 0.0)  # in the bar, both ways, until then
    assert sign <= 0.0 or test.shut < 1e-4


def test_the_correction_for_thin_air_keeps_a_stuck_reading_stuck():
    """p moves it in steps of `MOVED`: within one of them equal readings stay equal."""
    flow, channel = FlowThrough(FlowThroughSettings(96_600.0)), Difference(True)
    found = set()
    for k in range(100):
        static = 70_000.0 + 0.4 * MOVED * math.sin(k)
        row = flow.row((0.01 * k, static + 400.0, static, 268.0, 0.01 * k, 0.01 * k))
        found.add(channel.read(row[1], row[2]))
    assert len(found) == 1
    assert found.pop() - ZERO == pytest.approx(400.0 * 966.0 / 700.0, rel=3e-4)


def test_a_row_without_a_static_pressure_is_corrected_by_the_last():
    flow = FlowThrough(FlowThroughSettings(96_600.0))
    assert math.isnan(flow.total(400.0, nan, 288.0))
    flow.row((0.0, 70_400.0, 70_000.0, 268.0, 0.0, 0.0))
    row = flow.row((0.1, 70_400.0, nan, nan, 0.1, nan))
    assert row[1] - 70_000.0 == pytest.approx(400.0 * 966.0 / 700.0, rel=1e-9)
