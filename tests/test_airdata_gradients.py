"""Every derivative against the complex step (Squire & Trapp, SIAM Review 40 (1998) 110) or central differences.

The complex step, f'(x) = Im f(x + ih)/h with h = 1e-30, has no subtraction: it is held to 1e-12. Where a function's
checks take floats only, central differences with h = 1e-6·x stand in: their error is (h²f‴/6 + ε·f/h)/f' ≈ 1e-8.
"""

import math

import numpy as np
import pytest

from uavsim import airdata
from uavsim.airdata import Polynomial, PositionError, Table
from uavsim.airdata.pressures import isentropic_mach, isentropic_total

AIR = {"total": 112_000.0, "static": 101_000.0, "temperature": 281.0, "vapour_fraction": 0.012}
ANGLES = {"alpha": 0.06, "beta": -0.03}


def central(function, arguments, name, step=1e-6):
    h = step * abs(arguments[name])
    high, low = (function(**arguments | {name: arguments[name] + sign * h}) for sign in (1.0, -1.0))
    return (np.asarray(high) - np.asarray(low)) / (2.0 * h)


def test_isentropic_slopes_by_the_complex_step():
    h = 1e-30
    by_mach = np.imag(isentropic_total(9e4, np.array(0.37 + 1j * h), np)) / h
    by_static, slope = airdata.total_pressure_gradient(static=9e4, mach=0.37)
    assert slope == pytest.approx(float(by_mach), rel=1e-12)
    assert by_static == pytest.approx(float(np.imag(isentropic_total(np.array(9e4 + 1j * h), 0.37, np)) / h), rel=1e-12)
    total, static = 1e5, 9e4
    by_total = np.imag(isentropic_mach(np.array((total + 1j * h - static) / static), np)) / h
    by_static = np.imag(isentropic_mach((total - np.array(static + 1j * h)) / np.array(static + 1j * h), np)) / h
    assert airdata.mach_gradient(total=total, static=static) == pytest.approx(
        (float(by_total), float(by_static)), rel=1e-12
    )


GRADIENTS = [
    (airdata.total_pressure, airdata.total_pressure_gradient, {"static": 9e4, "mach": 0.4}, ()),
    (airdata.mach, airdata.mach_gradient, {"total": 1.1e5, "static": 1e5}, ()),
    (airdata.moist_air_density, airdata.moist_air_density_gradient,
     {"pressure": 9e4, "temperature": 290.0, "vapour_fraction": 0.01}, ()),
    (airdata.static_temperature, airdata.static_temperature_gradient,
     {"recovery": 300.0, "mach": 0.6, "factor": 0.8}, ()),
    (airdata.calibrated_airspeed, airdata.calibrated_airspeed_gradient, {"total": 1.0e5, "static": 9e4}, ()),
    (airdata.equivalent_airspeed, airdata.equivalent_airspeed_gradient, {"total": 1.0e5, "static": 9e4}, ()),
    (airdata.pressure_height, airdata.pressure_height_gradient,
     {"static": 9e4, "reference": 1e5, "temperature": 285.0}, ()),
    (airdata.airspeed, airdata.airspeed_gradient, AIR, ("vapour_fraction",)),
]  # fmt: skip


@pytest.mark.parametrize(("function", "gradient", "arguments", "without"), GRADIENTS)
def test_gradients_by_central_differences(function, gradient, arguments, without):
    names = [name for name in arguments if name not in without]
    expected = [float(central(function, arguments, name)) for name in names]
    assert gradient(**arguments) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("model", ["compressible", "bernoulli"])
def test_airspeed_slopes_and_curvature(model):
    arguments = AIR | {"model": model, "calibration": 0.97}
    slopes = airdata.airspeed_gradient(**arguments)
    expected = [float(central(airdata.airspeed, arguments, name)) for name in ("total", "static", "temperature")]
    assert slopes == pytest.approx(expected, rel=1e-7)
    bend = central(lambda **a: airdata.airspeed_gradient(**a)[0], arguments, "total")
    assert airdata.airspeed_curvature(**arguments) == pytest.approx(float(bend), rel=1e-6)
    # ∂V/∂p_t = K²/(ρ_t·V), the stagnation density with the gas constant that each relation has
    if model == "compressible":
        density = airdata.GAS_CONSTANT_DRY_AIR * 281.0 / (1.0 - 0.012 * (1.0 - 18.01528 / 28.96546))
        stagnation = 101_000.0 / density * (112_000.0 / 101_000.0) ** (1.0 / 1.4)
        assert slopes[0] == pytest.approx(0.97**2 / (stagnation * airdata.airspeed(**arguments)), rel=1e-12)


@pytest.mark.parametrize(("function", "gradient", "arguments", "_without"), GRADIENTS)
def test_gradients_of_arrays_equal_those_of_floats(function, gradient, arguments, _without):
    columns = {name: np.array([value, value, math.nan]) for name, value in arguments.items()}
    single, whole = gradient(**arguments), gradient(**columns)
    for number, column in zip(single, whole, strict=True):
        assert type(number) is float
        np.testing.assert_allclose(column, [number, number, math.nan], rtol=1e-13)


@pytest.mark.parametrize("total", [95_000.0, 94_999.0])
def test_a_root_has_no_slope_at_rest(total):
    pressures = {"total": total, "static": 95_000.0}
    assert np.isnan(airdata.mach_gradient(**pressures)).all()
    assert np.isnan(airdata.calibrated_airspeed_gradient(**pressures)).all()
    assert np.isnan(airdata.equivalent_airspeed_gradient(**pressures)).all()
    assert np.isnan(airdata.airspeed_gradient(**pressures, temperature=280.0)[:2]).all()
    assert math.isnan(airdata.airspeed_curvature(**pressures, temperature=280.0))
    assert np.isnan(airdata.airspeed_gradient(total=np.array([total]), static=95_000.0, temperature=280.0)).all()


SURFACES = [
    Polynomial(((-0.03, 0, 0, 0), (0.2, 0, 1, 0), (1.1, 0, 2, 0), (-0.7, 0, 0, 2), (0.04, 2, 0, 0), (0.3, 1, 1, 1))),
    Table((0.1, 0.3, 0.6), (-0.1, 0.0, 0.2), (-0.1, 0.1), tuple(
        tuple(tuple(0.1 * i - 0.3 * j * j + 0.05 * k * i for k in (0, 1)) for j in (0, 1, 2)) for i in (0, 1, 2)
    )),
    Table.of_mach((0.2, 0.5, 0.8), (1.0, 0.98, 1.01)),
]  # fmt: skip


@pytest.mark.parametrize("surface", SURFACES)
def test_surface_slopes(surface):
    """Inside a cell; a table's slopes are exact there."""
    point = {"mach": 0.37, "alpha": 0.05, "beta": 0.03}
    expected = [float(central(surface, point, name)) for name in point]
    assert surface.gradient(**point) == pytest.approx(expected, rel=1e-6, abs=1e-9)
    columns = surface.gradient(**{name: np.full(3, value) for name, value in point.items()})
    np.testing.assert_allclose(np.transpose(columns), [surface.gradient(**point)] * 3, rtol=1e-13, atol=1e-15)


def test_position_error_gradient_is_that_of_its_correction():
    head = PositionError(static=SURFACES[0], total=Polynomial(((0.99, 0, 0, 0), (-0.05, 2, 0, 0), (-0.4, 0, 2, 0))))
    true = {"total": 1.15e5, "static": 1e5}
    total, static = head.read(**true, **ANGLES)
    read = {"total": total, "static": static}
    found = head.gradient(**true, **ANGLES)
    for column, name in enumerate(("total", "static")):
        expected = central(lambda **a: head.correct(**a, **ANGLES), read, name)
        assert [row[column] for row in found] == pytest.approx(expected.tolist(), rel=1e-6)
