"""Calibrated, equivalent, true airspeed, heights and humidity against published numbers; tolerances are theirs."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from uavsim import airdata

KNOT = 1852.0 / 3600.0  # m/s


@pytest.mark.parametrize(
    ("height", "true"),
    [(0, 250.0), (1000, 261.8680), (2000, 274.5248), (3000, 288.0309), (4000, 302.4505), (5000, 317.8517),
     (6000, 334.3056)],
)  # fmt: skip
def test_true_airspeed_of_250_knots_calibrated(height, true):
    """Tests of ATC_Console (EUROCONTROL BADA formulas): its knot has 8 and its air 6 digits, so 1e-5."""
    found = airdata.true_from_calibrated(
        calibrated=250.0 * KNOT,
        static=airdata.standard_pressure(height),
        temperature=airdata.standard_temperature(height),
    )
    assert found / KNOT == pytest.approx(true, rel=1e-5)


def test_airspeeds_against_isatmosphere_jl():
    """Its tests at 9000 m: V_c 128.611 m/s is 201.01 m/s true, Mach 0.661667; p 30 742.5 Pa; their digits."""
    static, temperature = airdata.standard_pressure(9000.0), airdata.standard_temperature(9000.0)
    assert static == pytest.approx(30_742.5, abs=0.1)
    air = {"static": static, "temperature": temperature}
    assert airdata.true_from_calibrated(calibrated=128.611, **air) == pytest.approx(201.01, abs=0.5e-2)
    assert airdata.calibrated_from_true(true=201.01, **air) == pytest.approx(128.611, abs=0.5e-2)
    assert airdata.mach_from_calibrated(calibrated=128.611, static=static) == pytest.approx(0.661667, abs=1e-6)
    assert airdata.calibrated_from_mach(mach=0.661667, static=static) == pytest.approx(128.611, abs=1e-3)


@pytest.mark.parametrize(("true", "calibrated"), [(25.7222, 24.5077), (10.2889, 9.8024), (3.0867, 2.9407)])
def test_calibrated_airspeed_against_correctairspeed(true, calibrated):
    """MATLAB's documented example at 1000 m: a = 336.4 m/s, p = 89 874.6 Pa, four decimals."""
    temperature = 336.4**2 / (airdata.GAMMA * airdata.GAS_CONSTANT_DRY_AIR)
    found = airdata.calibrated_from_true(true=true, static=89_874.6, temperature=temperature)
    assert found == pytest.approx(calibrated, abs=0.5001e-4)


@pytest.mark.parametrize(
    ("calibrated", "static", "equivalent"),
    [(25.7222, 89_874.6, 25.7199), (10.2889, 101_325.0, 10.2889), (3.0867, 101_325.0, 3.0867)],
)
def test_equivalent_airspeed_against_correctairspeed(calibrated, static, equivalent):
    """MATLAB's documented example, four decimals."""
    assert airdata.equivalent_from_calibrated(calibrated=calibrated, static=static) == pytest.approx(
        equivalent, abs=0.5001e-4
    )


# ISO 2533 / ICAO Doc 7488, geopotential height: K, printed to 1e-3; Pa, recomputed in full and printed to 1 (ASHRAE).
@pytest.mark.parametrize(
    ("height", "temperature", "pressure"),
    [(-500, 291.400, 107477.51), (0, 288.15, 101325.0), (100, 287.5, 100129.44), (500, 284.9, 95460.84),
     (1000, 281.650, 89874.56), (2000, 275.15, 79495.20), (3000, 268.65, 70108.53), (4000, 262.15, 61640.21),
     (5000, 255.65, 54019.89), (11000, 216.650, 22632.04)],
)  # fmt: skip
def test_standard_atmosphere(height, temperature, pressure):
    assert airdata.standard_temperature(height) == pytest.approx(temperature, abs=0.5e-3)
    assert airdata.standard_pressure(height) == pytest.approx(pressure, abs=0.5001e-2)
    assert airdata.standard_height(pressure) == pytest.approx(height, abs=1e-3)


@pytest.mark.parametrize("height", [-5000.0, 1234.5, 10_999.0, 11_000.0, 11_001.0, 15_000.0, 20_000.0])
def test_standard_height_undoes_standard_pressure(height):
    assert airdata.standard_height(airdata.standard_pressure(height)) == pytest.approx(height, abs=1e-8)


def test_the_stratosphere_is_isothermal_and_continuous():
    """At 20 km ISO 2533 prints 216.650 K and 5474.87 Pa (five digits)."""
    assert airdata.standard_temperature(20_000.0) == pytest.approx(216.65, abs=1e-9)
    assert airdata.standard_pressure(20_000.0) == pytest.approx(5474.87, abs=0.05)
    near = airdata.standard_pressure(np.array([10_999.999, 11_000.0, 11_000.001]))
    assert np.ptp(near) < 0.01


@pytest.mark.parametrize("height", [-5001.0, 20_001.0])
def test_heights_beyond_the_standard_are_refused(height):
    with pytest.raises(ValueError, match="height must be from"):
        airdata.standard_pressure(height)
    with pytest.raises(ValueError, match="height must be from"):
        airdata.standard_temperature(np.array([0.0, height]))


@pytest.mark.parametrize(
    ("celsius", "pressure"),
    [(0, 611.213), (5, 872.534), (10, 1228.115), (15, 1705.669), (20, 2339.163), (25, 3169.757), (30, 4246.799),
     (40, 7384.824)],
)  # fmt: skip
def test_saturation_vapour_pressure(celsius, pressure):
    """CIPM-2007 A1.1 by an unrelated program, three decimals."""
    assert airdata.saturation_vapour_pressure(celsius + 273.15) == pytest.approx(pressure, abs=0.5001e-3)


@pytest.mark.parametrize(("celsius", "pressure"), [(5, 872.6), (25, 3169.7), (50, 12351.3)])
def test_saturation_vapour_pressure_against_ashrae(celsius, pressure):
    """ASHRAE by the tests of PsychroLib, relative 3e-4 there; another formula, 4e-4 at 50 °C."""
    assert airdata.saturation_vapour_pressure(celsius + 273.15) == pytest.approx(pressure, rel=4e-4)


@pytest.mark.parametrize(
    ("celsius", "humidity", "density"), [(20, 0.5, 1.199314), (20, 1.0, 1.194087), (25, 0.4, 1.178710)]
)
def test_density_from_relative_humidity(celsius, humidity, density):
    """CIPM-2007 by three unrelated programs at 101 325 Pa, 1e-6."""
    air = {"pressure": 101_325.0, "temperature": celsius + 273.15}
    xv = airdata.vapour_fraction(relative_humidity=humidity, **air)
    assert airdata.moist_air_density(**air, vapour_fraction=xv) == pytest.approx(density, rel=1e-6)


def test_dew_point_is_where_the_air_is_saturated():
    """h = 1 and t_d = t are the same statement of CIPM-2007, A1.2."""
    saturated = airdata.vapour_fraction(relative_humidity=1.0, pressure=9e4, temperature=290.0)
    assert airdata.vapour_fraction_at_dew_point(dew_point=290.0, pressure=9e4) == saturated


@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_z_in_the_airspeed(model):
    """V² ∝ 1/ρ ∝ Z: at 1 Pa of difference both relations are √(2·q_c/ρ) of CIPM-2007, gas constants 1.8e-5 apart."""
    air = {"static": 101_325.0, "temperature": 288.15, "vapour_fraction": 0.01}
    density = airdata.moist_air_density(pressure=101_325.0, temperature=288.15, vapour_fraction=0.01)
    found = airdata.airspeed(total=101_326.0, **air, model=model, compressibility=None)
    assert found == pytest.approx(math.sqrt(2.0 / density), rel=1.2e-5)
    assert found / airdata.airspeed(total=101_326.0, **air, model=model) == pytest.approx(
        math.sqrt(airdata.compressibility_factor(pressure=101_325.0, temperature=288.15, vapour_fraction=0.01)),
        rel=1e-14,
    )


@settings(derandomize=True, deadline=None)
@given(speed=st.floats(0.5, 250.0), static=st.floats(2e4, 1.1e5), temperature=st.floats(200.0, 330.0))
def test_each_airspeed_from_each(speed, static, temperature):
    """Every pair of conversions undoes itself, and going round by the third changes nothing (1e-9)."""
    assume(speed / airdata.speed_of_sound(temperature) < 0.999)
    air = {"static": static, "temperature": temperature}
    calibrated = airdata.calibrated_from_true(true=speed, **air)
    assume(calibrated < 0.999 * airdata.STANDARD_SPEED_OF_SOUND)
    equivalent = airdata.equivalent_from_true(true=speed, **air)
    close = pytest.approx(speed, rel=1e-9)
    assert airdata.true_from_calibrated(calibrated=calibrated, **air) == close
    assert airdata.true_from_equivalent(equivalent=equivalent, **air) == close
    assert airdata.equivalent_from_calibrated(calibrated=calibrated, static=static) == pytest.approx(
        equivalent, rel=1e-9
    )
    assert airdata.calibrated_from_equivalent(equivalent=equivalent, static=static) == pytest.approx(
        calibrated, rel=1e-9
    )
    # ρ·V² is that of sea level
    density = static / (airdata.GAS_CONSTANT_DRY_AIR * temperature)
    assert equivalent == pytest.approx(speed * math.sqrt(density / 1.225), rel=1e-6)


@settings(derandomize=True, deadline=None)
@given(mach=st.floats(1e-3, 0.99), static=st.floats(3e4, 1.1e5), temperature=st.floats(200.0, 330.0))
def test_pressures_to_airspeeds(mach, static, temperature):
    total = airdata.total_pressure(static=static, mach=mach)
    impact = airdata.impact_pressure(static=static, mach=mach)
    assert impact == pytest.approx(total - static, abs=1e-10 * static)
    assert airdata.static_pressure(total=total, mach=mach) == pytest.approx(static, rel=1e-13)
    true = airdata.airspeed(total=total, static=static, temperature=temperature)
    assert airdata.equivalent_airspeed(total=total, static=static) == pytest.approx(
        airdata.equivalent_from_true(
            true=mach * airdata.speed_of_sound(temperature), static=static, temperature=temperature
        ),
        rel=1e-8,
    )
    calibrated = airdata.calibrated_airspeed(total=total, static=static)
    if calibrated < airdata.STANDARD_SPEED_OF_SOUND:
        assert airdata.impact_pressure_at_calibrated(calibrated) == pytest.approx(total - static, rel=1e-8)
    for model in ("compressible", "bernoulli"):
        speed = airdata.airspeed(total=total, static=static, temperature=temperature, vapour_fraction=0.01, model=model)
        back = airdata.total_at_airspeed(
            airspeed=speed, static=static, temperature=temperature, vapour_fraction=0.01, model=model
        )
        assert back == pytest.approx(total, rel=1e-13)
    assert true == pytest.approx(mach * airdata.speed_of_sound(temperature), rel=1e-8)


def test_dynamic_pressure_is_half_rho_v_squared():
    static, temperature, mach = 9e4, 280.0, 0.4
    density = static / (airdata.GAS_CONSTANT_DRY_AIR * temperature)
    speed = mach * airdata.speed_of_sound(temperature)
    assert airdata.dynamic_pressure(static=static, mach=mach) == pytest.approx(0.5 * density * speed**2, rel=1e-14)


CALLS = {
    airdata.static_pressure: {"total": 96_000.0, "mach": 0.3},
    airdata.impact_pressure: {"static": 95_000.0, "mach": 0.3},
    airdata.dynamic_pressure: {"static": 95_000.0, "mach": 0.3},
    airdata.total_at_airspeed: {"airspeed": 30.0, "static": 95_000.0, "temperature": 288.0, "vapour_fraction": 0.01},
    airdata.compressibility_factor: {"pressure": 95_000.0, "temperature": 288.0, "vapour_fraction": 0.01},
    airdata.vapour_fraction: {"relative_humidity": 0.5, "pressure": 95_000.0, "temperature": 288.0},
    airdata.vapour_fraction_at_dew_point: {"dew_point": 280.0, "pressure": 95_000.0},
    airdata.saturation_vapour_pressure: {"temperature": 288.0},
    airdata.static_temperature: {"recovery": 288.0, "mach": 0.3, "factor": 0.8},
    airdata.recovery_temperature: {"static": 288.0, "mach": 0.3, "factor": 0.8},
    airdata.calibrated_airspeed: {"total": 96_000.0, "static": 95_000.0},
    airdata.equivalent_airspeed: {"total": 96_000.0, "static": 95_000.0},
    airdata.impact_pressure_at_calibrated: {"calibrated": 30.0},
    airdata.mach_from_calibrated: {"calibrated": 30.0, "static": 95_000.0},
    airdata.calibrated_from_mach: {"mach": 0.2, "static": 95_000.0},
    airdata.true_from_calibrated: {"calibrated": 30.0, "static": 95_000.0, "temperature": 288.0},
    airdata.calibrated_from_true: {"true": 30.0, "static": 95_000.0, "temperature": 288.0},
    airdata.equivalent_from_true: {"true": 30.0, "static": 95_000.0, "temperature": 288.0},
    airdata.true_from_equivalent: {"equivalent": 30.0, "static": 95_000.0, "temperature": 288.0},
    airdata.equivalent_from_calibrated: {"calibrated": 30.0, "static": 95_000.0},
    airdata.calibrated_from_equivalent: {"equivalent": 30.0, "static": 95_000.0},
    airdata.standard_temperature: {"height": 100.0},
    airdata.standard_pressure: {"height": 100.0},
    airdata.standard_height: {"static": 95_000.0},
    airdata.pressure_coefficient: {"pressure": 94_000.0, "static": 95_000.0, "mach": 0.3},
    airdata.impact_over_dynamic: {"mach": 0.3},
}  # fmt: skip
POSITIONAL = {
    airdata.saturation_vapour_pressure, airdata.impact_pressure_at_calibrated, airdata.standard_temperature,
    airdata.standard_pressure, airdata.standard_height, airdata.impact_over_dynamic,
}  # fmt: skip
EACH_ARGUMENT = [(function, name) for function, arguments in CALLS.items() for name in arguments]
IMPOSSIBLE = {
    "temperature": (149.9, 400.1, 15.0),  # degrees Celsius by mistake
    "recovery": (149.9, 15.0),
    "dew_point": (10.0,),
    "vapour_fraction": (-0.01, 1.01),
    "relative_humidity": (-0.01, 50.0),
    "factor": (-0.1, 1.1),
    "mach": (-1e-5, 1.00001),
    "height": (-1e4, 1e5),
    "airspeed": (-1.0,),
    "calibrated": (-1.0, 341.0),
    "true": (-1.0, 400.0),
    "equivalent": (-1.0, 400.0),
}


def call(function, arguments):
    return function(*arguments.values()) if function in POSITIONAL else function(**arguments)


@pytest.mark.parametrize(("function", "name"), EACH_ARGUMENT)
def test_nan_in_gives_nan_out(function, name):
    arguments = CALLS[function]
    assert math.isnan(call(function, arguments | {name: math.nan}))
    column = np.array([arguments[name], math.nan, arguments[name]])
    assert np.isnan(call(function, arguments | {name: column})).tolist() == [False, True, False]


@pytest.mark.parametrize(("function", "name"), EACH_ARGUMENT)
def test_what_no_air_can_be_is_refused(function, name):
    wrong = IMPOSSIBLE.get(name, (0.0, -1.0))
    if function is airdata.recovery_temperature and name == "static":
        wrong = IMPOSSIBLE["temperature"]
    for value in wrong:
        for given_value in (value, np.array([CALLS[function][name], value])):
            with pytest.raises(ValueError, match=r"must|ratio"):
                call(function, CALLS[function] | {name: given_value})


@pytest.mark.parametrize("function", CALLS)
def test_arrays_equal_floats(function):
    """Over ±20 % of each argument, all combinations of five: 1e-13, the libraries' last bits."""
    spread = [0.8, 0.9, 1.0, 1.05, 1.1]
    columns = [[value * factor for factor in spread] for value in CALLS[function].values()]
    if function in (airdata.calibrated_airspeed, airdata.equivalent_airspeed):
        columns[0] = [value * 1.25 for value in columns[0]]
    rows = list(itertools.product(*columns))
    names = list(CALLS[function])
    single = [call(function, dict(zip(names, row, strict=True))) for row in rows]
    whole = call(function, dict(zip(names, np.array(rows).T, strict=True)))
    assert all(type(value) is float for value in single)
    assert whole.dtype == np.float64
    np.testing.assert_allclose(whole, single, rtol=1e-13, atol=0.0)


def test_airspeeds_above_sound_are_refused():
    """At 30 kPa a calibrated 300 m/s is beyond Mach 1."""
    with pytest.raises(ValueError, match="above 1"):
        airdata.true_from_calibrated(calibrated=300.0, static=30_000.0, temperature=230.0)
    with pytest.raises(ValueError, match="above 1"):
        airdata.calibrated_airspeed(total=2e5, static=1e5)
