"""Gusts by themselves and in the truth of a flight.

Authority: the one-minus-cosine gust of MIL-F-8785C 3.7.2.3 and CS-23.333 (c), ½ V_m (1 − cos 2π t/length), and the
definition of each direction and event. A flight's truth is held to 1e-9 m/s.
"""

from itertools import pairwise
from math import cos, inf, pi, radians, sin
from typing import Any

import numpy as np
import pytest

from uavsim.plants.air.gusts import Gusts, direction, share
from uavsim.plants.air.settings import EnvironmentSettings, GustSettings
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Run
from uavsim.plants.settings import LauncherSettings

RELEASE = 0.2  # s


def still(*gusts: GustSettings) -> EnvironmentSettings:
    return EnvironmentSettings(gusts=gusts)


def truth_of(*gusts: GustSettings, duration: float = 0.6, heading: float = 0.0, **more: Any) -> dict[str, np.ndarray]:
    """Truth of a launch without an onboard computer."""
    environment = EnvironmentSettings(gusts=gusts, **more)
    plant = JsbsimPlant(Run(environment, LauncherSettings(heading_deg=heading), duration, RELEASE))
    for _ in range(round(duration * 1000)):
        plant.step()
    return plant.truth()


def wind(truth: dict[str, np.ndarray]) -> np.ndarray:
    return np.column_stack([truth[f"wind_{axis}"] for axis in "ned"])


def gust(truth: dict[str, np.ndarray]) -> np.ndarray:
    return np.column_stack([truth[f"gust_{axis}"] for axis in "ned"])


# -- shape and direction -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", [0.1, 2.0, 20.0])
def test_one_minus_cosine(length: float) -> None:
    shape = GustSettings(3.0, length_s=length)
    for since in np.linspace(0.0, length * 0.999, 40):
        assert share(shape, since) == pytest.approx(0.5 * (1.0 - cos(2.0 * pi * since / length)), abs=1e-12)
    assert share(shape, length / 2.0) == pytest.approx(1.0)
    assert share(shape, length / 4.0) == pytest.approx(0.5)
    assert share(shape, -1e-9) == share(shape, length) == share(shape, 1e3) == 0.0


def test_it_lasts_2_s_where_nothing_is_said_and_a_step_stays() -> None:
    assert share(GustSettings(3.0), 1.0) == pytest.approx(1.0)
    assert share(GustSettings(3.0), 2.0) == 0.0
    step = GustSettings(3.0, shape="step")
    assert [share(step, t) for t in (-1e-9, 0.0, 1e-3, 1e6)] == [0.0, 1.0, 1.0, 1.0]
    short = GustSettings(3.0, shape="step", length_s=0.5)
    assert [share(short, t) for t in (0.0, 0.499, 0.5)] == [1.0, 1.0, 0.0]


@pytest.mark.parametrize("heading", [0.0, 40.0, 180.0, -75.0])
def test_directions(heading: float) -> None:
    """By axes of the launch: forward, to the right, down."""
    north, east = cos(radians(heading)), sin(radians(heading))
    forward, right = np.array([north, east, 0.0]), np.array([-east, north, 0.0])
    asked = {
        "head": -forward, "tail": forward, "left": right, "right": -right,
        "up": np.array([0.0, 0.0, -1.0]), "down": np.array([0.0, 0.0, 1.0]),
    }  # fmt: skip
    for side, vector in asked.items():
        assert direction(GustSettings(direction=side), radians(heading)) == pytest.approx(vector, abs=1e-12)  # type: ignore[arg-type]


def test_a_gust_of_no_speed_is_none_and_the_short_keys_are_one_more() -> None:
    environment = EnvironmentSettings(gust_speed=2.0, gusts=(GustSettings(0.0), GustSettings(1.0, "up")))
    assert [g.speed for g in environment.all_gusts] == [2.0, 1.0]
    assert EnvironmentSettings().all_gusts == ()


# -- waiting -----------------------------------------------------------------------------------------------------------


def at(gusts: Gusts, time: float) -> tuple[float, float, float]:
    north, east, down = gusts.over(np.array([time]))[0].tolist()
    return north, east, down


def test_only_the_first_of_an_event_counts() -> None:
    gusts = Gusts(still(GustSettings(3.0, shape="step", delay=1.0)), 0.0)
    assert gusts.awaited == {"wing-out"}
    gusts.tell("release", 0.5)
    assert at(gusts, 100.0) == (0.0, 0.0, 0.0)
    gusts.tell("wing-out", 2.0)
    gusts.tell("wing-out", 7.0)
    assert gusts.awaited == set()
    assert at(gusts, 2.999) == (0.0, 0.0, 0.0)
    assert at(gusts, 3.0) == pytest.approx((-3.0, 0.0, 0.0))


def test_several_add_and_the_next_is_known() -> None:
    one = GustSettings(3.0, "tail", "step", "time", 1.0, 1.0)
    two = GustSettings(-2.0, "up", "step", "time", 1.5, 1.0)
    three = GustSettings(1.0, "left", "step", "time", 4.0)
    gusts = Gusts(still(one, two, three), 0.0)
    assert gusts.following(0.0) == inf
    gusts.tell("time", 0.0)
    assert gusts.following(0.0) == 1.0
    assert at(gusts, 1.2) == pytest.approx((3.0, 0.0, 0.0))
    assert at(gusts, 1.7) == pytest.approx((3.0, 0.0, 2.0))
    assert at(gusts, 2.2) == pytest.approx((0.0, 0.0, 2.0))
    assert gusts.following(2.2) == 2.2
    assert gusts.following(3.0) == 4.0
    assert at(gusts, 9.0) == pytest.approx((0.0, 1.0, 0.0))
    times = np.arange(0.0, 6.0, 1e-3)
    assert np.array_equal(gusts.over(times), [at(gusts, t) for t in times.tolist()])


def test_it_is_over_when_nothing_follows() -> None:
    """Beginning and length are sums of decimals: what blows and what follows must round alike."""
    for begin in np.arange(0.0, 2.0, 0.021).tolist():
        for length in (0.1, 0.3, 0.7):
            gusts = Gusts(still(GustSettings(3.0, "tail", "step", "time", begin, length)), 0.0)
            gusts.tell("time", 0.0)
            times = np.arange(round((begin + length + 0.01) * 1000)) / 1000.0
            over = [gusts.following(t) == inf for t in times.tolist()]
            assert not gusts.over(times)[over].any(), (begin, length)


# -- in flight ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("begin", [0.077, 0.25, 0.259])
def test_a_step_of_some_length_ends_in_the_truth(begin: float) -> None:
    """The wind is again what it was, to the step, and the truth's columns close."""
    truth = truth_of(GustSettings(2.0, "tail", "step", "time", begin, 0.1))
    assert wind(truth) == pytest.approx(gust(truth), abs=1e-9)
    blows = np.flatnonzero(wind(truth)[:, 0] > 1e-9)
    assert len(blows) in (100, 101)
    assert blows[0] == round(begin * 1000) + 1  # it acts through the step that begins with it
    assert np.ptp(wind(truth)[blows, 0]) < 1e-9
    assert not wind(truth)[blows[-1] + 1 :].any()


def test_mean_wind_and_gusts_add_up_to_the_wind() -> None:
    """Without turbulence there is nothing else: zero to 1e-9 m/s at every row, with gusts that begin on any row."""
    gusts = [GustSettings(1.0, "left", "step", "time", d / 1000, 0.05) for d in (3, 77, 150, 211, 300, 403)]
    down = GustSettings(3.0, "down", at="release", delay=0.1, length_s=0.2)
    truth = truth_of(*gusts, down, wind_speed=4.0, wind_veer=30.0)
    mean = np.column_stack([truth["mean_wind_n"], truth["mean_wind_e"], np.zeros(len(truth["t"]))])
    assert wind(truth) == pytest.approx(mean + gust(truth), abs=1e-9)
    assert np.ptp(truth["gust_e"]) == pytest.approx(1.0)


@pytest.mark.parametrize("side", ["head", "tail", "left", "right", "up", "down"])
def test_the_peak_reaches_the_truth_from_every_side(side: str) -> None:
    """From "time" at 0.1 s on, 0.4 s long: 5 m/s at 0.3 s, and the shape at every row."""
    peak = GustSettings(5.0, side, at="time", delay=0.1, length_s=0.4)  # type: ignore[arg-type]
    truth = truth_of(peak, heading=30.0)
    vector = np.array(direction(peak, radians(30.0)))
    begun = truth["t"] - 1e-3 - 0.1
    shape = np.where((begun >= 0.0) & (begun < 0.4), 0.5 * (1.0 - np.cos(2.0 * pi * begun / 0.4)), 0.0)
    assert wind(truth) == pytest.approx(5.0 * np.outer(shape, vector), abs=1e-9)
    assert np.abs(wind(truth) @ vector).max() == pytest.approx(5.0)


def test_events_of_the_launch() -> None:
    """Release by the launcher's clock; the rail's end at the last row before which a shoe was on it."""
    for event in ("release", "rail-exit"):
        plant = JsbsimPlant(
            Run(still(GustSettings(2.0, "right", "step", event, 0.0)), LauncherSettings(), 1.0, RELEASE)  # type: ignore[arg-type]
        )
        on_rail = [True]
        for _ in range(800):
            plant.step()
            on_rail.append(plant.on_rail)
        truth = plant.truth()
        first = int(np.flatnonzero(np.abs(truth["gust_e"]) > 0.0)[0])
        assert wind(truth) == pytest.approx(gust(truth), abs=1e-9)
        if event == "release":
            assert truth["t"][first] == pytest.approx(RELEASE + 1e-3)
        else:
            assert on_rail[first - 1]
            assert not on_rail[first]


def test_events_of_the_commands() -> None:
    """Wings commanded at 0.7 s, motor on at 0.8 s, each in the step that follows; the wing is out by its own column."""
    sides = {"wings-commanded": "north", "motor-on": "east", "wing-out": "down"}
    gusts = (
        GustSettings(1.0, "tail", "step", "wings-commanded", 0.0),
        GustSettings(1.0, "left", "step", "motor-on", 0.0),
        GustSettings(1.0, "down", "step", "wing-out", 0.0),
    )
    plant = JsbsimPlant(Run(still(*gusts), LauncherSettings(), 3.0, RELEASE))
    for k in range(2000):
        plant.command((float(k >= 700), 0.6 * (k >= 800), 0.0, 0.0, 0.0))
        plant.step()
    truth = plant.truth()
    assert wind(truth) == pytest.approx(gust(truth), abs=1e-9)
    first = {name: int(np.flatnonzero(np.abs(gust(truth)[:, i]) > 0.0)[0]) for i, name in enumerate(sides)}
    assert first["wings-commanded"] == 701
    assert first["motor-on"] == 801
    out = int(np.flatnonzero(truth["wing"] >= 0.99)[0])
    assert first["wing-out"] == out + 1
    assert plant.remarks == []


def test_one_comes_after_another_has_gone() -> None:
    """Still air between them, each by its own event: the second begins at the very step, and lasts its own length."""
    gusts = (
        GustSettings(2.0, "tail", "step", "time", 0.05, 0.05),
        GustSettings(3.0, "right", "one-minus-cosine", "wings-commanded", 0.1, 0.3),
    )
    plant = JsbsimPlant(Run(still(*gusts), LauncherSettings(), 1.2, RELEASE))
    for k in range(1200):
        plant.command((float(k >= 700), 0.0, 0.0, 0.0, 0.0))
        plant.step()
    truth = plant.truth()
    assert wind(truth) == pytest.approx(gust(truth), abs=1e-9)
    assert truth["gust_e"].min() == pytest.approx(-3.0)
    assert int(truth["gust_e"].argmin()) == 951  # half of 0.3 s after 0.8 s, in the step that begins then
    assert plant.remarks == []


def test_one_that_never_comes_is_remarked_on() -> None:
    late = GustSettings(2.0, "head", at="time", delay=100.0)
    plant = JsbsimPlant(Run(still(late, GustSettings(3.0)), LauncherSettings(), 0.3, RELEASE))
    assert plant.remarks == []  # before it has flown nothing is late
    for _ in range(300):
        plant.step()
    assert plant.remarks == [
        "the gust of 2 m/s (head, at time) never came: it was to begin at 100.00 s, and the flight ended at 0.30 s",
        "the gust of 3 m/s (head, at wing-out) never came: its event did not",
    ]


def test_a_gust_is_felt_in_the_step_that_it_begins_with() -> None:
    """JSBSim evaluates winds before forces: airspeed and specific force jump in the row of the wind."""
    calm, gusty = truth_of(), truth_of(GustSettings(10.0, "head", "step", "time", 0.5))
    first = int(np.flatnonzero(gust(gusty)[:, 0])[0])
    for name in ("airspeed", "fx", "mach", "p_total"):
        difference = np.abs(gusty[name] - calm[name])
        assert not difference[:first].any()
        assert difference[first] > 0.0
    assert gusty["airspeed"][first] - calm["airspeed"][first] == pytest.approx(10.0, rel=0.05)
    drag = [calm["fx"][first], gusty["fx"][first]]
    assert all(a > b for a, b in pairwise(drag))
