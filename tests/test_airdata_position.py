"""Polynomials, tables and position errors: they hold what they were given, and correcting undoes reading."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.port_table import fit
from sensors.probe import static_port
from sensors.settings import StaticPortSettings
from uavsim import airdata
from uavsim.airdata import Polynomial, PositionError, Table

GRID = Table(
    (0.1, 0.3, 0.6),
    (-0.1, 0.0, 0.2),
    (-0.1, 0.1),
    tuple(tuple(tuple(1.0 + 0.1 * i - 0.03 * j + 0.05 * k for k in range(2)) for j in range(3)) for i in range(3)),
)


def test_a_table_goes_through_its_points():
    for i, mach in enumerate(GRID.mach):
        for j, alpha in enumerate(GRID.alpha):
            for k, beta in enumerate(GRID.beta):
                assert GRID(mach, alpha, beta) == pytest.approx(GRID.values[i][j][k], rel=1e-15)


def test_a_table_is_linear_between_and_constant_beyond():
    assert GRID(0.2, 0.0, 0.1) == pytest.approx((GRID(0.1, 0.0, 0.1) + GRID(0.3, 0.0, 0.1)) / 2.0, rel=1e-15)
    assert GRID(-5.0, -9.0, -9.0) == GRID.values[0][0][0]
    assert GRID(5.0, 9.0, 9.0) == GRID.values[-1][-1][-1]
    assert GRID.gradient(5.0, 9.0, 9.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "surface", [GRID, Table.of_mach((0.2, 0.5), (1.0, 0.9)), Polynomial(((2.0, 1, 2, 0), (1.0, 0, 0, 1)))]
)
def test_arrays_equal_floats_and_nan_goes_through(surface):
    random = np.random.default_rng(7)
    points = random.uniform(-0.3, 0.9, (200, 3))
    whole = surface(*points.T)
    np.testing.assert_allclose(whole, [surface(*map(float, row)) for row in points], rtol=1e-13, atol=1e-15)
    for column in range(3):
        point = [0.2, 0.1, 0.05]
        point[column] = math.nan
        assert math.isnan(surface(*point))
        assert np.isnan(surface(*(np.array([x]) for x in point))).all()


def test_a_fit_finds_the_polynomial_that_made_the_values():
    made = Polynomial(((-0.03, 0, 0, 0), (0.2, 0, 1, 0), (1.1, 0, 2, 0), (-0.7, 0, 0, 2), (0.04, 2, 0, 0)))
    mach, alpha, beta = np.meshgrid([0.05, 0.1, 0.3], [-0.1, 0.0, 0.1, 0.2], [-0.1, 0.0, 0.1])
    fitted = Polynomial.fit(made(mach, alpha, beta), [t[1:] for t in made.terms], mach=mach, alpha=alpha, beta=beta)
    assert [t[0] for t in fitted.terms] == pytest.approx([t[0] for t in made.terms], abs=1e-13)
    with pytest.raises(ValueError, match="2 terms need as many values"):
        Polynomial.fit([1.0], [(0, 0, 0), (1, 0, 0)])


@pytest.mark.parametrize(
    ("mach", "values", "message"),
    [((), (), "mach must increase"), ((0.3, 0.3), (1.0, 1.0), "mach must increase"), ((0.3,), (1.0, 2.0), "shape"),
     ((0.3, 0.4), (1.0, math.nan), "finite")],
)  # fmt: skip
def test_wrong_tables_are_refused(mach, values, message):
    with pytest.raises(ValueError, match=message):
        Table.of_mach(mach, values)


def test_wrong_polynomials_are_refused():
    for terms in (((math.nan, 0, 0, 0),), ((1.0, -1, 0, 0),)):
        with pytest.raises(ValueError, match="terms must be"):
            Polynomial(terms)


@settings(derandomize=True, deadline=None)
@given(mach=st.floats(0.01, 0.85), alpha=st.floats(-0.2, 0.2), beta=st.floats(-0.2, 0.2), static=st.floats(3e4, 1.1e5))
def test_correcting_undoes_reading(mach, alpha, beta, static):
    head = PositionError(
        static=Polynomial(((-0.05, 0, 0, 0), (0.3, 0, 1, 0), (-1.0, 0, 0, 2), (0.1, 2, 0, 0))),
        total=Polynomial(((1.0, 0, 0, 0), (-0.5, 0, 2, 0), (-0.06, 2, 0, 0))),
    )
    total = airdata.total_pressure(static=static, mach=mach)
    read = head.read(total=total, static=static, alpha=alpha, beta=beta)
    found = head.correct(total=read[0], static=read[1], alpha=alpha, beta=beta)
    assert found == pytest.approx((total, static), rel=1e-10)


def test_arrays_of_pressures_equal_floats():
    head = PositionError(static=Polynomial(((-0.05, 0, 0, 0), (0.1, 2, 0, 0))))
    total, static = np.array([1.0e5, 1.1e5, math.nan, 9.9e4]), np.full(4, 1e5) - [1.0, 0.0, 0.0, 0.0]
    whole = head.correct(total=total, static=static)
    for column in range(4):
        np.testing.assert_allclose(
            [row[column] for row in whole],
            head.correct(total=float(total[column]), static=float(static[column])),
            rtol=1e-13,
        )


def test_the_probe_of_the_simulation_reads_what_the_model_says():
    """`sensors.probe`, which knows nothing of this package, has the same definition of c_s, of sines for angles."""
    settings_ = StaticPortSettings(error=-0.04, error_alpha=0.2, error_alpha2=1.5, error_beta2=-0.8, error_mach2=0.1)
    head = PositionError(
        static=Polynomial(((-0.04, 0, 0, 0), (0.2, 0, 1, 0), (1.5, 0, 2, 0), (-0.8, 0, 0, 2), (0.1, 2, 0, 0)))
    )
    total = airdata.total_pressure(static=1e5, mach=0.3)
    port = static_port(settings_)
    assert port is not None
    read = head.read(total=total, static=1e5, alpha=math.sin(0.05) * math.cos(0.02), beta=math.sin(0.02))[1]
    assert port(total, 1e5, 0.3, 0.05, 0.02, 0.0) == pytest.approx(read, rel=1e-14)


def test_a_correction_that_does_not_exist_is_nan():
    """Ports that read alike say nothing of the airspeed."""
    blind = PositionError(static=Polynomial(((1.0, 0, 0, 0),)))
    assert np.isnan(blind.correct(total=1.1e5, static=1e5)).all()
    assert np.isnan(blind.correct(total=np.array([1.1e5]), static=1e5)).all()


def test_k_of_mach():
    """K(M) as a function multiplies what K = 1 gives, by the Mach number read."""
    air = {"total": np.array([1.02e5, 1.2e5]), "static": 1e5, "temperature": 290.0}
    k = Polynomial(((0.98, 0, 0, 0), (0.05, 2, 0, 0)))
    mach = airdata.mach(total=air["total"], static=1e5)
    expected = airdata.airspeed(**air) * (0.98 + 0.05 * mach**2)
    np.testing.assert_allclose(airdata.airspeed(**air, calibration=k), expected, rtol=1e-14)
    table = Table.of_mach((0.1, 0.6), (0.97, 1.0))
    assert airdata.airspeed(total=1.02e5, static=1e5, temperature=290.0, calibration=table) == pytest.approx(
        airdata.airspeed(total=1.02e5, static=1e5, temperature=290.0) * table(float(mach[0])), rel=1e-14
    )


def test_a_table_of_it_is_a_calibration_of_the_same_head() -> None:
    """Small angles, where the law's z and y are alpha and beta: 1e-3 of the coefficients at 2°."""
    static = Polynomial(((0.03, 0, 0, 0), (0.1, 0, 1, 0), (-0.6, 0, 2, 0), (-0.5, 0, 0, 2), (0.2, 2, 0, 0)))
    angles = [math.radians(degrees) for degrees in (-2.0, -1.0, 0.0, 1.0, 2.0)]
    table = PositionError(static=static).table(mach=(0.05, 0.2), alpha=angles, beta=angles)
    found = fit(table)
    assert found.static == pytest.approx((0.03, 0.1, -0.6, -0.5, 0.2), rel=2e-3)
    assert found.left < 1e-6
