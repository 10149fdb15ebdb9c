"""What is doubtful about a log is said in words that name it, what is sound is not; silence is explained."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from uavsim.logs import Recording, replay_log
from uavsim.logs.evidence import Evidence, collected
from uavsim.logs.recording import Series
from uavsim.onboard.launch import DetectorSettings
from uavsim.truth import STANDARD_GRAVITY as G0
from uavsim.views import log as view

NAN = np.nan
Array = np.ndarray[Any, np.dtype[np.float64]]


def made(
    *, peak: float = 7.0, rate: float = 200.0, sigma: float = 1.0, onset: float = 3.0, lasting: float = 0.3,
    pitch: float = 12.0, seed: int = 5,
) -> Array:  # fmt: skip
    """Return six seconds on a rail with a trapezoid of so many g; columns t, fx, fy, fz, m/s²."""
    t = np.arange(round(6.0 * rate)) / rate
    push = peak * G0 * np.clip(np.minimum(t - onset, onset + lasting - t) / 0.015, 0.0, 1.0)
    noise = np.random.default_rng(seed).normal(0.0, sigma, (t.size, 3)).round(4)
    rest = G0 * np.array([np.sin(np.radians(pitch)), 0.0, -np.cos(np.radians(pitch))])
    force = noise + rest
    force[:, 0] += push
    return np.column_stack([t, force])


def recorded(readings: Array, mapping: str = "", **series: tuple[Array, Array]) -> Recording:
    held = {name: Series(name, t, values, "here") for name, (t, values) in series.items()}
    return Recording(("log.csv",), mapping, readings, (), held)


def told(recording: Recording, **settings: Any) -> tuple[list[float], str]:
    """Detections, and all remarks in one."""
    score = replay_log(recording, DetectorSettings(**settings)).score["recording"]
    return score["detections"], " | ".join(score["remarks"])


# -- what is sound ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [50.0, 104.0, 1000.0])
@pytest.mark.parametrize("sigma", [0.02, 0.3, 1.5])
@pytest.mark.parametrize("pitch", [0.0, 35.0, 90.0])
def test_a_sound_log_is_not_doubted(rate: float, sigma: float, pitch: float) -> None:
    found, said = told(recorded(made(rate=rate, sigma=sigma, pitch=pitch)))
    assert len(found) == 1
    assert said == ""


def test_a_log_that_is_cut_to_its_launch_is_not_doubted() -> None:
    readings = made()
    for first, last in ((560, 700), (590, 680), (0, 640), (602, 655)):
        found, said = told(recorded(readings[first:last]))
        assert (len(found), said) == (1, "")


def test_a_log_that_moves_all_the_time_is_not_doubted() -> None:
    """Vibration of 3 g rms, and a flight of turns at 1 to 3 g: no block of it says what rest reads."""
    readings = made(peak=0.0, sigma=3.0 * G0)
    assert "at rest" not in told(recorded(readings))[1]
    t = readings[:, 0]
    turning = np.column_stack([t, 2.0 + np.sin(3.0 * t), np.sin(7.0 * t), -G0 * (2.0 + np.sin(2.0 * t))])
    assert "at rest" not in told(recorded(turning))[1]


# -- unit ------------------------------------------------------------------------------------------------------------


def in_unit(readings: Array, one_g: float) -> Array:
    return np.column_stack([readings[:, 0], readings[:, 1:] * (one_g / G0)])


@pytest.mark.parametrize(("peak", "count"), [(2.4, 0), (7.0, 1)])
def test_feet_are_told_and_taken_as_such(peak: float, count: int) -> None:
    """A throw of 2.8 g is no launch of 4.5 g though its numbers are above 90; a catapult's is one."""
    readings = in_unit(made(peak=peak, rate=50.0), 32.174)
    found, said = told(recorded(readings))
    assert len(found) == count
    assert "ft/s²" in said
    assert "fx=…*0.3048" in said
    found, said = told(recorded(readings, "fx=ax*1,fy=ay*1,fz=az*1"))
    assert len(found) == 1
    assert "ft/s²" in said
    assert "doubtful" in said


@pytest.mark.parametrize("one_g", [16.0, 256.0, 340.0])
def test_counts_are_told_with_the_factor_that_mends_them(one_g: float) -> None:
    _, said = told(recorded(in_unit(made(), one_g)))
    assert "count" in said
    factor = float(said.partition("fx=…*")[2].partition(" ")[0])
    assert factor == pytest.approx(G0 / one_g, rel=0.03)
    found, said = told(recorded(in_unit(made(), factor * one_g)))
    assert (len(found), said) == (1, "")


@pytest.mark.parametrize("sigma", [0.05, 1.0])
def test_a_force_without_gravity_is_told(sigma: float) -> None:
    readings = made(sigma=sigma)
    readings[:, 1:] -= G0 * np.array([np.sin(np.radians(12.0)), 0.0, -np.cos(np.radians(12.0))])
    found, said = told(recorded(readings))
    assert len(found) == 1
    assert "gravity has been taken off" in said


def test_a_scale_that_is_off_is_told() -> None:
    assert "at rest |f| reads 1.25 g and not 1 g" in told(recorded(in_unit(made(sigma=0.2), 1.25 * G0)))[1]


def test_one_axis_is_not_doubted_unless_it_reads_more_than_gravity() -> None:
    readings = made()
    readings[:, 2:] = NAN
    found, said = told(recorded(readings))
    assert (len(found), said) == (1, "")
    readings[:, 1] *= 40.0
    assert "counts" in told(recorded(readings))[1]


# -- axes ------------------------------------------------------------------------------------------------------------


def turned(readings: Array, x: str, y: str, z: str) -> Array:
    """Return readings with other axes: each a sign and a letter."""
    columns = ["xyz".index(axis[1]) for axis in (x, y, z)]
    signs = [1.0 if axis[0] == "+" else -1.0 for axis in (x, y, z)]
    return np.column_stack([readings[:, 0], readings[:, 1:][:, columns] * signs])


@pytest.mark.parametrize(
    ("axes", "words", "launches"),
    [
        (("+x", "-y", "-z"), ("z up", "fy=-fy,fz=-fz"), 1),
        (("-y", "+x", "+z"), ("lies along +y", "'detector.axes=[\"+y\"]'"), 0),
        (("+y", "-x", "+z"), ("lies along −y", "'detector.axes=[\"-y\"]'"), 0),
        (("-x", "-y", "+z"), ("lies along −x", "'detector.axes=[\"-x\"]'"), 0),
        (("-z", "+y", "+x"), ("lies along +z",), 0),
    ],
)
def test_axes_that_are_not_ours_are_told(axes: tuple[str, str, str], words: tuple[str, ...], launches: int) -> None:
    recording = recorded(turned(made(), *axes))
    found, said = told(recording)
    assert len(found) == launches
    assert all(word in said for word in words)
    if not launches:
        axis = next(word for word in words if word.startswith("lies"))[-2:].replace("−", "-")
        assert len(told(recording, axes=(axis,))[0]) == 1


@pytest.mark.parametrize(("axes", "up"), [(("+x", "+z", "-y"), "−y points up"), (("+x", "-z", "+y"), "+y points up")])
def test_an_aircraft_on_its_side_is_told(axes: tuple[str, str, str], up: str) -> None:
    assert up in told(recorded(turned(made(), *axes)))[1]


def test_a_sensor_that_is_mounted_askew_is_told() -> None:
    readings = made(peak=5.5)
    c, s = np.cos(np.radians(45.0)), np.sin(np.radians(45.0))
    readings[:, 1:3] = readings[:, 1:3] @ np.array([[c, s], [-s, c]])
    found, said = told(recorded(readings))
    assert found == []
    assert "lies between two axes, +x" in said
    assert "askew" in said


def test_an_axis_that_never_changes_is_told() -> None:
    readings = made()
    readings[:, 1] = 0.0
    assert "fx repeats 0 m/s² from the first row to the last" in told(recorded(readings))[1]
    readings = made()
    readings[:, 2] = 0.0
    assert told(recorded(readings))[1] == ""  # the detector does not read it


def test_a_pull_against_the_launch_may_be_a_wrap() -> None:
    readings = made(peak=-3.0)
    assert "an arrest, or a wrap" in told(recorded(readings))[1]


# -- what readings cannot show ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("reach", "said_so"), [(2.0, True), (4.0, True), (5.0, True), (6.0, False)])
def test_a_range_below_what_the_detector_needs_is_told(reach: float, said_so: bool) -> None:
    """4.6 g are needed, and 1 g of the range is gravity's, as `fly` has it."""
    readings = made()
    readings[:, 1:] = np.clip(readings[:, 1:], -reach * G0, reach * G0)
    score = replay_log(recorded(readings)).score["recording"]
    assert [one["axis"] for one in score["clipping"]] == ["fx"]
    assert any(remark.startswith("range: fx ends at") for remark in score["remarks"]) is said_so


def test_a_launch_against_the_axis_clips_nothing_that_is_needed() -> None:
    readings = made(peak=-7.0)
    readings[:, 1:] = np.clip(readings[:, 1:], -2.0 * G0, 2.0 * G0)
    assert "range" not in told(recorded(readings))[1]


@pytest.mark.parametrize("times", [2, 3, 5, 10])
@pytest.mark.parametrize("one_axis", [False, True])
def test_held_samples_are_no_clipping(times: int, one_axis: bool) -> None:
    readings = made(rate=400.0)
    readings[:, 1:] = np.repeat(readings[::times, 1:], times, axis=0)[: len(readings)]
    if one_axis:
        readings[:, 2:] = NAN
    recording = recorded(readings)
    assert recording.clipping() == []
    assert told(recording)[1] == ""
    readings[:, 1] = np.minimum(readings[:, 1], 5.0 * G0)
    assert [one.axis for one in recorded(readings).clipping()] == ["fx"]


def test_the_logs_own_counters_are_believed() -> None:
    """Filtered after it was clipped, so that no value is held; and an equal extreme that is none."""
    readings = made(peak=5.0)
    t = readings[::20, 0]
    counts = np.cumsum((t >= 3.0) & (t < 3.3)).astype(float)
    still = np.zeros(t.size)
    score = replay_log(recorded(readings, clips_x=(t, counts), clips_y=(t, still))).score["recording"]
    assert any("counter has 3 readings of fx from" in remark for remark in score["remarks"])
    assert [one["axis"] for one in score["clipping"]] == ["fx"]
    readings[610:620, 1] = readings[:, 1].max()
    assert replay_log(recorded(readings, clips_x=(t, still))).score["recording"]["clipping"] == []


@pytest.mark.parametrize("rate", [50.0, 1000.0])
def test_readings_that_repeat_through_the_launch_are_told(rate: float) -> None:
    readings = made(rate=rate)
    first, last = round(2.9 * rate), round(4.2 * rate)
    readings[first:last, 1:] = readings[first, 1:]
    found, said = told(recorded(readings))
    assert found == []
    assert "readings repeat for 1.3 s from 2.900 s on" in said or "readings repeat for 1.28 s from 2.900 s on" in said


def test_one_axis_that_repeats_through_the_launch_is_told() -> None:
    readings = made()
    readings[580:840, 1] = readings[580, 1]
    found, said = told(recorded(readings))
    assert found == []
    assert "fx repeats for 1.3 s from 2.900 s on (260 rows)" in said
    cut = np.split(readings, [3, 585, 600, 839])
    parts = Evidence(200.0)
    for part in cut:
        parts.add(part)
    assert [(spell.start, spell.rows) for spell in parts.stuck["fx"]] == [(2.9, 260)]


def test_coarse_readings_of_a_quiet_sensor_are_no_repetition() -> None:
    readings = made(sigma=0.02)
    readings[:, 1:] = np.round(readings[:, 1:] / 0.3) * 0.3
    assert "repeat" not in told(recorded(readings))[1]


@pytest.mark.parametrize(
    ("change", "disagrees"),
    [
        (lambda f: f, False),
        (lambda f: 1.05 * f + 1.0, False),
        (lambda f: 0.5 * f, True),
        (lambda f: f * [1, -1, -1], True),
    ],
)
def test_two_accelerometers_that_disagree_are_told(change: Any, disagrees: bool) -> None:
    readings, other = made(), made(seed=6, rate=50.0)
    other[:, 0] += 0.003
    other[:, 1:] = change(other[:, 1:])
    _, said = told(replace(recorded(readings), others={"IMU[1]": other}))
    assert ("two IMUs disagree: IMU[1]" in said) is disagrees


def test_evidence_does_not_depend_on_how_it_is_cut() -> None:
    readings = made()
    readings[500:760, 1:] = readings[500, 1:]
    readings[900, 1:] = NAN
    whole, parts = collected(readings, 200.0), Evidence(200.0)
    for block in np.split(readings, [1, 2, 7, 499, 501, 505, 759, 760, 761, 1100]):
        parts.add(block)
    assert parts.repeats == whole.repeats
    assert [(spell.start, spell.rows) for spell in whole.repeats] == [(2.5, 260)]
    assert parts.stuck == whole.stuck == {}
    np.testing.assert_array_equal(parts.rest().vectors, whole.rest().vectors)


# -- no launch -------------------------------------------------------------------------------------------------------


def test_no_launch_is_explained() -> None:
    """A throw of 2.4 g besides gravity: seen, needed, and what would have seen it does."""
    recording = recorded(made(peak=2.4, sigma=0.3))
    flight = replay_log(recording)
    why = flight.score["recording"]["unseen"]
    greatest = {one["axis"]: one["greatest"] / G0 for one in why["seen"]}
    assert greatest["+x"] == pytest.approx(2.7, abs=0.15)
    assert why["level"] == pytest.approx(4.6 * G0, rel=1e-3)
    assert next(one["above"] for one in why["seen"] if one["axis"] == "+x") == 0.0
    assert {one["set"].partition("=")[0] for one in why["nearest"]} == {"detector.threshold", "detector.kind"}
    level = float(why["nearest"][0]["set"].partition("=")[2])
    assert told(recording, threshold=level)[0] == [pytest.approx(why["nearest"][0]["detected"])]
    assert 2.0 * G0 < level < 2.7 * G0
    kinds = {one["set"].partition("=")[2] for one in why["nearest"][1:]}
    assert kinds == {"ardupilot", "inav", "paparazzi", "altos"}
    for kind in kinds:
        assert told(recording, kind=kind)[0]
    said = "\n".join(view.lines(flight))
    assert "seen: the greatest forces are +x 2." in said
    assert "needed: more than 4.6 g along +x" in said
    assert "nearest: --set detector." in said


def test_how_long_it_was_above_the_level_is_told() -> None:
    readings = made(peak=0.0)
    readings[600:601, 1] += 12.0 * G0
    why = replay_log(recorded(readings)).score["recording"]["unseen"]
    assert next(one["above"] for one in why["seen"] if one["axis"] == "+x") == pytest.approx(0.005)
    assert why["nearest"] == []


def test_a_pull_up_is_no_launch_along_another_axis() -> None:
    """A throw, and turns of up to 6 g in the flight after it: no axis is doubted for them."""
    readings = made(peak=2.4, sigma=0.3)
    t = readings[:, 0]
    turn = np.clip((t - 4.0) / 0.8, 0.0, 1.0) * (t < 5.5)
    readings[:, 3] -= 5.0 * G0 * turn
    recording = recorded(readings)
    assert told(recording) == ([], "")
    assert told(recording, axes=("-z",))[0] != []


def test_where_there_is_nothing_nothing_is_named() -> None:
    flight = replay_log(recorded(made(peak=0.0)))
    assert flight.score["recording"]["unseen"]["nearest"] == []
    assert view.lines(flight)[-1] == "  nearest: no axis, kind or lower level would have seen one"


def test_each_part_of_a_log_is_looked_at_by_itself() -> None:
    parts = np.concatenate([made(peak=0.0), made(peak=3.0)])
    recording = replace(recorded(parts), cuts=(1200,))
    nearest = replay_log(recording).score["recording"]["unseen"]["nearest"]
    assert nearest[0]["detected"] == pytest.approx(3.03, abs=0.08)


# -- what else a log tells -------------------------------------------------------------------------------------------


def test_rules_that_take_gravity_off_do_it_by_the_logs_attitude() -> None:
    """Pitched from 80° to level within 0.2 s while pushed by 2.8 g: no 30 m/s² without gravity, whatever f_x reads."""
    t = np.arange(1200) / 200.0
    pitch = np.radians(np.interp(t, [3.0, 3.2], [-80.0, 75.0]))
    push = np.where((t > 3.3) & (t < 3.8), 2.5 * G0, 0.0)
    readings = np.column_stack([t, push + G0 * np.sin(pitch), 0.0 * t, -G0 * np.cos(pitch)])
    attitude = {"roll": (t[::10], 0.0 * t[::10]), "pitch": (t[::10], pitch[::10])}
    assert told(recorded(readings), kind="px4")[0]
    found, said = told(recorded(readings, **attitude), kind="px4")
    assert found == []
    assert "told the log's attitude" in said


def test_a_rule_by_magnitude_is_doubted_where_the_force_pulls_backwards() -> None:
    readings = made(peak=-8.0)
    found, said = told(recorded(readings), kind="px4-norm")
    assert len(found) == 1
    assert "along −x, backwards" in said
    assert told(recorded(made()), kind="px4-norm")[1] == ""


def test_inav_has_its_satellites_where_the_log_has_them() -> None:
    """A throw of 1.5 g, too weak for its level: the speed of 6 satellites decides, when it is told."""
    readings = made(peak=1.2, sigma=0.1)
    t = np.arange(0.0, 6.0, 0.2)
    speed = np.where(t > 3.3, 9.0, 0.2)
    tells = {"north_speed": (t, speed), "east_speed": (t, 0.0 * speed), "satellites": (t, 0.0 * t + 8.0)}
    assert told(recorded(readings), kind="inav")[0] == []
    assert told(recorded(readings, **tells), kind="inav")[0][0] == pytest.approx(3.44, abs=0.02)
    ground = {"ground_speed": (t, speed), "satellites": tells["satellites"]}
    assert told(recorded(readings, **ground), kind="inav")[0][0] == pytest.approx(3.44, abs=0.02)
    tells["satellites"] = (t, 0.0 * t + 5.0)
    assert told(recorded(readings, **tells), kind="inav")[0] == []
