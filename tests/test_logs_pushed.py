"""What a launch says of the pressures' sign and unit: flights by hand, 7 g for 0.3 s, then 20.6 m/s."""

import numpy as np
import pytest

from uavsim.logs.head import Channel, Head
from uavsim.logs.pushed import odd_rise

LAUNCH, AIR, TEMPERATURE = 3.0, 100_000.0, 288.15


def flight(factor: float, *, differential: bool, wind: float = 0.0, noise: float = 2.0) -> tuple[Head, np.ndarray]:
    """Return the head, its difference times a factor, and force at 200 and 500 Hz."""
    draw = np.random.default_rng(5)
    t = np.arange(0.0, 8.0, 0.002)
    push = (t >= LAUNCH) & (t < LAUNCH + 0.3)
    readings = np.column_stack([t, 2.1 + 7.0 * 9.80665 * push, 0.0 * t, -9.6 + 0.0 * t])
    at = np.arange(0.0, 8.0, 0.005)
    speed = wind + 7.0 * 9.80665 * np.clip(at - LAUNCH, 0.0, 0.3)
    density = AIR / (287.05 * TEMPERATURE)
    difference = factor * (0.5 * density * speed**2 + noise * draw.standard_normal(at.size))
    static = Channel("p_static", at, AIR + noise * draw.standard_normal(at.size), "s")
    total = (
        Channel("p_difference", at, difference, "d") if differential else Channel("p_total", at, AIR + difference, "t")
    )
    return Head(total, static, None, differential), readings


@pytest.mark.parametrize("wind", [-4.0, 0.0, 8.0])
@pytest.mark.parametrize("differential", [True, False])
def test_pressures_in_pascal_are_not_doubted(wind: float, differential: bool) -> None:
    head, readings = flight(1.0, differential=differential, wind=wind)
    assert odd_rise(head, readings, [LAUNCH + 0.02]) == ""
    assert odd_rise(head, readings, []) == ""


@pytest.mark.parametrize(("factor", "unit"), [(0.01, "hPa"), (0.001, "kPa"), (1.0 / 6894.757, "psi")])
def test_the_unit_of_a_difference_shows_in_the_push(factor: float, unit: str) -> None:
    """It had been flown with: three rows valid, 18 m/s off."""
    head, readings = flight(factor, differential=True)
    assert f"looks like {unit}: map p_difference=…*" in odd_rise(head, readings, [LAUNCH + 0.02])


@pytest.mark.parametrize("differential", [True, False])
def test_swapped_tubes_are_named(differential: bool) -> None:
    head, readings = flight(-1.0, differential=differential)
    assert "swapped" in odd_rise(head, readings, [LAUNCH + 0.02])


def test_a_port_that_is_covered_is_of_no_unit() -> None:
    head, readings = flight(1.0, differential=True, wind=0.0)
    still = Channel("p_difference", head.total.t, np.random.default_rng(6).normal(0.0, 2.0, head.total.t.size), "d")
    assert odd_rise(Head(still, head.static, None, True), readings, [LAUNCH + 0.02]) == ""


def test_a_cover_that_leaks_is_of_no_unit() -> None:
    """It rises by a hundredth as hPa do, but with the noise of Pa."""
    head, readings = flight(1.0, differential=True)
    t = head.total.t
    leaks = 2.6 * np.clip((t - LAUNCH) / 0.3, 0.0, 1.0) ** 2 + np.random.default_rng(7).normal(0.0, 1.0, t.size)
    head = Head(Channel("p_difference", t, leaks, "d"), head.static, None, True)
    assert odd_rise(head, readings, [LAUNCH + 0.02]) == ""
