"""The air as an aircraft meets it: a record of it against the printed spectra, and how it goes by height and axes.

Authority: `references.dryden`, the spectra as MIL-F-8785C and MIL-HDBK-1797 print them. Of a record 2000 comparisons
are one family, held at 1 % by Holm's step-down; the seeds are fixed, so a failure means a change. The smallest change
that is seen nine times in ten is 5.8 standard deviations of one comparison; `test_smallest_effects` says them in
numbers. Longer records: tests/validation/test_air.py.
"""

from collections.abc import Callable
from dataclasses import replace
from math import cos, pi, radians, sin
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray
from references import dryden as specification
from references.dryden import FOOT, Finding, Spectrum

from uavsim.plants.air import dryden, moving
from uavsim.plants.air.moving import MovingAir, State
from uavsim.plants.air.settings import EnvironmentSettings

Array = NDArray[np.float64]
Air = Callable[..., Array]

HEIGHTS, SPEEDS = (5.0, 60.0, 250.0), (8.0, 32.0, 90.0)  # m, m/s
SPAN, W20 = 2.0, 8.0  # m, m/s
ROUGH = EnvironmentSettings(turbulence_wind_20ft=W20, wind_from_deg=180.0)  # what blows along it, blows to the north
RATE, LENGTH = 250.0, 400.0  # Hz, s, of the records here
LEVEL = State(60.0, 0.0, 32.0, 0.0, 0.0, 0.0)


def flown(
    state: State = LEVEL, environment: EnvironmentSettings = ROUGH, steps: int = 50, seed: int = 1, rate: float = 1000.0
) -> Array:
    """Air of some steps in which the state stays: north, east, down, p, q, r, mean north, mean east."""
    air = MovingAir(environment, 0.0, SPAN, rate, steps, seed)
    blocks = [air.ahead(state).copy() for _ in range(-(-steps // round(moving.AHEAD * rate)))]
    return np.concatenate(blocks)[:steps]


def recorded(
    monkeypatch: pytest.MonkeyPatch, state: State, rate: float, length: float, seed: int, **more: object
) -> Array:
    """The same in one block, as the filters stay as they are."""
    monkeypatch.setattr(moving, "AHEAD", length)
    return flown(state, replace(ROUGH, **more), round(length * rate), seed, rate)[:, :6]  # type: ignore[arg-type]


def laws(air: specification.Air, speed: float) -> dict[str, Spectrum]:
    return {n: specification.in_time(s, speed) for n, s in specification.spatial(air, SPAN).items()}


def crossings(law: dict[str, Spectrum], speed: float) -> dict[str, Spectrum]:
    """q is −∂w/∂x, r is ∂v/∂x: in frozen air that is passed at V, −(iω/V) w and (iω/V) v, averaged over the wings."""
    pitch, yaw = (specification.turned(speed, SPAN, factor) for factor in (4.0, 3.0))
    return {
        "wq": lambda omega: -pitch(omega) * law["w"](np.abs(omega)),
        "vr": lambda omega: yaw(omega) * law["v"](np.abs(omega)),
    }


def compared(values: Array, air: specification.Air, speed: float, rate: float) -> list[Finding]:
    law = laws(air, speed)
    return specification.judged(values, law, crossings(law, speed), 1.0 / rate)


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a flight asks for every 10 ms is bit for bit a record in one go, so a record may stand for it."""
    in_blocks = flown(steps=3000)
    monkeypatch.setattr(moving, "AHEAD", 3.0)
    assert np.array_equal(in_blocks, flown(steps=3000))
    assert in_blocks[:, :6].all()


def test_a_record_has_the_spectra_of_the_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """Variances, densities in bins of frequency, slopes, and cross-spectra of all pairs: 3 heights, 3 airspeeds."""
    found = []
    for height in HEIGHTS:
        for speed in SPEEDS:
            state = LEVEL._replace(height=height, airspeed=speed)
            values = recorded(monkeypatch, state, RATE, LENGTH, seed=round(1000 * height + speed))
            found += compared(values, specification.low(height, W20), speed, RATE)
    assert len(found) > 1500
    assert specification.holm(found) == []


def test_so_has_one_aloft(monkeypatch: pytest.MonkeyPatch) -> None:
    """Above 2000 ft all lengths are 1750 ft, and figure 7 gives the deviation: curve 4 at 3750 ft, 10.6 ft/s."""
    state = LEVEL._replace(height=3750 * FOOT)
    values = recorded(monkeypatch, state, RATE, LENGTH, seed=4, turbulence_severity=4)
    found = compared(values, specification.high(10.6 * FOOT), 32.0, RATE)
    assert specification.holm(found) == []


def test_across_the_wind_the_air_turns_by_u(monkeypatch: pytest.MonkeyPatch) -> None:
    """East, in air whose axis is north, u blows from the right to the left: r = −∂u/∂x, with the spectrum of u."""
    state = LEVEL._replace(heading=pi / 2.0)
    values = recorded(monkeypatch, state, RATE, LENGTH, seed=9)
    law = laws(specification.low(60.0, W20), 32.0)
    response = specification.turned(32.0, SPAN, 3.0)
    law["r"] = lambda omega: np.abs(response(omega)) ** 2 * laws(specification.low(60.0, W20), 32.0)["u"](omega)
    crossed = {
        "wq": crossings(law, 32.0)["wq"],
        "ur": lambda omega: -response(omega) * law["u"](np.abs(omega)),
    }
    assert specification.holm(specification.judged(values, law, crossed, 1.0 / RATE)) == []


@pytest.mark.parametrize(
    "wrong",
    [
        ("sd_u", 1.35), ("sd_v", 1.3), ("sd_w", 1.12), ("along", 1.3), ("across", 1.3), ("down", 1.15),
    ],
)  # fmt: skip
def test_smallest_effects(monkeypatch: pytest.MonkeyPatch, wrong: tuple[str, float]) -> None:
    """Of one record of 400 s at 60 m and 32 m/s: a law that is off by so much is told from the record's."""
    values = recorded(monkeypatch, LEVEL, RATE, LENGTH, seed=60032)
    name, factor = wrong
    right = specification.low(60.0, W20)
    assert specification.holm(compared(values, right, 32.0, RATE)) == []
    off = replace(right, **{name: factor * getattr(right, name)})
    assert specification.holm(compared(values, off, 32.0, RATE)) != []


def test_an_hour_and_forty_minutes_of_u_hold_870_independent_values() -> None:
    """6000 s at 60 m and 32 m/s: L/V = 6.9 s, and the variance is known to ±10 % (2 standard deviations)."""
    law = laws(specification.low(60.0, W20), 32.0)["u"]
    variance, freedom = specification.of_record(law, 60_000, 0.1)
    assert freedom == pytest.approx(872, rel=0.02)
    assert variance == pytest.approx(specification.low(60.0, W20).sd_u ** 2, rel=1e-3)


@pytest.mark.parametrize("model", ["mil-f-8785c", "mil-hdbk-1797"])
def test_either_specification_flies_the_same_air(model: str) -> None:
    assert np.array_equal(flown(), flown(environment=replace(ROUGH, turbulence_model=model)))  # type: ignore[arg-type]


# -- by height and airspeed --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("elevation", [-400.0, 0.0, 1219.2, 3000.0])
def test_height_counts_from_the_ground(elevation: float) -> None:
    """On every field the same seed gives the same air, bit for bit."""
    assert np.array_equal(flown(), flown(environment=replace(ROUGH, ground_elevation=elevation)))


@pytest.mark.parametrize("height", [-2.0, 0.0, 1.5, 3.0])
def test_below_10_ft_it_is_as_at_10_ft(height: float) -> None:
    assert flown(LEVEL._replace(height=height)) == pytest.approx(flown(LEVEL._replace(height=3.048)), rel=1e-12)


def test_above_10_ft_height_tells() -> None:
    assert flown(LEVEL._replace(height=3.2)) != pytest.approx(flown(LEVEL._replace(height=3.048)), rel=1e-3)


@pytest.mark.parametrize("speed", [0.0, 0.4, 1.0])
def test_slower_than_1_m_s_it_passes_at_1_m_s(speed: float) -> None:
    found = flown(LEVEL._replace(airspeed=speed))
    assert np.array_equal(found, flown(LEVEL._replace(airspeed=1.0)))
    assert np.isfinite(found).all()
    assert not np.array_equal(found, flown(LEVEL._replace(airspeed=1.1)))


@pytest.mark.parametrize("height", [304.8, 310.0, 381.0, 457.2, 600.0, 609.6, 700.0])
def test_between_1000_and_2000_ft_the_variances_blend(height: float) -> None:
    """√(1 − k) of the air of 1000 ft and √k of that of 2000 ft, which are independent: to rounding, 1e-12."""
    k = min(max((height / FOOT - 1000.0) / 1000.0, 0.0), 1.0)
    turned_state = State(height, 0.0, 32.0, 0.3, -0.2, 0.7)
    below, above = flown(turned_state._replace(height=304.8)), flown(turned_state._replace(height=609.7))
    share = np.sqrt(k) * dryden.sd_above(height, 3) / dryden.sd_above(609.7, 3)
    found = flown(turned_state)
    assert found[:, :6] == pytest.approx(np.sqrt(1.0 - k) * below[:, :6] + share * above[:, :6], abs=1e-12)


def test_the_two_altitudes_are_independent() -> None:
    """First values of 400 seeds; six correlations within 3.1/√400, 1 % over all: 0.22 is seen nine times in ten."""
    low, high = (
        np.array([flown(LEVEL._replace(height=h), steps=1, seed=s)[0, :6] for s in range(400)]) for h in (304.8, 609.7)
    )
    for i in range(6):
        assert abs(np.corrcoef(low[:, i], high[:, i])[0, 1]) < 0.16


def test_its_first_row_is_that_of_air_that_has_always_blown() -> None:
    """Of 200 seeds at 5 m, where L_u is seven times L_w: variances of all six, χ² with Holm at 1 %; 1.5 is seen."""
    state = LEVEL._replace(height=5.0)
    first = np.array([flown(state, steps=1, seed=s)[0, :6] for s in range(200)])
    findings = []
    for i, (name, law) in enumerate(laws(specification.low(5.0, W20), 32.0).items()):
        variance, _ = specification.of_record(law, 4000, 1e-3)
        findings.append(specification.of_power(name, float(np.mean(first[:, i] ** 2)) / variance, 200.0))
    assert specification.holm(findings) == []


def test_seeds_differ_and_repeat() -> None:
    assert np.array_equal(flown(seed=3), flown(seed=3))
    assert not np.isclose(flown(seed=3)[:, :6], flown(seed=4)[:, :6]).any()


def test_none_is_none_at_any_height() -> None:
    for height in (60.0, 500.0, 900.0):
        state = LEVEL._replace(height=height)
        assert not flown(state, EnvironmentSettings(turbulence_severity=7)).any()


def test_within_a_block_the_law_goes_on_as_the_aircraft_climbs() -> None:
    """At 20 m/s up, the deviations of each step are those of its own height; the filters are those of the first's."""
    level, climbing = flown(steps=10), flown(LEVEL._replace(climb=20.0), steps=10)
    for i in (0, 5, 9):
        there, here = (specification.low(60.0 + climb * 1e-3 * i, W20) for climb in (0.0, 20.0))
        assert climbing[i, :2] == pytest.approx(level[i, :2] * here.sd_u / there.sd_u, rel=1e-12)
        assert climbing[i, 2] == pytest.approx(level[i, 2], rel=1e-12)
        roll = (here.down / there.down) ** (-1.0 / 3.0)
        assert climbing[i, 3] == pytest.approx(level[i, 3] * roll, rel=1e-9)


# -- axes --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("towards", [0.0, 35.0, 90.0, 200.0, 300.0])
def test_low_down_it_turns_with_the_wind(towards: float) -> None:
    """u along the mean wind, v to its right, w down, whatever the attitude; p, q, r by how it heads to the wind."""
    angle = radians(towards)
    reference = flown()
    found = flown(LEVEL._replace(heading=angle, roll=0.4, pitch=-0.3), replace(ROUGH, wind_from_deg=towards - 180.0))
    u, v = reference[:, 0], reference[:, 1]
    assert found[:, 0] == pytest.approx(cos(angle) * u - sin(angle) * v, abs=1e-12)
    assert found[:, 1] == pytest.approx(sin(angle) * u + cos(angle) * v, abs=1e-12)
    assert found[:, 2:6] == pytest.approx(reference[:, 2:6], abs=1e-12)


def test_against_the_wind_r_changes_its_sign() -> None:
    assert flown(LEVEL._replace(heading=pi))[:, 5] == pytest.approx(-flown()[:, 5], abs=1e-12)
    assert flown(LEVEL._replace(heading=pi))[:, 3:5] == pytest.approx(flown()[:, 3:5], abs=1e-12)


@pytest.mark.parametrize(
    "attitude", [(0.0, 0.0, 1.1), (0.0, 0.6, 0.0), (0.8, 0.0, 0.0), (0.4, -0.7, 2.5), (3.0, 1.2, -2.0)]
)
def test_aloft_it_turns_with_the_body(attitude: tuple[float, float, float]) -> None:
    """u forward, v right, w down of the body, turned about z, y, x one after another; p, q, r as they are."""
    roll, pitch, heading = attitude
    state = LEVEL._replace(height=800.0)
    level = flown(state)
    about_x = np.array([[1, 0, 0], [0, cos(roll), -sin(roll)], [0, sin(roll), cos(roll)]])
    about_y = np.array([[cos(pitch), 0, sin(pitch)], [0, 1, 0], [-sin(pitch), 0, cos(pitch)]])
    about_z = np.array([[cos(heading), -sin(heading), 0], [sin(heading), cos(heading), 0], [0, 0, 1]])
    found = flown(state._replace(roll=roll, pitch=pitch, heading=heading))
    assert found[:, :3] == pytest.approx(level[:, :3] @ (about_z @ about_y @ about_x).T, abs=1e-12)
    assert np.array_equal(found[:, 3:6], level[:, 3:6])


# -- the compiled loop -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("height", [2.0, 60.0, 450.0, 900.0])
@pytest.mark.parametrize("profile", ["log", "power", "uniform"])
def test_machine_code_does_what_python_does(height: float, profile: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Mean wind that veers, in a climb, with every attitude: 1e-12, as both round alike but for the libraries' exp."""
    environment = replace(ROUGH, wind_speed=7.0, wind_veer=20.0, wind_profile=profile)  # type: ignore[arg-type]
    state = State(height, 6.0, 31.0, 0.3, 0.2, -1.0)
    compiled = flown(state, environment)
    monkeypatch.setattr(moving, "blow", SimpleNamespace(code=moving.blow.function))
    for name in ("filters", "_of", "low_lengths"):
        monkeypatch.setattr(moving, name, getattr(moving, name).function)
    for name in ("advance", "coefficients", "roll_deviation", "speed_at", "towards_at"):
        monkeypatch.setattr(moving, name, getattr(moving, name).function)
    for name in ("mean_of_first", "mean_of_second", "ramp", "ramp2"):
        monkeypatch.setattr(dryden, name, getattr(dryden, name).function)
    assert flown(state, environment) == pytest.approx(compiled, rel=1e-12, abs=1e-12)
