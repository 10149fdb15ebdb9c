"""Trim, derivatives and modes of an aircraft.

Authority: balance of forces in level flight (L + T sin α = W, T cos α = D); the speed of stall's definition; and the
linear equations of longitudinal motion with the derivatives (Etkin & Reid, *Dynamics of Flight*, 3rd ed., 4.9).
"""

import csv
import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from uavsim.plants.columns import FT, SLUG
from uavsim.plants.free import Free
from uavsim.studies.linearise import Linearised, linearise, named, roots, trim
from uavsim.views import linearised as view

GRAVITY, SLUG_FT3, SLUG_FT2 = 9.80665, SLUG / FT**3, SLUG * FT**2


@cache
def found() -> Linearised:
    return linearise("fw8", (25.0, 32.0, 40.0), (0.0, 1.0))


def body() -> dict[str, float]:
    """Of fw8 with its wing out, SI."""
    fdm = Free("fw8").fdm
    return {
        "density": fdm["atmosphere/rho-slugs_ft3"] * SLUG_FT3,
        "area": fdm["metrics/Sw-sqft"] * FT**2,
        "chord": fdm["metrics/cbarw-ft"] * FT,
        "iyy": fdm["inertia/iyy-slugs_ft2"] * SLUG_FT2,
    }


@pytest.mark.parametrize("at", [-3, -2, -1])
def test_lift_and_thrust_balance_weight_and_drag(at: int) -> None:
    """Within 0.5 %: the tail's angle moves on with the trim, the air's density with some feet."""
    point, b = found().points[at], body()
    d = point.derivatives
    assert d is not None
    force = 0.5 * b["density"] * point.airspeed**2 * b["area"]
    weight = found().mass * GRAVITY
    assert d["CL"] * force + point.thrust * math.sin(point.alpha) == pytest.approx(weight, rel=5e-3)
    assert point.thrust * math.cos(point.alpha) == pytest.approx(d["CD"] * force, rel=5e-3)


def test_modes_are_those_of_the_derivatives_within_15_percent() -> None:
    """Eigenvalues of (u, w, q, θ) built by hand from the derivatives, against flight in air that knows no α'."""
    point, b = found().points[-2], body()
    d = point.derivatives
    assert d is not None
    free, v, m = Free("fw8", steady=True), point.airspeed, found().mass
    modes = {mode.name: mode.value for mode in named(*roots(free, v, trim(free, v)))}
    force = 0.5 * b["density"] * v**2 * b["area"]
    by_speed, half = force / (m * v), 0.5 * b["chord"] / v
    pitching = force * b["chord"] / b["iyy"]
    w0, u0 = v * math.sin(point.alpha), v * math.cos(point.alpha)
    matrix = np.array(
        [
            [-2.0 * by_speed * d["CD"], by_speed * (d["CL"] - d["CD_alpha"]), -w0, -GRAVITY * math.cos(point.alpha)],
            [
                -2.0 * by_speed * d["CL"],
                -by_speed * (d["CL_alpha"] + d["CD"]),
                u0 - by_speed * v * half * d["CL_q"],
                -GRAVITY * math.sin(point.alpha),
            ],
            [0.0, pitching * d["Cm_alpha"] / v, pitching * half * d["Cm_q"], 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )
    slow, fast = sorted((value for value in np.linalg.eigvals(matrix) if value.imag > 0.0), key=abs)
    for name, by_hand in (("short period", fast), ("phugoid", slow)):
        assert abs(modes[name]) == pytest.approx(abs(by_hand), rel=0.15)
        assert modes[name].real == pytest.approx(by_hand.real, rel=0.15)


def test_stall_carries_the_weight() -> None:
    b = body()
    lift = 0.5 * b["density"] * found().stall ** 2 * b["area"] * found().greatest_lift
    assert lift == pytest.approx(found().mass * GRAVITY, rel=2e-3)


def test_where_no_level_flight_is_the_row_says_so(tmp_path: Path) -> None:
    view.save(found(), tmp_path, plots=False)
    with (tmp_path / "linearise.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["wing"] for row in rows] == ["0.0"] * 3 + ["1.0"] * 3
    assert "level flight" in rows[0]["problem"]
    assert rows[0]["thrust"] == ""
    assert rows[-1]["problem"] == ""
    points = json.loads((tmp_path / "linearise.json").read_text(encoding="utf-8"))["points"]
    assert points[0]["trim"] is None
    assert {m["name"] for m in points[-1]["modes"]} == {"short period", "phugoid", "Dutch roll", "roll", "spiral"}
