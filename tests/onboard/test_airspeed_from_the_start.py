"""Sensors that are broken before the launch: the rail, the stroke, the first climb, and what is told then."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from references.manoeuvres import LAUNCH, NOISE, Flight, believed, fly, run, spoil

from uavsim.onboard.airspeed import AidedFilter, EstimatorSettings, first_climb
from uavsim.onboard.airspeed.felt_climb import FeltClimb
from uavsim.onboard.airspeed.rail import RailCheck
from uavsim.onboard.rail_offset import RailOffset
from uavsim.onboard.readiness import Readiness

FLIGHT = Flight(duration=12.0)
DEAD = [
    ("total", 1, "stuck", "stuck", 0.0),
    ("total", 1, "silent", "silent", 0.0),
    ("total", 1, "nan", "invalid", 0.0),
    ("total", 1, "value", "range", 0.0),
    ("static", 2, "stuck", "stuck", 0.0),
    ("static", 2, "nan", "invalid", 0.0),
    ("static", 2, "silent", "silent", 0.0),
    ("thermometer", 3, "nan", "invalid", 0.0),
    ("thermometer", 3, "value", "range", 500.0),
]


@pytest.mark.parametrize(("channel", "column", "how", "kind", "size"), DEAD)
def test_a_dead_sensor_is_named_at_the_launch_and_never_taken_back(channel, column, how, kind, size):
    readings = spoil(fly(FLIGHT, 9600), column, 0.5, how, size=size)
    flown = run(readings)
    assert [(event, name, word) for _, event, name, word in flown.news] == [("airspeed_fault", channel, kind)]
    assert flown.news[0][0] < LAUNCH + 0.3
    assert not flown.after(0.0)[:, 3].any() or channel == "thermometer"


@pytest.mark.parametrize(("channel", "column"), [("total", 1), ("static", 2)])
@pytest.mark.parametrize("step", [0.0, 4.0])
def test_a_pressure_at_the_end_of_its_range_is_none_in_flight_either(channel, column, step):
    """With or without steps: it has been clipped. On the rail the same rule holds (`measured`)."""
    end = 103_000.0
    noise = replace(NOISE, **{f"{channel}_range": (30_000.0, end), f"{channel}_step": step})
    clipped = end - 0.4 * step
    readings = spoil(fly(FLIGHT, 9604), column, LAUNCH + 4.0, "value", size=clipped)
    flown = run(readings, noise=noise)
    assert (channel, "range") in {(name, word) for _, _, name, word in flown.faults}
    check = RailCheck(noise, -1.0)
    for k in range(200):
        row = [0.01 * k, 95_000.0 + k % 7, 95_000.0 + k % 5, 288.0, 0.01 * k, 0.01 * k]
        row[column] = clipped
        check.add(*row)
    assert check.broken(2.0) == {channel: "range"}


@pytest.mark.parametrize(("channel", "column", "how", "kind", "size"), DEAD)
def test_the_rail_says_what_is_wrong(channel, column, how, kind, size):
    """With a reason that names it; a healthy head has none."""
    for spoilt in (True, False):
        readings = fly(replace(FLIGHT, duration=0.5), 9601)
        readings = spoil(readings, column, 0.5, how, size=size) if spoilt else readings
        check = RailCheck(NOISE, 4.0)
        for row in readings.air[readings.air[:, 0] < LAUNCH - 0.1].tolist():
            check.add(*row)
        assert check.decided(row[0])
        doubts = check.doubts(row[0])
        assert [reason.startswith(channel) for reason in doubts] == ([True] if spoilt else [])
        assert check.broken(row[0]) == ({channel: kind} if spoilt else {})


def _warm(flight, seed, sd, step):
    """Readings with a thermometer of that noise and step, K, and what is believed of it."""
    readings = fly(flight, seed)
    air = readings.air.copy()
    air[:, 3] += sd * np.random.default_rng(seed).standard_normal(len(air))
    air[:, 3] = np.round(air[:, 3] / step) * step
    noise = replace(NOISE, temperature_white_sd=float(np.hypot(sd, step / 12.0**0.5)), temperature_step=step)
    return replace(readings, air=air), replace(noise, rail_elevation=float(np.radians(flight.elevation_deg)))


@pytest.mark.parametrize(("sd", "named"), [(0.005, True), (0.0005, False)])
@pytest.mark.parametrize("start", [0.5, LAUNCH + 6.0])
def test_a_thermometer_that_holds_its_value_is_named_where_its_noise_would_show(sd, named, start):
    """On the rail and in flight, within 1 s; a quiet one of coarse steps repeats itself, and nothing is said."""
    readings, noise = _warm(FLIGHT, 9610, sd, 0.005)
    assert not run(readings, noise=noise).news
    readings = spoil(readings, 3, start, "stuck")
    news = run(readings, noise=noise).news
    assert [row[1:] for row in news] == ([("airspeed_fault", "thermometer", "stuck")] if named else [])
    assert not named or news[0][0] < max(start, LAUNCH) + 1.0
    check = RailCheck(noise, 4.0)
    for row in readings.air[readings.air[:, 0] < LAUNCH - 0.1].tolist():
        check.add(*row)
    assert check.broken(row[0]) == ({"thermometer": "stuck"} if named and start < LAUNCH else {})


def test_a_conversion_that_is_read_twice_is_no_repetition():
    """A head at 100 Hz reads a part at 3 Hz more than 25 times each: its thermometer is alive."""
    readings, noise = _warm(replace(FLIGHT, duration=0.5), 9611, 0.005, 0.005)
    check = RailCheck(noise, 4.0)
    rows = readings.air[readings.air[:, 0] < LAUNCH - 0.1]
    for k, row in enumerate(rows.tolist()):
        last = rows[k - k % 30]
        check.add(row[0], row[1], float(last[2]), float(last[3]), row[4], float(last[5]))
    assert check.broken(row[0]) == {}


def test_quiet_and_coarse_parts_are_alive():
    """Noise of a fifth of a step, and of 0.3 of what is usual: ready."""
    for sd, step in ((2.0, 10.0), (0.3, 0.01), (1.1, 2.64)):
        flight = replace(FLIGHT, duration=0.5, total_sd=sd, static_sd=sd, total_step=step, static_step=step)
        readings = fly(flight, 9602)
        believed_sd = float(np.hypot(sd, step / 12.0**0.5))
        noise = replace(NOISE, total_sd=believed_sd, static_sd=believed_sd, total_step=step, static_step=step)
        check = RailCheck(noise, 4.0)
        for row in readings.air[readings.air[:, 0] < LAUNCH - 0.1].tolist():
            check.add(*row)
        assert check.doubts(row[0]) == ()


def test_a_pair_that_differs_by_more_than_its_parts_allow_is_told():
    readings = spoil(fly(replace(FLIGHT, duration=0.5), 9603), 1, 0.0, "offset", size=500.0)
    for allowed, told in ((50.0, True), (200.0, False)):
        check = RailCheck(replace(NOISE, difference_sd=allowed), 4.0)
        for row in readings.air[readings.air[:, 0] < LAUNCH - 0.1].tolist():
            check.add(*row)
        assert bool(check.doubts(row[0])) == told


@pytest.mark.parametrize("cover", ["blocked", "cover"])
def test_a_cover_left_on_is_known_in_the_stroke(cover):
    """Flagged within 0.3 s of the launch, no airspeed valid, never taken back."""
    for seed in (9700, 9701):
        readings = fly(FLIGHT, seed)
        if cover == "blocked":
            readings = spoil(readings, 1, 0.0, "shut", seed)
        else:
            air = readings.air.copy()
            air[:, 1] = air[:, 2] + 3.7 * np.random.default_rng(seed).standard_normal(len(air))
            readings = replace(readings, air=air)
        flown = run(readings)
        assert [(event, channel) for _, event, channel, _ in flown.news] == [("airspeed_fault", "total")]
        assert flown.news[0][0] < LAUNCH + 0.3
        rows = flown.after(0.3)
        assert not rows[:, 3].any()
        assert np.mean(np.abs(rows[:, 4]) < 1.96 * rows[:, 2]) > 0.95  # what is told is right all the same


def test_swapped_tubes_are_both_named():
    readings = fly(FLIGHT, 9702)
    flown = run(replace(readings, air=readings.air[:, [0, 2, 1, 3, 5, 4]]))
    assert {(channel, kind) for _, _, channel, kind in flown.faults} == {("total", "swapped"), ("static", "swapped")}
    assert not flown.after(0.3)[:, 3].any()


@pytest.mark.parametrize("wind", [-8.0, 8.0])
def test_a_live_port_rises_in_any_wind(wind):
    """A head- or tailwind of 8 m/s along the launch, seen on the rail or not (open tare): no flag."""
    for tare in ((0.0, 4.0), None):
        flight = replace(FLIGHT, duration=6.0, wind=wind)
        assert not run(fly(flight, 9703), believed(flight), tare=tare).faults


def test_a_static_port_that_was_shut_is_named_in_the_first_climb():
    """Within 10 m of height, the bar right until then, and not valid after it; a live one shows life in the stroke."""
    flight = Flight(duration=8.0)
    for seed in (9800, 9801):
        readings = spoil(fly(flight, seed), 2, 0.0, "shut", seed)
        flown = run(readings)
        assert [(channel, kind) for _, _, channel, kind in flown.faults] == [("static", "frozen")]
        at = flown.faults[0][0]
        assert np.interp(at, readings.t, readings.height) < 10.0
        rows = flown.rows[(flown.rows[:, 0] > LAUNCH + 0.3) & (flown.rows[:, 0] < at)]
        assert np.mean(np.abs(rows[:, 4]) < 1.96 * rows[:, 2]) > 0.95
        assert not flown.rows[flown.rows[:, 0] > at + 0.02, 3].any()


def test_the_doubt_of_a_live_static_port_costs_no_bar(monkeypatch):
    """What it might hide, weighed by its odds: the bar of the stroke and the climb is that of a port nobody doubts."""
    for seed in (9810, 9811):
        readings, bars = fly(Flight(duration=6.0), seed), []
        for prior in (first_climb.PRIOR, first_climb.LEAST_ODDS):
            monkeypatch.setattr(first_climb, "PRIOR", prior)
            bars.append(run(readings).after(0.1)[:80, 2])
        assert np.median(bars[0] / bars[1]) < 1.1
        assert np.max(bars[0] / bars[1]) < 1.5


@pytest.mark.parametrize(("how", "kind"), [("silent", "silent"), ("nan", "invalid")])
def test_silence_in_flight_is_told_within_a_second_and_validity_follows_the_bar(how, kind):
    flown = run(spoil(fly(Flight(duration=22.0), 9900), 1, LAUNCH + 5.0, how))
    assert [(channel, word) for _, _, channel, word in flown.faults] == [("total", kind)]
    assert LAUNCH + 5.0 < flown.faults[0][0] < LAUNCH + 6.0
    late = flown.after(5.3)
    assert (late[:, 2] < 2.0).any()
    assert (late[:, 2] > 2.0).any()
    assert (late[late[:, 2] > 2.0, 3] == 0.0).all()
    assert late[late[:, 2] < 1.9, 3].all()
    assert np.abs(late[late[:, 3] > 0.0, 4]).max() < 3.0


def test_silence_ends_when_readings_come():
    """Two seconds of silence: taken back a second after they come."""
    readings = fly(Flight(duration=15.0), 9901)
    silent = spoil(readings, 1, LAUNCH + 5.0, "silent")
    air = silent.air.copy()
    late = air[:, 0] > LAUNCH + 7.0
    air[late] = readings.air[late]
    flown = run(replace(readings, air=air))
    assert [event for _, event, channel, _ in flown.news if channel == "total"] == [
        "airspeed_fault",
        "airspeed_recovered",
    ]
    assert flown.news[-1][0] < LAUNCH + 8.5


def test_a_filter_that_has_diverged_leaves_no_wild_reading_valid():
    """Pressures alone have a gate of their own: 50 kPa more for single readings are never valid."""
    readings = fly(Flight(duration=8.0), 9902)
    air = readings.air.copy()
    wild = (air[:, 0] > LAUNCH + 4.0) & (np.arange(len(air)) % 7 == 0)
    air[wild, 1] += 50_000.0
    estimator = AidedFilter(believed(readings.flight), NOISE, (0.0, 4.0))
    for row in air.tolist():
        estimate = estimator.step(*row)
        if row[0] >= LAUNCH + 3.0 and estimator._gated == float("inf"):
            estimator._fall_back(row[0], "diverged")
        elif estimate is not None and estimate[6] and row[0] > LAUNCH + 3.0:
            assert abs(estimate[1] - readings.truth(row[0])) < 2.0


# -- the accelerometer, on its rail -----------------------------------------------------------------------------------


def _ready(force, rate=500.0, sd=0.05, step=0.01):
    noise = replace(
        NOISE,
        accelerometer_rate=rate,
        accelerometer_white_sd=sd,
        accelerometer_step=step,
        own_offset_sd=0.2,
        own_side_offset_sd=0.2,
        own_lift_offset_sd=0.2,
        rail_elevation=0.2,
    )
    rail = RailOffset(noise)
    readiness, said = Readiness(noise, rail), None
    for k in range(round(3.0 * rate)):
        t = k / rate
        reading = force(k)
        if reading is not None:
            rail.add(t, *reading)
            readiness.add(t, reading[0])
        if t >= readiness.due:
            said = readiness.look(t, (), 0.0)
    return said


def _live(offset=0.0):
    white = np.random.default_rng(5).standard_normal((2000, 3)) * 0.05
    rest = (9.80665 * np.sin(0.2) + offset, 0.0, -9.80665 * np.cos(0.2))
    return lambda k: tuple(np.round((rest + white[k]) / 0.01) * 0.01)


@pytest.mark.parametrize(
    ("force", "word"),
    [
        (_live(), None),
        (_live(5.0), None),
        (_live(20.0), "off what the rail gives"),
        (lambda k: (0.0, 0.0, 0.0), "repeats"),
        (lambda k: (float("nan"),) * 3, "no numbers"),
        (lambda k: _live()(k) if k < 800 else None, "no reading"),
    ],
    ids=["alive", "offset", "far off", "dead", "nan", "silent"],
)
def test_a_dead_accelerometer_is_not_ready(force, word):
    said = _ready(force)
    assert said is not None
    assert len(said) == (0 if word is None else 1)
    assert word is None or (word in said[0] and said[0].startswith("accelerometer"))


def test_a_stamp_of_the_far_future_silences_no_sensor_on_the_rail():
    """One conversion that ends in ten years: the others are new all the same."""
    check = RailCheck(NOISE, 4.0)
    for row in fly(replace(FLIGHT, duration=0.5), 9604).air.tolist():
        if 1.0 < row[0] < 1.015:
            row[4] = row[5] = 3e8
        check.add(*row)
        assert check.broken(row[0]) == {}


def test_an_airspeed_on_a_rail_is_not_valid_before_the_launch():
    """10 m/s of wind after a covered tare; without a rail, in a tunnel, it is valid; 40 m/s are no wind."""
    for rail, wind, valid in ((0.2, 10.0, False), (None, 10.0, True), (0.2, 40.0, True)):
        part = AidedFilter(EstimatorSettings(), replace(NOISE, rail_elevation=rail), (0.0, 1.0))
        draw = np.random.default_rng(9605)
        for k in range(1, 300):
            t = 0.01 * k
            above = 0.6125 * wind**2 if t > 1.0 else 0.0
            total, static = draw.normal(101_325.0, NOISE.total_sd, 2)
            estimate = part.step(t, total + above, static, 288.15, t, t)
        assert estimate[6] is valid
        assert estimate[1] == pytest.approx(wind, rel=0.05)


def test_a_static_port_in_level_flight_is_not_doubted_for_ever():
    """30 m/s off a rail of 12°, then level: seconds later nothing is hidden. One that climbs unseen is shut."""
    for climbs in (False, True):
        test = first_climb.FirstClimb()
        test.begin(101_325.0, 2.0, 0.2)
        shut = False
        for k in range(600):
            speed = min(30.0, 100.0 * 0.01 * k)
            climbed = 6.0 * max(0.0, 0.01 * k - 0.3) if climbs else 0.0
            lost = -2.0 * 9.81 * climbed / 30.0
            shut = shut or test.add(
                101_325.0, 0.01, speed + lost, speed, 1.2, k < 30, ground=speed, position=0.0, position_sd=0.0
            )
            if shut:
                break
        assert shut is climbs
        assert test.hidden == 0.0
        assert not test.open


@pytest.mark.parametrize(("rises", "named"), [(False, True), (True, False)])
def test_a_gust_that_takes_4_m_per_s_condemns_no_static_port_that_has_risen(rises, named):
    """0.7 m up the rail, 8 Pa: less than what a mean of readings of 6 Pa must have moved, but each of them tells."""
    test = first_climb.FirstClimb()
    test.begin(101_325.0, 6.0, 0.2)
    draw, height, found = np.random.default_rng(9606), 0.0, False
    for k in range(50):
        speed = min(26.0, float(k))
        height += 0.0019 * speed * (k < 26) * rises
        reading = 101_325.0 - 1.2 * 9.81 * height + draw.normal(0.0, 6.0)
        told = speed - 0.25 * min(16, max(0, k - 30))
        found = found or test.add(
            reading, 0.01, told, speed, 1.2, k < 26, ground=speed, position=0.0, position_sd=0.0
        )  # fmt: skip
    assert found is named


def _climb_in_a_gust(moves: bool, lift: Callable[[int], float]) -> tuple[bool, float, float]:
    """Launch at 12° into a gust that hides what V loses; return whether it is shut, when, s, and the height told, m."""
    test, height, climb = first_climb.FirstClimb(), 0.0, 0.0
    test.begin(101_325.0, 2.0, 0.2, 0.05)
    for k in range(300):
        speed, felt = min(30.0, float(k)), lift(k)
        climb = math.sin(0.2) * speed if k <= 30 else climb + ((felt if felt == felt else 9.81) - 9.81) * 0.01
        height += climb * 0.01
        reading = 101_325.0 - 11.8 * height * moves
        if test.add(
            reading, 0.01, speed, speed, 1.2, k < 30, ground=speed, position=0.02, position_sd=0.002, lift=felt
        ):
            return True, height, test.risen
    return False, height, test.risen


def test_a_shut_static_port_is_named_within_10_m_though_a_gust_hides_what_v_loses():
    """D is 0, which said nothing before; the accelerometer feels the climb, and the height that is hidden is told."""
    shut, height, told = _climb_in_a_gust(moves=False, lift=lambda k: 9.81)
    assert shut
    assert 3.0 < height < 9.0
    assert told == pytest.approx(height, abs=1.0)


@pytest.mark.parametrize(
    ("moves", "lift"),
    [
        (True, lambda k: 9.81),  # it lives
        (False, lambda k: 9.81 - 30.0 * (30 < k < 51)),  # the path is bent down to level: nothing need move
        (False, lambda k: math.nan),  # nobody knows
    ],
)
def test_a_static_port_is_not_named_without_a_climb_that_it_does_not_show(moves, lift):
    """An open port, level flight behind the rail, and an accelerometer that is silent."""
    assert not _climb_in_a_gust(moves, lift)[0]


def test_the_height_that_is_felt_is_the_one_that_is_flown():
    """Against a path that is bent by hand, with a headwind: V is not the speed over the ground."""
    felt, height, angle, ground = FeltClimb(math.sin(0.2), 0.0), 0.0, 0.2, 0.0
    gained = 0.0
    for k in range(230):
        pushed = k < 30
        along, turn = (90.0 if pushed else 0.0), (0.0 if pushed else -0.05)  # m/s² over the ground, rad/s
        ground += 0.01 * along
        angle += 0.01 * turn
        height += 0.01 * ground * math.sin(angle)
        gained += 0.01 * (along + 9.81 * math.sin(angle))
        felt.add(0.01, ground + 0.3, gained, ground, 9.81 * math.cos(angle) + ground * turn)
    assert height > 8.0
    assert felt.height == pytest.approx(height, abs=0.5)
    assert 0.5 < felt.height_sd < 2.5
