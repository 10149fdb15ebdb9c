"""The end of the stroke over arrays: the same decisions as those of the flight computer, to the last bit."""

import math

import numpy as np
import pytest

from uavsim.onboard.flight_computer import FlightComputer, FlightComputerSettings
from uavsim.onboard.interface import Estimator
from uavsim.onboard.launch import DetectorSettings, build
from uavsim.onboard.stroke import Stroke, follow, samples_of
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import DISTURBANCES
from uavsim.studies.wing_commands import commands, decide

G = 9.80665  # m/s²
RATE = 1000.0  # Hz
SETTINGS = FlightComputerSettings()
ANSWERS = ("stroke_end", "not_a_launch")


class Silent(Estimator):
    """Estimates nothing."""

    def step(self, *reading: float) -> None:
        return None


def flown(kind: DetectorSettings, force: np.ndarray, computer: FlightComputerSettings, rate: float = RATE) -> list:
    """What flight computers make of a record; one whose wings are out gives way to one that goes on as after a knock.

    Each decision as recognised at, over at, launch, speed gained.
    """
    box = FlightComputer(computer, build(kind, rate), Silent(), rate)
    found = []
    for k, row in enumerate(force.tolist()):
        before = len(box.events)
        box.accelerometer(k / rate, *row)
        for event in box.events[before:]:
            if event["event"] == "launch_detected":
                recognised = k
            if event["event"] in ANSWERS:
                found.append((recognised, k, event["event"] == "stroke_end", event["speed_gain"]))
        if box.state == "coasting":
            box.state, box._next_action = "rearming", k / rate + computer.rearm_delay
    return found


def knocks(seconds: float = 12.0) -> np.ndarray:
    """Rest, knocks, a push of 6 g for 0.3 s, a load of 4.1 g that stays, and readings that are none."""
    t = np.arange(round(seconds * RATE)) / RATE
    noise = np.random.default_rng(3).standard_normal((t.size, 3)) * 0.3 * G
    force = noise + np.array([1.7, 0.0, -9.6])
    for begin, length, g in ((1.2, 0.02, 9.0), (2.5, 0.3, 6.0), (4.1, 0.02, 12.0), (6.0, 5.0, 4.1), (7.3, 0.1, 3.0)):
        force[(t >= begin) & (t < begin + length), 0] += g * G
    force[[700, 1300, 2550, 2600, 6500]] = [[math.nan] * 3, [1e9] * 3, [math.inf] * 3, [math.nan] * 3, [-1e9] * 3]
    return force


@pytest.mark.parametrize(
    "kind",
    [
        DetectorSettings(),
        DetectorSettings(kind="px4-norm"),
        DetectorSettings(kind="single-threshold", threshold=20.0, window=0.003),
        DetectorSettings(kind="multi-level-window"),
        DetectorSettings(kind="ardupilot"),
    ],
    ids=lambda one: one.kind,
)
@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
def test_decisions_are_those_of_the_flight_computer(kind: DetectorSettings, single: bool) -> None:
    force = knocks().astype(np.float32) if single else knocks()
    detector = BatchDetector(kind, RATE)
    first = int(detector.first([force])[0])
    found = list(decide(detector, force, SETTINGS, first=first))
    expected = flown(kind, force, SETTINGS)
    assert [(one.recognised, one.over, one.launch) for one in found] == [one[:3] for one in expected]
    assert any(one.launch for one in found)
    if kind == DetectorSettings():
        assert [one.launch for one in found] == [False, True, False, False]  # a knock, the push, two knocks
    opened = commands(detector, force, SETTINGS, first=first)
    assert opened.tolist() == [over for _, over, launch, _ in expected if launch]


def test_settings_of_the_computer_are_its_own() -> None:
    other = FlightComputerSettings(
        stroke_end_level_g=0.6, stroke_end_mean=0.015, stroke_end_hold=0.03, speed_gain_min=17.0, rearm_delay=0.4
    )
    kind = DetectorSettings()
    detector = BatchDetector(kind, RATE)
    first = int(detector.first([knocks()])[0])
    found = [(d.recognised, d.over, d.launch) for d in decide(detector, knocks(), other, first=first)]
    assert found == [one[:3] for one in flown(kind, knocks(), other)]
    usual = [(d.recognised, d.over, d.launch) for d in decide(detector, knocks(), SETTINGS, first=first)]
    assert found != usual


def test_the_speed_gained_is_the_same_to_the_last_bit() -> None:
    force = knocks()
    (_, over, _, gained), *_ = [one for one in flown(DetectorSettings(), force, SETTINGS) if one[2]]
    recognised = next(one[0] for one in flown(DetectorSettings(), force, SETTINGS) if one[2])
    stroke = Stroke(SETTINGS.stroke_end_level_g * G, SETTINGS.stroke_end_mean, SETTINGS.stroke_end_hold, RATE)
    for k in range(recognised + 1):
        stroke.rest(k / RATE, float(force[k, 0]))
    stroke.begin(recognised / RATE)
    state, room = np.array([0.0, np.nan, 0.0]), np.zeros(2 * samples_of(SETTINGS.stroke_end_mean, RATE))
    axial = np.ascontiguousarray(force[:, 0])
    level, hold = SETTINGS.stroke_end_level_g * G, SETTINGS.stroke_end_hold
    assert follow(axial, 0, recognised, RATE, level, hold, room, state) == over
    for k in range(recognised + 1, over + 1):
        assert stroke.follow(k / RATE, float(force[k, 0])) is (k == over)
    assert state[2] == stroke.speed_gain
    assert state[0] == stroke.rail_mean
    assert gained == pytest.approx(stroke.speed_gain, abs=1.0)  # the flight computer's rail began anew after a knock


def test_a_soft_drop_opens_no_wings() -> None:
    """The detector takes most of those along the axis for launches; the speed gained is that of 12 g for 25 ms."""
    piece = DISTURBANCES["soft drops"].piece(3, 0, RATE, (0,))[:120_000]
    detector = BatchDetector(DetectorSettings(), RATE)
    alarms = detector.alarms(piece[:, 0])
    assert alarms.size > 5
    decisions = list(decide(detector, piece[:, 0], SETTINGS, first=int(alarms[0])))
    assert decisions
    assert not any(one.launch for one in decisions)
    eager = FlightComputerSettings(speed_gain_min=0.2)
    assert commands(detector, piece[:, 0], eager, first=int(alarms[0])).size > 0


@pytest.mark.parametrize("axis", ["-x", "+y", "-z"])
def test_the_speed_is_gained_along_the_detectors_axis(axis: str) -> None:
    place, sign = "xyz".index(axis[1]), -1.0 if axis[0] == "-" else 1.0
    force = np.zeros((4000, 3))
    force[2000:2300, place] = sign * 8.0 * G
    detector = BatchDetector(DetectorSettings(axes=(axis,)), RATE)
    (one,) = decide(detector, force, SETTINGS, first=int(detector.first([force])[0]))
    assert one.launch
    assert 2300 <= one.over < 2340


def test_a_record_without_an_alarm_decides_nothing() -> None:
    detector = BatchDetector(DetectorSettings(), RATE)
    assert not list(decide(detector, np.zeros((100, 3)), SETTINGS, first=-1))
