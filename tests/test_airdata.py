"""Air data against published tables and independent codes; every tolerance is that of the authority's own digits."""

import doctest
import importlib
import math
import pkgutil

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uavsim import airdata


@pytest.mark.parametrize("module", [module.name for module in pkgutil.iter_modules(airdata.__path__)])
def test_examples(module):
    assert doctest.testmod(importlib.import_module(f"{airdata.__name__}.{module}")).failed == 0


def vapour_fraction(celsius, pressure, humidity):
    """x_v = h·f·p_sv/p of CIPM-2007 (Picard et al. 2008, appendix A1.1 and A1.2)."""
    kelvin = celsius + 273.15
    saturation = math.exp(1.2378847e-5 * kelvin**2 - 1.9121316e-2 * kelvin + 33.93711047 - 6.3431645e3 / kelvin)
    enhancement = 1.00062 + 3.14e-8 * pressure + 5.6e-7 * celsius**2
    return humidity * enhancement * saturation / pressure


# t in °C, p in Pa, relative humidity; density in kg/m³ by CIPM-2007 (three unrelated programs), by CoolProp's
# HAPropsSI (an independent real-gas code), by the OIML R 111 approximation and of the ideal moist gas.
DENSITY = [
    (20, 101325, 0.0, 1.204557, 1.204603, 1.20449, 1.204106),
    (20, 101325, 0.5, 1.199314, 1.199359, 1.19929, 1.198852),
    (20, 101325, 1.0, 1.194087, 1.194133, 1.19409, 1.193598),
    (15, 101325, 0.0, 1.225521, 1.225567, 1.22539, 1.225000),
    (25, 101325, 0.4, 1.178710, 1.178755, 1.17875, 1.178313),
    (30, 95461, 0.5, 1.088090, 1.088130, 1.08810, 1.087775),
    (20, 90000, 0.2, 1.067783, 1.067821, 1.06779, 1.067423),
    (35, 85000, 0.3, 0.953927, 0.953959, 0.95384, 0.953720),
]


@pytest.mark.parametrize(("celsius", "pressure", "humidity", "cipm", "coolprop", "oiml", "ideal"), DENSITY)
def test_density_against_independent_codes(celsius, pressure, humidity, cipm, coolprop, oiml, ideal):
    air = {
        "pressure": float(pressure),
        "temperature": celsius + 273.15,
        "vapour_fraction": vapour_fraction(celsius, pressure, humidity),
    }
    density = airdata.moist_air_density(**air)
    assert density == pytest.approx(cipm, rel=1e-6)
    assert density == pytest.approx(coolprop, rel=1e-4)
    assert density == pytest.approx(oiml, rel=2e-4)  # its own stated accuracy
    # The ideal column was made with R_a = 287.053 J/(kg·K), 1.8e-5 from R/M_a of CIPM-2007.
    assert airdata.moist_air_density(**air, compressibility=1.0) == pytest.approx(ideal, rel=3e-5)


def test_density_against_psychrolib():
    """ASHRAE (perfect gas) in the PsychroLib tests: 30 °C, humidity ratio 0.02, 95 461 Pa; tolerance there 3e-4."""
    mole_fraction = 0.02 / (0.02 + airdata.MOLAR_MASS_WATER / airdata.MOLAR_MASS_DRY_AIR)
    air = {"pressure": 95_461.0, "temperature": 303.15, "vapour_fraction": mole_fraction}
    assert airdata.moist_air_density(**air, compressibility=1.0) == pytest.approx(1.08411986348219, rel=3e-4)


@pytest.mark.parametrize(("humidity", "density"), [(0.0, 1.20426), (1.0, 1.1937899)])
def test_density_against_py_ballisticcalc(humidity, density):
    """20 °C and 1013 hPa in that project's atmosphere tests, absolute tolerance 1e-4."""
    xv = vapour_fraction(20, 101_300, humidity)
    assert airdata.moist_air_density(pressure=101_300.0, temperature=293.15, vapour_fraction=xv) == pytest.approx(
        density, abs=1e-4
    )


# NACA 1135 in textbook reprints, four printed digits.
@pytest.mark.parametrize(
    ("mach", "ratio"),
    [(0.05, 0.9983), (0.10, 0.9930), (0.15, 0.9844), (0.50, 0.8430), (0.60, 0.7840), (0.82, 0.6430), (0.90, 0.5913),
     (1.00, 0.5283)],
)  # fmt: skip
def test_isentropic_ratio_against_naca_1135(mach, ratio):
    assert 1.0 / airdata.total_pressure(static=1.0, mach=mach) == pytest.approx(ratio, abs=0.5001e-4)


@pytest.mark.parametrize(
    ("mach", "ratio"),
    [(0.10, 1.0070), (0.12, 1.0101), (0.14, 1.0138), (0.16, 1.0180), (0.18, 1.0229), (0.20, 1.0283), (0.22, 1.0343),
     (0.24, 1.0409), (0.26, 1.0481), (0.28, 1.0560), (0.30, 1.0644)],
)  # fmt: skip
def test_isentropic_ratio_against_farokhi(mach, ratio):
    """Farokhi, Aircraft Propulsion, appendix B: p_t/p, four printed decimals."""
    assert airdata.total_pressure(static=1.0, mach=mach) == pytest.approx(ratio, abs=0.5001e-4)


# Sea level of the standard atmosphere: p = 101 325 Pa, 288.15 K, a = 340.293988 m/s.
@pytest.mark.parametrize(
    ("speed", "difference"),
    [(5, 15.3133), (10, 61.2632), (15, 137.8795), (20, 245.2116), (25, 383.3293), (30, 552.3219), (40, 983.3898),
     (50, 1539.5324), (60, 2222.1907)],
)  # fmt: skip
def test_dynamic_pressure_at_standard_sea_level(speed, difference):
    total = airdata.total_pressure(static=101_325.0, mach=speed / 340.293988)
    assert total - 101_325.0 == pytest.approx(difference, abs=0.6e-4)
    assert airdata.airspeed(total=101_325.0 + difference, static=101_325.0, temperature=288.15) == pytest.approx(
        speed, rel=4e-6
    )


@pytest.mark.parametrize(("temperature", "speed"), [(288.15, 340.294), (281.65102, 336.43458), (255.67554, 320.5454)])
def test_speed_of_sound_of_the_standard_atmosphere(temperature, speed):
    assert airdata.speed_of_sound(temperature) == pytest.approx(speed, rel=1e-6)


# ISO 2533 in geopotential height: printed pressures, and the log-mean temperature of a layer of constant lapse.
@pytest.mark.parametrize(
    ("height", "pressure"), [(-500, 107477.51), (100, 100129.44), (500, 95460.84), (1000, 89874.56)]
)
def test_pressure_height_of_the_standard_atmosphere(height, pressure):
    top = 288.15 - 0.0065 * height
    mean = (top - 288.15) / math.log(top / 288.15)
    assert airdata.pressure_height(static=pressure, reference=101_325.0, temperature=mean) == pytest.approx(
        height, abs=1e-3
    )


# Four tunnel conditions of the published method: set Mach, p_t, p_s, T; its airspeed by equations (2) to (4) with K = 1
# and dry air, and the isentropic Mach number, both recomputed by hand to the digits given.
@pytest.mark.parametrize(
    ("total", "static", "temperature", "bernoulli", "isentropic"),
    [
        (106_323.0, 99_330.0, 302.0, 110.48, 0.3133),
        (116_015.0, 97_389.0, 310.0, 184.49, 0.5063),
        (126_139.0, 91_873.0, 319.0, 261.35, 0.6884),
        (141_136.0, 86_015.0, 329.0, 347.91, 0.8717),
    ],
)
def test_published_tunnel_conditions(total, static, temperature, bernoulli, isentropic):
    pressures = {"total": total, "static": static}
    speed = airdata.airspeed(**pressures, temperature=temperature, model="bernoulli")
    assert speed == pytest.approx(bernoulli, abs=0.5e-2)
    density = airdata.moist_air_density(pressure=static, temperature=temperature, compressibility=1.0)
    assert speed == pytest.approx(math.sqrt(2.0 * (total - static) / density), rel=1e-14)
    assert airdata.mach(**pressures) == pytest.approx(isentropic, abs=0.5e-4)


@pytest.mark.parametrize(("speed", "excess"), [(40.0, 0.0018), (0.3 * 340.294, 0.0113), (0.6 * 340.294, 0.0456)])
def test_bernoulli_reads_high(speed, excess):
    """The incompressible relation's error, M²/8 − M⁴/640 + … of V (series of the isentropic relation)."""
    total = airdata.total_pressure(static=101_325.0, mach=speed / airdata.speed_of_sound(288.15))
    read = airdata.airspeed(total=total, static=101_325.0, temperature=288.15, model="bernoulli")
    assert read / speed - 1.0 == pytest.approx(excess, abs=1e-4)


@settings(derandomize=True, deadline=None)
@given(mach=st.floats(1e-3, 1.0), static=st.floats(1e3, 2e5))
def test_mach_undoes_total_pressure(mach, static):
    """At Mach 1e-3 the rounding of p_t alone may be worth 8e-11 of the Mach number."""
    assert airdata.mach(total=airdata.total_pressure(static=static, mach=mach), static=static) == pytest.approx(
        mach, rel=1e-10
    )


@settings(derandomize=True, deadline=None)
@given(ratio=st.floats(1.0, 1.8929), static=st.floats(1e3, 2e5))
def test_total_pressure_undoes_mach(ratio, static):
    total = ratio * static
    assert airdata.total_pressure(static=static, mach=airdata.mach(total=total, static=static)) == pytest.approx(
        total, rel=1e-14
    )


@settings(derandomize=True, deadline=None)
@given(mach=st.floats(1e-2, 1.0), temperature=st.floats(150.0, 400.0), static=st.floats(1e3, 2e5))
def test_airspeed_is_mach_times_speed_of_sound(mach, temperature, static):
    total = airdata.total_pressure(static=static, mach=mach)
    assert airdata.airspeed(total=total, static=static, temperature=temperature) == pytest.approx(
        mach * airdata.speed_of_sound(temperature), rel=1e-10
    )


def test_both_models_agree_at_low_speed():
    """1 Pa of difference: M²/8 is 2e-6 there, and the two gas constants differ by 1.8e-5, 9e-6 of airspeed."""
    air = {"total": 101_326.0, "static": 101_325.0, "temperature": 288.15}
    assert airdata.airspeed(**air) == pytest.approx(airdata.airspeed(**air, model="bernoulli"), rel=1.2e-5)


@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_vapour_and_calibration(model):
    """V ∝ K/√ρ: 2 % of vapour is worth +0.38 %."""
    air = {"total": 102_325.0, "static": 101_325.0, "temperature": 300.0, "model": model}
    dry = airdata.airspeed(**air)
    moist = airdata.airspeed(**air, vapour_fraction=0.02)
    assert moist / dry == pytest.approx(1.0038, abs=1e-4)
    densities = [
        airdata.moist_air_density(pressure=101_325.0, temperature=300.0, vapour_fraction=xv, compressibility=1.0)
        for xv in (0.0, 0.02)
    ]
    assert moist / dry == pytest.approx(math.sqrt(densities[0] / densities[1]), rel=1e-13)
    assert airdata.airspeed(**air, calibration=0.95) == pytest.approx(0.95 * dry, rel=1e-15)


@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_total_below_static(model):
    below = {"total": 101_275.0, "static": 101_325.0, "temperature": 288.15, "model": model}
    above = below | {"total": 101_375.0}
    speed = airdata.airspeed(**above)
    assert airdata.airspeed(**below) == 0.0
    assert airdata.airspeed(**below, negative="signed") == pytest.approx(-speed, rel=1e-15)
    assert math.isnan(airdata.airspeed(**below, negative="nan"))
    for rule in ("clip", "signed", "nan"):
        assert airdata.airspeed(**above, negative=rule) == speed
        assert airdata.airspeed(**below | {"total": 101_325.0}, negative=rule) == 0.0
    assert airdata.mach(total=101_275.0, static=101_325.0) == 0.0


CALLS = {
    airdata.moist_air_density: {"pressure": 95_000.0, "temperature": 288.0, "vapour_fraction": 0.01},
    airdata.total_pressure: {"static": 95_000.0, "mach": 0.3},
    airdata.mach: {"total": 96_000.0, "static": 95_000.0},
    airdata.airspeed: {"total": 96_000.0, "static": 95_000.0, "temperature": 288.0, "vapour_fraction": 0.01},
    airdata.pressure_height: {"static": 95_000.0, "reference": 96_000.0, "temperature": 288.0},
    airdata.speed_of_sound: {"temperature": 288.0},
}
EACH_ARGUMENT = [(function, name) for function, arguments in CALLS.items() for name in arguments]


@pytest.mark.parametrize(("function", "name"), EACH_ARGUMENT)
def test_nan_in_gives_nan_out(function, name):
    assert math.isnan(function(**CALLS[function] | {name: math.nan}))
    value = CALLS[function][name]
    result = function(**CALLS[function] | {name: np.array([value, math.nan, value])})
    assert np.isnan(result).tolist() == [False, True, False]


@pytest.mark.parametrize("negative", ["clip", "signed", "nan"])
@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
@pytest.mark.parametrize("name", ["total", "static", "temperature", "vapour_fraction"])
def test_nan_prevails_over_every_rule(name, model, negative):
    air = {"total": 94_000.0, "static": 95_000.0, "temperature": 288.0, "vapour_fraction": 0.0}
    options = {"model": model, "negative": negative}
    assert math.isnan(airdata.airspeed(**air | {name: math.nan}, **options))
    assert np.isnan(airdata.airspeed(**air | {name: np.array([math.nan])}, **options)).all()


@pytest.mark.parametrize(("function", "name"), EACH_ARGUMENT)
def test_what_no_air_can_be_is_refused(function, name):
    impossible = {
        "temperature": (149.9, 400.1, -1.0),
        "vapour_fraction": (-0.01, 1.01),
        "mach": (-1e-5, 1.00001),
    }.get(name, (0.0, -1.0))
    for value in impossible:
        with pytest.raises(ValueError, match="must be"):
            function(**CALLS[function] | {name: value})
        with pytest.raises(ValueError, match="must be"):
            function(**CALLS[function] | {name: np.array([CALLS[function][name], value])})


def test_boundaries_are_included():
    assert airdata.total_pressure(static=1.0, mach=0.0) == 1.0
    assert airdata.total_pressure(static=1.0, mach=1.0) == pytest.approx(1.89292916, abs=1e-8)
    assert airdata.mach(total=airdata.total_pressure(static=7.0, mach=1.0), static=7.0) == pytest.approx(1.0, abs=1e-12)
    assert airdata.total_pressure(static=1.0, mach=1.0 + 5e-7) > airdata.total_pressure(static=1.0, mach=1.0)
    assert airdata.mach(total=airdata.total_pressure(static=1.0, mach=1.0 + 9e-7), static=1.0) > 1.0
    for temperature in (150.0, 400.0):
        assert airdata.airspeed(total=2.0, static=1.0, temperature=temperature) > 0.0
    with pytest.raises(ValueError, match="above 1"):
        airdata.mach(total=1.8930, static=1.0)


@pytest.mark.parametrize(("name", "value"), [("model", "newton"), ("negative", "abs")])
def test_unknown_options_are_refused(name, value):
    with pytest.raises(ValueError, match=f"{name} must be one of"):
        airdata.airspeed(total=2.0, static=1.0, temperature=300.0, **{name: value})


@pytest.mark.parametrize("options", [{}, {"model": "bernoulli"}, {"negative": "signed"}, {"negative": "nan"}])
def test_arrays_equal_floats(options):
    """The two paths share their equations; the libraries under them may differ in the last bits."""
    random = np.random.default_rng(20080149)
    static = random.uniform(3e4, 1.1e5, 200)
    ratio = random.uniform(0.999, 1.8, 200)
    temperature = random.uniform(220.0, 320.0, 200)
    vapour = random.uniform(0.0, 0.04, 200)
    calls = [
        (airdata.airspeed, {"total": ratio * static, "static": static, "temperature": temperature}, options),
        (airdata.mach, {"total": ratio * static, "static": static}, {}),
        (airdata.total_pressure, {"static": static, "mach": ratio - 0.999}, {}),
        (airdata.moist_air_density, {"pressure": static, "temperature": temperature, "vapour_fraction": vapour}, {}),
        (airdata.pressure_height, {"static": static, "reference": static[::-1], "temperature": temperature}, {}),
    ]
    for function, arguments, extra in calls:
        whole = function(**arguments, **extra)
        single = [
            function(**dict(zip(arguments, map(float, row), strict=True)), **extra)
            for row in zip(*arguments.values(), strict=True)
        ]
        assert all(type(value) is float for value in single)
        assert whole.dtype == np.float64
        np.testing.assert_allclose(whole, single, rtol=1e-13, atol=0.0, equal_nan=True)


def test_the_loop_functions_are_the_public_ones():
    for total in (90_000.0, 95_000.0, 95_000.5, 96_000.0, 120_000.0, math.nan):
        air = (total, 95_000.0, 288.0)
        keywords = dict(zip(("total", "static", "temperature"), air, strict=True))
        for fast, model in (
            (airdata.compressible_airspeed, "compressible"),
            (airdata.bernoulli_airspeed, "bernoulli"),
        ):
            np.testing.assert_equal(fast(*air), airdata.airspeed(**keywords, model=model))


def test_broadcasting_integers_and_shapes():
    grid = airdata.airspeed(total=np.array([[101_400], [101_500]]), static=101_325, temperature=[280, 290, 300])
    assert grid.shape == (2, 3)
    assert airdata.airspeed(total=101_400, static=101_325, temperature=280) == pytest.approx(grid[0, 0], rel=1e-14)
    assert isinstance(airdata.mach(total=np.float64(2.0), static=np.float64(1.5)), float)


def test_one_sample_beyond_mach_1_spoils_no_array() -> None:
    """The limit is p_t/p_s = 1.2^3.5 = 1.8929."""
    static = 1e5
    found = airdata.mach(total=np.array([1.1862e5, 1.9e5, 1.8929e5]), static=static)
    assert np.isnan(found).tolist() == [False, True, False]
    with pytest.raises(ValueError, match="above 1"):
        airdata.mach(total=1.9e5, static=static)
    with pytest.raises(ValueError, match="ressure"):
        airdata.mach(total=np.array([1.9e5, -1.0]), static=static)
