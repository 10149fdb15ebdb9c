"""The sets: a part of one has its levels as the whole has them, and its flights are flights of the whole."""

from collections import Counter

import pytest

from uavsim.scenario import load_scenario
from uavsim.studies.certify import from_start, healthy, in_flight, manoeuvres, offset
from uavsim.studies.certify.sets import SETS
from uavsim.studies.certify.tasks import Task, fly
from uavsim.studies.faults import CASES


def test_the_whole_has_each_combination_once() -> None:
    assert healthy.SIZE == 7 * 7 * 5 * 2 * 3 * 3 == 4410
    assert len({tuple(healthy.combination(number).values()) for number in range(healthy.SIZE)}) == healthy.SIZE
    assert [task.number for task in healthy.tasks(1)] == list(range(healthy.SIZE))


@pytest.mark.parametrize("count", [1, 42, 630, 2205, 4409])
def test_a_part_has_each_level_as_often_as_its_share(count: int) -> None:
    """To within one flight; more than half of the set is any part of it."""
    numbers = healthy.subset(count, 11)
    assert len(set(numbers)) == count
    if count > 2205:
        return
    for factor, levels in healthy.FACTORS.items():
        found = Counter(healthy.combination(number)[factor] for number in numbers)
        assert max(found.values()) - min(found.get(level, 0) for level in levels) <= 1


def test_a_part_too_large_is_refused() -> None:
    with pytest.raises(ValueError, match="4410"):
        healthy.subset(4411, 1)


@pytest.mark.parametrize("number", [0, 1234, 4409])
def test_a_combination_is_flown_as_it_says(number: int) -> None:
    task, levels = healthy.task(number, 5), healthy.combination(number)
    flown = load_scenario(task.scenario, overrides=task.overrides)
    head = flown.air_data
    assert flown.accelerometer.preset == levels["accelerometer"]
    assert head.total.preset == head.static.preset == levels["pressure"]
    assert head.tare == levels["tare"]
    noises = {flown.accelerometer.noise_scale, head.total.noise_scale, head.static.noise_scale}
    assert noises == {float(levels["noise"])}
    assert flown.environment.temperature_offset + 15.0 == float(levels["temperature"].split()[0])
    speed = {"calm": 0.0, "gusty": 8.8, "cross 10": 10.0, "tail 8": 8.0, "head 15": 15.0}[levels["wind"]]
    assert flown.environment.wind_speed == speed
    assert (flown.environment.turbulence_wind_20ft > 0.0) == (levels["wind"] == "gusty")
    assert f"--seed 5 --set index={number} " in task.command()


@pytest.mark.parametrize("name", SETS)
def test_each_task_is_a_scenario_that_is_taken(name: str) -> None:
    """The first flights of each set, and its seed is its own."""
    one = SETS[name]
    assert len(one.tasks(one.seed, None)) == one.size
    for task in one.tasks(one.seed, 5)[:5]:
        if not isinstance(task, Task):
            continue
        load_scenario(task.scenario, overrides=task.overrides)
    assert len({other.seed for other in SETS.values()}) == len(SETS)


def test_the_same_flight_is_flown_with_and_without_an_offset() -> None:
    small, without = offset.task(17, 3), offset.task(217, 3)
    assert small.index == without.index == 17
    assert [one for one in small.overrides if "bias" in one]
    assert without.overrides == ()
    large = offset.task(417, 3)
    assert max(abs(large.levels[f"bias_{axis}"]) for axis in "xyz") <= offset.LARGE


def test_every_case_of_a_fault_from_the_start_begins_before_the_release() -> None:
    """The wait on the rail is at least 1.6 s; half of them are there from the first reading on."""
    starts = [task.levels["start"] for task in from_start.tasks(9)]
    assert len(starts) == from_start.EACH * len(from_start.CASES)
    assert max(starts) <= 1.5
    assert sum(start == 0.0 for start in starts) == len(starts) // 2


def test_a_course_never_dips_to_the_ground_by_its_own_reckoning() -> None:
    for number in range(200):
        generator = manoeuvres.Streams(4, number)("test")
        course = manoeuvres.Course(generator, float(generator.choice(manoeuvres.FASTEST)))
        course.begin()
        lowest = course.height
        while course.time < manoeuvres.DURATION:
            course.next()
            lowest = min(lowest, course.height)
        assert lowest > 60.0


def test_a_scenario_that_is_refused_is_a_row() -> None:
    row = fly(Task(3, "catapult", ("accelerometer.preset=no-such-part",), 1, {"wind": "calm"}))
    assert row["outcome"] == "refused"
    assert "no-such-part" in row["reason"]
    assert (row["number"], row["wind"]) == (3, "calm")


def test_every_case_in_flight_has_seeds_of_its_own() -> None:
    found = in_flight.tasks(1)
    assert {task.case for task in found} == set(CASES)
    assert len({task.seed + task.number for task in found}) == len(found) == in_flight.SIZE
    assert {*in_flight.HEALTHY, *in_flight.BY_ERROR, in_flight.LEAK, in_flight.FREED} <= set(CASES)
    assert found[-1].command().endswith(f"{found[-1].case} --flights 1 --seed {1 + found[-1].number}")
