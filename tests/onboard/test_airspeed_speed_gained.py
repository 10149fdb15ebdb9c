"""The integral of f_x against its closed form, its variance against σ²·Δt·t, the mean of −f_z against its own sum."""

import math

import pytest

from uavsim.onboard.airspeed.speed_gained import GAP_SD, SpeedGained

RATE, SD = 1000.0, 0.3


def fed(lag: float = 0.0, until: int = 1500, size: int = 1024) -> SpeedGained:
    """Readings of cos t, taken `lag` after the instant that they are of."""
    gained = SpeedGained(SD, RATE, size, lag=lag)
    for k in range(until + 1):
        t = k / RATE
        gained.add(t + lag, math.cos(t), 0.0, -9.8)
    return gained


@pytest.mark.parametrize("lag", [0.0, 0.004])
def test_integral_and_variance_between_two_instants(lag: float) -> None:
    """sin b − sin a to the trapezoidal rule's h²/12·(b − a), and σ²h(b − a): the lag is taken off the time stamps."""
    gained = fed(lag)
    for a, b in ((0.8, 1.4), (1.0003, 1.0007), (1.4996, 1.5)):
        (ua, wa), (ub, wb) = gained.at(a), gained.at(b)
        assert ub - ua == pytest.approx(math.sin(b) - math.sin(a), abs=2e-7)
        assert wb - wa == pytest.approx(SD * SD / RATE * (b - a), rel=1e-9)


def test_before_the_oldest_reading_it_is_that_of_the_oldest() -> None:
    gained = fed(0.002)
    assert gained.oldest == pytest.approx(1.5 - 1023 / RATE, abs=1e-12)
    assert gained.at(0.1) == pytest.approx(gained.at(gained.oldest + 1e-9), abs=1e-8)


def test_a_gap_counts_with_the_mean_of_its_ends_and_what_nobody_has_read() -> None:
    gained = SpeedGained(SD, RATE)
    for t, f in ((0.0, 1.0), (0.001, 1.0), (0.051, 3.0), (0.052, 3.0)):
        gained.add(t, f)
    (ua, wa), (ub, wb) = gained.at(0.001), gained.at(0.051)
    assert ub - ua == pytest.approx(0.1, rel=1e-12)
    assert wb - wa == pytest.approx(SD * SD / RATE * 0.05 + (GAP_SD * 0.05) ** 2, rel=1e-9)


def test_lift_is_the_mean_since_it_was_last_asked_for() -> None:
    gained = fed()
    assert gained.lift() == pytest.approx(9.8, rel=1e-12)
    assert math.isnan(gained.lift())
    gained.add(2.0, math.nan, 0.0, 5.0)  # passed over
    assert math.isnan(gained.lift())
    gained.add(2.0, 0.0, 0.0, math.nan)
    assert math.isnan(gained.lift())
    gained.add(2.001, 0.0, 0.0, 4.0)
    assert gained.lift() == -4.0  # a NaN spoils its own interval and no other
