"""The flight computer with a detector and an estimator that say what the test wants."""

import math
from dataclasses import replace
from typing import Any

import pytest

from uavsim import airdata
from uavsim.onboard import flight_computer
from uavsim.onboard.flight_computer import LONGEST_STEP, FlightComputer, FlightComputerSettings
from uavsim.onboard.interface import Estimate, Estimator
from uavsim.onboard.launch import MultiLevelWindow

G = 9.80665  # m/s^2
RATE = 1000.0  # Hz
REST = 2.1  # m/s^2 along body x on the rail
NAN = math.nan
SETTINGS = FlightComputerSettings()


class Spotter:
    """Recognises at the first reading at or after each of the given times."""

    level = count = total = 0
    triggered = False

    def __init__(self, *times: float) -> None:
        self.times = list(times)
        self.resets: int = 0
        self.seen: list[float] = []

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.seen.append(t)
        if self.times and t >= self.times[0]:
            self.times.pop(0)
            return True
        return False

    def reset(self) -> None:
        self.resets += 1


class Oracle(Estimator):
    """Gives back the estimate that stands in `next`, whatever it reads."""

    def __init__(self) -> None:
        self.next: Estimate | None = None
        self.told: list[tuple[str, float]] = []

    def step(self, *reading: float) -> Estimate | None:
        return self.next

    aided = False  # type: ignore[assignment]

    def accelerometer(self, *reading: float) -> None:
        raise AssertionError("an estimator that wants no specific force is given one")

    def launched(self, t: float) -> None:
        self.told.append(("launched", t))

    def unfolding(self, t: float) -> None:
        self.told.append(("unfolding", t))

    def rearmed(self, t: float) -> None:
        self.told.append(("rearmed", t))


def computer(*times: float, **settings: float) -> FlightComputer:
    return FlightComputer(replace(SETTINGS, **settings), Spotter(*times), Oracle(), RATE)


def feed(box: FlightComputer, fx: Any, first: float, last: float, rate: float = RATE) -> None:
    """Readings of `fx` (a number, or a function of time) from `first` up to but not at `last`."""
    for k in range(round(first * rate), round(last * rate)):
        t = k / rate
        box.accelerometer(t, fx(t) if callable(fx) else fx, 0.0, -9.6)


def events(box: FlightComputer) -> dict[str, float]:
    return {e["event"]: e["t"] for e in box.events}


def launched(**settings: float) -> FlightComputer:
    """8 g from 2.0 to 2.4 s, recognised at 2.02 s, then nothing until 4 s."""
    box = computer(2.02, **settings)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.4)
    feed(box, -1.0, 2.4, 4.0)
    return box


# -- from the rail to the motor --------------------------------------------------------------------------------------


def test_a_launch_goes_through_its_states_in_order() -> None:
    box = computer(2.02)
    seen = [(box.state, box.commands)]
    for k in range(4000):
        t = k / RATE
        box.accelerometer(t, 8.0 * G if 2.0 <= t < 2.4 else REST if t < 2.0 else -1.0, 0.0, -9.6)
        if seen[-1] != (box.state, box.commands):
            seen.append((box.state, box.commands))
    pitch = math.radians(SETTINGS.launch_pitch_deg)
    assert seen == [
        ("waiting", (0.0, 0.0, pitch, 0.0, 0.0)),
        ("stroke", (0.0, 0.0, pitch, 0.0, 0.0)),
        ("coasting", (0.0, 0.0, pitch, 0.0, 1.0)),
        ("wings", (1.0, 0.0, pitch, 0.0, 1.0)),
        ("flying", (1.0, SETTINGS.throttle_level, pitch, 0.0, 1.0)),
    ]
    assert [e["event"] for e in box.events] == ["launch_detected", "stroke_end", "wings_commanded", "motor_on"]


@pytest.mark.parametrize(("wing_delay", "motor_delay"), [(0.10, 0.25), (0.0, 0.0), (0.3, 0.7)])
def test_delays_run_from_the_end_of_the_stroke_and_from_the_wings(wing_delay: float, motor_delay: float) -> None:
    at = events(launched(wing_delay=wing_delay, motor_delay=motor_delay))
    step = 1.0 / RATE  # an action waits for the next reading
    assert wing_delay <= at["wings_commanded"] - at["stroke_end"] + 1e-9 <= wing_delay + step + 2e-9
    assert motor_delay <= at["motor_on"] - at["wings_commanded"] + 1e-9 <= motor_delay + step + 2e-9


def test_without_a_detection_nothing_is_commanded() -> None:
    box = computer()
    before = box.commands
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.4)
    feed(box, -1.0, 2.4, 4.0)
    assert box.state == "waiting"
    assert box.events == []
    assert box.commands is before


def test_the_detector_is_not_asked_while_there_is_a_launch_to_follow() -> None:
    box = launched()
    assert max(box.detector.seen) == pytest.approx(2.02)
    assert box.detector.resets == 0


# -- end of the stroke -----------------------------------------------------------------------------------------------


def test_stroke_ends_when_the_mean_of_10_ms_was_below_1_g_for_20_ms() -> None:
    """From 8 g at once to -1 m/s²: enough of the last ten readings must be new ones; 20 ms later it is over.

    The level is above what f_x was on the rail.
    """
    crossed = next(n for n in range(11) if n * -1.0 + (10 - n) * 8.0 * G < 10 * (G + REST))
    assert events(launched())["stroke_end"] == pytest.approx(2.4 + (crossed - 1) / RATE + 0.020, abs=1e-9)


@pytest.mark.parametrize("hold", [0.005, 0.05])
def test_the_hold_and_the_level_are_settings(hold: float) -> None:
    assert events(launched(stroke_end_hold=hold))["stroke_end"] == pytest.approx(2.4 + 0.008 + hold, abs=0.0021)
    never = computer(2.02, stroke_end_level_g=0.5)
    feed(never, REST, 0.0, 2.0)
    feed(never, 8.0 * G, 2.0, 2.4)
    feed(never, REST + 0.6 * G, 2.4, 4.0)
    assert never.state == "stroke"


@pytest.mark.parametrize("offset", [-20.0, 20.0])
def test_an_offset_does_not_move_the_end_of_the_stroke(offset: float) -> None:
    """±2 g of the accelerometer's own: the mean on the rail holds it."""
    box = computer(2.02)
    feed(box, REST + offset, 0.0, 2.0)
    feed(box, 8.0 * G + offset, 2.0, 2.4)
    feed(box, -1.0 + offset, 2.4, 4.0)
    assert events(box)["stroke_end"] == events(launched())["stroke_end"]


def test_where_readings_are_rarer_than_the_mean_is_long_one_of_them_is_the_mean() -> None:
    """At 50 Hz 10 ms hold none: the first reading below the level begins the hold, the next one ends it."""
    box = FlightComputer(SETTINGS, Spotter(2.04), Oracle(), 50.0)
    feed(box, REST, 0.0, 2.0, 50.0)
    feed(box, 8.0 * G, 2.0, 2.4, 50.0)
    feed(box, -1.0, 2.4, 3.0, 50.0)
    assert events(box)["stroke_end"] == pytest.approx(2.42)


def test_a_dip_shorter_than_the_hold_does_not_end_the_stroke() -> None:
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, lambda t: -5.0 * G if 2.2 <= t < 2.22 else 8.0 * G, 2.0, 2.4)
    assert box.state == "stroke"


def test_ringing_does_not_end_the_stroke() -> None:
    """±3 g at 120 Hz on a push of 3 g touches 0 in each period, but its mean over 10 ms stays above 1 g."""
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, lambda t: 3.0 * G * (1.0 + math.sin(2.0 * math.pi * 120.0 * t)), 2.0, 3.0)
    assert box.state == "stroke"


# -- was it a launch? ------------------------------------------------------------------------------------------------


def gained(box: FlightComputer) -> float:
    (gain,) = (e["speed_gain"] for e in box.events if "speed_gain" in e)
    return gain


def test_speed_gained_is_the_integral_since_detection_less_the_rail_mean() -> None:
    """Rectangles of 1 ms from the reading after the detection to the noticed end: exact sum."""
    box = launched()
    quiet = events(box)["stroke_end"] - 2.4
    expected = (8.0 * G - REST) * 0.379 + (-1.0 - REST) * (quiet + 0.001)  # 2.021 … 2.399, then 2.400 … the end
    assert gained(box) == pytest.approx(expected, abs=1e-6)


def test_the_rail_mean_holds_nothing_of_the_stroke() -> None:
    """Whenever the stroke begins within the blocks of half a second, the mean is that of the rest."""
    for start in (1.70, 1.99, 2.0, 2.01, 2.3):
        box = computer(start + 0.02)
        feed(box, REST, 0.0, start)
        feed(box, 8.0 * G, start, start + 0.2)
        feed(box, REST, start + 0.2, start + 1.0)
        assert gained(box) == pytest.approx((8.0 * G - REST) * 0.179, rel=1e-3)


@pytest.mark.parametrize(("duration", "launch"), [(0.135, True), (0.130, False)])
def test_ten_metres_a_second_make_a_launch(duration: float, launch: bool) -> None:
    """8 g less the rail's 2.1 m/s²: 10 m/s take 0.131 s, the first reading is without an interval."""
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.02 + duration)
    feed(box, -1.0, 2.02 + duration, 6.0)
    assert ("wings_commanded" in events(box)) is launch
    assert ("not_a_launch" in events(box)) is not launch


def test_after_a_knock_it_watches_again_a_second_later() -> None:
    box = computer(1.018, 1.5, 3.02)  # 1.5 falls into the second in which it does not look
    before = box.commands
    feed(box, REST, 0.0, 1.0)
    feed(box, 10.0 * G, 1.0, 1.06)
    feed(box, REST, 1.06, 2.0)
    assert box.state == "rearming"
    box.detector.times = [3.02]
    feed(box, REST, 2.0, 3.0)
    assert box.state == "waiting"
    assert box.commands is before
    at = events(box)
    assert at["rearmed"] - at["not_a_launch"] == pytest.approx(1.0, abs=0.0011)
    assert box.detector.resets == 1
    assert not [t for t in box.detector.seen if 1.02 < t <= at["rearmed"]]
    feed(box, 8.0 * G, 3.0, 3.4)
    feed(box, -1.0, 3.4, 5.0)
    assert box.state == "flying"


@pytest.mark.parametrize("delay", [0.2, 3.0])
def test_the_delay_of_rearming_is_a_setting(delay: float) -> None:
    box = computer(1.018, rearm_delay=delay)
    feed(box, REST, 0.0, 1.0)
    feed(box, 10.0 * G, 1.0, 1.06)
    feed(box, REST, 1.06, 6.0)
    at = events(box)
    assert at["rearmed"] - at["not_a_launch"] == pytest.approx(delay, abs=0.0011)


# -- bad readings ----------------------------------------------------------------------------------------------------


def test_single_readings_that_are_no_numbers_change_little() -> None:
    """One in five is NaN: the stroke still ends and counts as a launch; the gain is the integral over what is left."""
    box = computer(2.02)
    feed(box, lambda t: NAN if round(1000 * t) % 5 == 0 else REST, 0.0, 2.0)
    feed(box, lambda t: NAN if round(1000 * t) % 5 == 0 else 8.0 * G, 2.0, 2.4)
    feed(box, lambda t: NAN if round(1000 * t) % 5 == 0 else -1.0, 2.4, 4.0)
    assert box.state == "flying"
    assert gained(box) == pytest.approx(gained(launched()), rel=0.01)


def test_nothing_but_nan_after_the_detection_opens_no_wing() -> None:
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.03)
    feed(box, NAN, 2.03, 10.0)
    assert box.state == "stroke"
    assert box.commands[0] == 0.0


def test_nan_does_not_stop_a_timer_that_runs() -> None:
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.4)
    feed(box, -1.0, 2.4, 2.45)
    assert box.state == "coasting"
    feed(box, NAN, 2.45, 4.0)
    assert box.state == "flying"


def test_a_gap_adds_no_more_speed_than_its_longest_step() -> None:
    """8 g at 2.1 s, nothing for 0.9 s, then the end: the gap counts as 20 ms, which makes no launch."""
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.1)
    box.accelerometer(3.0, 8.0 * G, 0.0, 0.0)
    assert 0.079 + LONGEST_STEP < 10.0 / (8.0 * G)
    feed(box, -1.0, 3.001, 5.0)
    assert gained(box) == pytest.approx((8.0 * G - REST) * (0.079 + LONGEST_STEP), rel=0.02)
    assert "not_a_launch" in events(box)


@pytest.mark.parametrize("late", [2.1, NAN])
def test_readings_that_come_late_or_without_a_time_count_no_time(late: float) -> None:
    """One at 2.1 s after each of those from 2.2 to 2.3 s, and on the rail: the speed gained stays what it was."""
    plain, disturbed = computer(2.02), computer(2.02)
    for box in (plain, disturbed):
        for k in range(2500):
            t = k / RATE
            box.accelerometer(t, 8.0 * G if 2.0 <= t < 2.4 else REST if t < 2.0 else -1.0, 0.0, -9.6)
            if box is disturbed and (2.2 <= t < 2.3 or (math.isnan(late) and t < 1.0)):
                box.accelerometer(late, 8.0 * G, 0.0, -9.6)
    assert gained(disturbed) == pytest.approx(gained(plain), rel=1e-12)


def test_the_same_stroke_read_at_another_rate_gives_the_same() -> None:
    box = FlightComputer(SETTINGS, Spotter(2.02), Oracle(), 500.0)
    feed(box, REST, 0.0, 2.0, rate=500.0)
    feed(box, 8.0 * G, 2.0, 2.4, rate=500.0)
    feed(box, -1.0, 2.4, 4.0, rate=500.0)
    other = launched()
    assert gained(box) == pytest.approx(gained(other), rel=0.01)
    assert events(box)["stroke_end"] == pytest.approx(events(other)["stroke_end"], abs=0.003)


# -- cruise ----------------------------------------------------------------------------------------------------------

SEA_LEVEL, AIR = 101_325.0, 288.15


def reading(
    box: FlightComputer, t: float, airspeed: float, *, height: float | None = None, valid: bool = True, air: float = AIR
) -> Estimate | None:
    """One reading whose estimate is this airspeed at this height above the first one, m."""
    level = SETTINGS.height if height is None else height
    static = SEA_LEVEL * math.exp(-level * G / (287.05 * AIR))
    box.estimator.next = (t, airspeed, 0.1, airspeed, static, static, valid, 1.0, 1.0)
    return box.air_data(t, static, static, air, t, t)


def flying(**settings: float) -> FlightComputer:
    """A computer in flight at 4 s, with its height known from a reading on the ground."""
    box = computer(2.02, **settings)
    reading(box, 0.5, 0.0, height=0.0, valid=False)
    feed(box, REST, 0.51, 2.0)
    feed(box, 8.0 * G, 2.0, 2.4)
    feed(box, -1.0, 2.4, 4.0)
    assert box.state == "flying"
    return box


def throttle(box: FlightComputer) -> float:
    return box.commands[1]


def test_on_target_it_keeps_throttle_and_pitch_of_level_cruise() -> None:
    box = flying()
    for k in range(100):
        reading(box, 4.0 + 0.01 * k, SETTINGS.airspeed)
    assert throttle(box) == pytest.approx(SETTINGS.throttle_level, abs=0.01)
    assert box.commands[2] == pytest.approx(math.radians(SETTINGS.level_pitch_deg), abs=1e-3)


def test_throttle_is_proportional_plus_integral_on_the_estimate() -> None:
    """Half a metre a second too slow for 1 s: level + K_p e, growing by K_i e a second; height on target."""
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed)  # the height's own share of pitch and throttle
    start = throttle(box)
    for k in range(101):
        reading(box, 4.01 + 0.01 * k, SETTINGS.airspeed - 0.5)
    expected = start + SETTINGS.throttle_gain * 0.5 + SETTINGS.throttle_rate * 0.5 * 1.0
    assert throttle(box) == pytest.approx(expected, abs=1e-3)


def test_too_fast_is_less_throttle() -> None:
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed + 1.0)
    assert throttle(box) < SETTINGS.throttle_level - 0.9 * SETTINGS.throttle_gain


@pytest.mark.parametrize(("airspeed", "stop"), [(5.0, 1.0), (80.0, 0.0)])
def test_throttle_stays_between_its_stops_and_the_integral_does_not_wind_up(airspeed: float, stop: float) -> None:
    """A minute against a stop leaves no trace: back on target the throttle is at once what it was."""
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed)
    before = throttle(box)
    for k in range(6000):
        reading(box, 4.01 + 0.01 * k, airspeed)
        assert throttle(box) == stop
    reading(box, 64.02, SETTINGS.airspeed)
    assert throttle(box) == pytest.approx(before, abs=1e-9)


def test_too_low_climbs_and_too_high_descends_within_the_limits() -> None:
    box = flying()
    climb, level = math.radians(SETTINGS.climb_pitch_deg), math.radians(SETTINGS.level_pitch_deg)
    reading(box, 4.0, SETTINGS.airspeed, height=SETTINGS.height - 2.0)
    assert box.commands[2] == pytest.approx(level + 2.0 * SETTINGS.height_gain, rel=0.01)
    reading(box, 4.01, SETTINGS.airspeed, height=SETTINGS.height + 2.0)
    assert box.commands[2] == pytest.approx(level - 2.0 * SETTINGS.height_gain, rel=0.01)
    reading(box, 4.02, SETTINGS.airspeed, height=-500.0)
    assert box.commands[2] == pytest.approx(climb)
    reading(box, 4.03, SETTINGS.airspeed, height=2000.0)
    assert box.commands[2] == pytest.approx(2.0 * level - climb)


def test_while_the_airspeed_is_to_be_gained_the_pitch_is_the_launchs() -> None:
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed - 2.0 * SETTINGS.speed_margin, height=0.0)
    assert box.commands[2] <= math.radians(SETTINGS.launch_pitch_deg) + 1e-12


@pytest.mark.parametrize("level", [2.0, -1.5])
def test_the_hold_is_about_the_pitch_of_level_cruise(level: float) -> None:
    """pitch = level + K_h Δh between 2 level − climb and climb; throttle = level + K_c (pitch − level) + K_p e.

    With a level pitch of 0, the default, a sign or a factor of it would go unseen.
    """
    box = flying(level_pitch_deg=level)
    flat, climb = math.radians(level), math.radians(SETTINGS.climb_pitch_deg)
    reading(box, 4.0, SETTINGS.airspeed)
    assert box.commands[1:3] == (pytest.approx(SETTINGS.throttle_level, abs=2e-3), pytest.approx(flat, abs=1e-3))
    for k, (height, pitch) in enumerate(((5000.0, 2.0 * flat - climb), (-500.0, climb))):
        reading(box, 4.01 + 0.01 * k, SETTINGS.airspeed, height=height)
        assert box.commands[2] == pytest.approx(pitch, abs=1e-9)
        wanted = SETTINGS.throttle_level + SETTINGS.throttle_climb * (pitch - flat)
        assert throttle(box) == pytest.approx(min(max(wanted, 0.0), 1.0), abs=1e-6)


@pytest.mark.parametrize("level", [2.0, -1.5])
def test_what_is_safe_is_about_the_pitch_of_level_cruise(level: float) -> None:
    """safe throttle + K_c (pitch − level pitch), and the pitch of level flight where the height is not known."""
    box = flying(level_pitch_deg=level)
    flat, climb = math.radians(level), math.radians(SETTINGS.climb_pitch_deg)
    reading(box, 4.0, SETTINGS.airspeed)
    lost(box, 4.01, 5.0, height=5000.0, valid=False)
    assert box.commands[2] == pytest.approx(2.0 * flat - climb)
    assert throttle(box) == pytest.approx(SETTINGS.safe_throttle + SETTINGS.throttle_climb * (flat - climb), abs=1e-9)
    box._news = [(5.0, "airspeed_fault", "static", "frozen")]
    reading(box, 5.0, 3.0, height=5000.0, valid=False)
    assert box.commands[1:3] == (pytest.approx(SETTINGS.safe_throttle), pytest.approx(flat))


def lost(box: FlightComputer, first: float, last: float, **bad: Any) -> None:
    for k in range(round((last - first) * 100)):
        reading(box, first + 0.01 * k, 3.0, **bad)


def test_an_estimate_that_is_invalid_for_a_moment_changes_nothing() -> None:
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed - 1.0)
    before = box.commands
    lost(box, 4.01, 4.01 + SETTINGS.loss_time, height=500.0, valid=False)
    assert box.commands is before
    reading(box, 4.2, SETTINGS.airspeed - 1.0)
    lost(box, 4.21, 4.21 + SETTINGS.loss_time, height=500.0, valid=False)  # counted anew
    assert not {"airspeed_lost", "airspeed_back"} & set(events(box))


def test_an_estimate_that_stays_invalid_is_given_up_for_a_safe_throttle_and_the_height_is_held() -> None:
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed - 1.0)
    lost(box, 4.01, 6.0, height=SETTINGS.height, valid=False)
    assert SETTINGS.loss_time < events(box)["airspeed_lost"] - 4.0 <= SETTINGS.loss_time + 0.021
    assert box.commands[1] == pytest.approx(SETTINGS.safe_throttle, abs=1e-3)
    climb = math.radians(SETTINGS.climb_pitch_deg)
    for height, pitch in ((-500.0, climb), (500.0, -climb)):
        reading(box, 6.0 + height / 1e3 + 1.0, 3.0, height=height, valid=False)
        assert box.commands[2] == pytest.approx(pitch)
        wanted = SETTINGS.safe_throttle + SETTINGS.throttle_climb * pitch
        assert box.commands[1] == pytest.approx(wanted, abs=1e-9)


def test_a_height_of_a_static_port_that_is_flagged_is_not_flown_on() -> None:
    """Seed 1 of gusty with a static port that shuts in the climb went down to a height that was none."""
    box = flying()
    news: list[tuple[float, str, str, str]] = []
    box._news = news
    reading(box, 4.0, SETTINGS.airspeed - 1.0)
    news.append((4.01, "airspeed_fault", "static", "frozen"))
    lost(box, 4.01, 6.0, height=500.0, valid=False)
    level = math.radians(SETTINGS.level_pitch_deg)
    assert box.commands[1:3] == (pytest.approx(SETTINGS.safe_throttle), pytest.approx(level))
    news.append((6.0, "airspeed_fault", "total", "frozen"))
    reading(box, 6.0, 3.0, height=500.0, valid=False)
    assert box.commands[2] == pytest.approx(level)
    news.append((6.1, "airspeed_recovered", "static", ""))
    reading(box, 6.1, 3.0, height=500.0, valid=False)
    assert box.commands[2] == pytest.approx(-math.radians(SETTINGS.climb_pitch_deg))


def test_an_estimate_that_comes_back_is_flown_on_as_before() -> None:
    """What the integral had gathered is there again, and nothing was added to it in the meantime."""
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed)
    before = throttle(box)
    lost(box, 4.01, 20.0, valid=False)
    for k in range(30):
        reading(box, 20.0 + 0.01 * k, SETTINGS.airspeed)
    assert throttle(box) == pytest.approx(before, abs=1e-9)
    assert SETTINGS.loss_time <= events(box)["airspeed_back"] - 20.0 <= SETTINGS.loss_time + 0.021
    assert [e["event"] for e in box.events][-2:] == ["airspeed_lost", "airspeed_back"]


def test_without_a_temperature_the_last_one_serves_and_without_a_static_pressure_nothing_changes() -> None:
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed)
    reading(box, 4.01, SETTINGS.airspeed, height=10.0, air=NAN)
    assert box.commands[2] == pytest.approx(
        math.radians(SETTINGS.level_pitch_deg) + SETTINGS.height_gain * (SETTINGS.height - 10.0), rel=0.01
    )
    before = box.commands
    box.estimator.next = (4.02, SETTINGS.airspeed, 0.1, 0.0, NAN, NAN, True, 1.0, 1.0)
    box.air_data(4.02, NAN, NAN, AIR, 4.02, 4.02)
    assert box.commands is before


def test_a_time_without_estimates_does_not_count_in_the_integral() -> None:
    """After 10 s of silence one estimate 1 m/s too slow adds no more than 0.2 s of it."""
    box = flying()
    reading(box, 4.0, SETTINGS.airspeed)
    before = throttle(box)
    reading(box, 14.0, SETTINGS.airspeed - 0.5)
    reading(box, 14.0 + 1e-6, SETTINGS.airspeed)
    assert throttle(box) - before <= SETTINGS.throttle_rate * 0.5 * 10 * LONGEST_STEP + 1e-4


def test_before_the_motor_the_estimate_commands_nothing() -> None:
    box = computer()
    before = box.commands
    for k in range(100):
        assert reading(box, 0.01 * k, 25.0) is not None
    assert box.commands is before


def test_a_reading_that_gives_no_estimate_changes_nothing() -> None:
    box = flying()
    before = box.commands
    box.estimator.next = None
    assert box.air_data(5.0, SEA_LEVEL, SEA_LEVEL, AIR, 5.0, 5.0) is None
    assert box.commands is before


def test_height_is_counted_from_the_first_pressure() -> None:
    """The launch site is 200 Pa below standard: the same climb above it gives the same pitch command."""
    pitches = []
    for site in (0.0, -200.0):
        box = computer(2.02)
        for t, height in ((0.5, 0.0), (4.0, 10.0)):
            static = (SEA_LEVEL + site) * math.exp(-height * G / (287.05 * AIR))
            box.estimator.next = (t, SETTINGS.airspeed, 0.1, 0.0, static, static, True, 1.0, 1.0)
            if t > 1.0:
                feed(box, REST, 0.51, 2.0)
                feed(box, 8.0 * G, 2.0, 2.4)
                feed(box, -1.0, 2.4, 4.0)
            box.air_data(t, static, static, AIR, t, t)
        pitches.append(box.commands[2])
    assert pitches[0] == pytest.approx(pitches[1], abs=1e-5)
    height = airdata.hypsometric_height(1e5 * math.exp(-10.0 * G / (287.05 * AIR)), 1e5, AIR)
    expected = SETTINGS.height_gain * (SETTINGS.height - height)
    assert pitches[0] == pytest.approx(math.radians(SETTINGS.level_pitch_deg) + expected, abs=1e-4)


# -- the estimator is told -------------------------------------------------------------------------------------------


def test_the_estimator_is_told_of_a_launch_and_of_one_that_was_none() -> None:
    box = computer(2.02, 5.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.06)
    feed(box, REST, 2.06, 5.0)
    feed(box, 8.0 * G, 5.0, 5.4)
    feed(box, -1.0, 5.4, 7.0)
    at = [(e["event"], e["t"]) for e in box.events]
    told = dict(at)
    assert box.estimator.told == [("launched", at[0][1]), ("rearmed", told["not_a_launch"]), ("launched", at[3][1]),
        ("unfolding", told["wings_commanded"]),
    ]  # fmt: skip


def test_an_aided_estimator_gets_every_reading_before_it_is_told_of_the_launch() -> None:
    """In all states, as it was read, whatever the launch axis is."""

    class Aided(Oracle):
        aided = True

        def accelerometer(self, *reading: float) -> None:
            self.told.append(("felt", reading[0]))
            assert reading[1:] == (reading[1], 0.0, -9.6)

    box = FlightComputer(SETTINGS, Spotter(2.02), Aided(), RATE, "-z")
    feed(box, REST, 0.0, 2.1)
    felt = [t for kind, t in box.estimator.told if kind == "felt"]
    assert felt == [k / RATE for k in range(2100)]
    launch = box.estimator.told.index(("launched", 2.02))
    assert box.estimator.told[launch - 1] == ("felt", 2.02)


# -- with the real detector ------------------------------------------------------------------------------------------


def test_a_knock_then_a_launch_with_the_detector_that_flies() -> None:
    """10 g for 60 ms is recognised, is no launch, and does not keep the launch 3 s later from being recognised."""
    box = FlightComputer(
        SETTINGS,
        MultiLevelWindow(trigger=45.11, threshold=45.11, samples=18, levels=4, ratio=0.8, period=0.001),
        Oracle(),
        RATE,
    )
    feed(box, REST, 0.0, 1.0)
    feed(box, 10.0 * G, 1.0, 1.06)
    feed(box, REST, 1.06, 4.0)
    feed(box, 8.0 * G, 4.0, 4.4)
    feed(box, -1.0, 4.4, 6.0)
    names = [e["event"] for e in box.events]
    assert names == [
        "launch_detected", "not_a_launch", "rearmed", "launch_detected", "stroke_end", "wings_commanded", "motor_on"
    ]  # fmt: skip
    times = [e["t"] for e in box.events]
    assert times[0] == pytest.approx(1.017)
    assert times[3] == pytest.approx(4.017)


def test_what_is_waited_for_is_as_far_away_after_a_step_of_the_clock() -> None:
    """Between the stroke's end and the wings the clock jumps by 100 s; the wings are late by the readings it takes."""
    usual = events(launched())
    box = computer(2.02)
    feed(box, REST, 0.0, 2.0)
    feed(box, 8.0 * G, 2.0, 2.4)
    feed(box, -1.0, 2.4, usual["stroke_end"] + 0.05)
    assert box.state == "coasting"
    for k in range(1000):
        box.accelerometer(100.0 + usual["stroke_end"] + 0.05 + 0.001 * k, -1.0, 0.0, -9.6)
    waited = events(box)["wings_commanded"] - 100.0 - usual["stroke_end"]
    assert waited == pytest.approx(SETTINGS.wing_delay, abs=0.010)


def test_a_step_of_the_clock_while_nothing_is_waited_for_is_none() -> None:
    box = computer(102.02)
    feed(box, REST, 0.0, 1.0)
    feed(box, REST, 100.0, 102.0)
    feed(box, 8.0 * G, 102.0, 102.4)
    feed(box, -1.0, 102.4, 104.0)
    assert events(box)["stroke_end"] == pytest.approx(100.0 + events(launched())["stroke_end"], abs=1.5e-3)


def test_before_the_first_block_the_mean_on_the_rail_is_nothing() -> None:
    """A push 0.2 s after switching on, when no mean over 0.5 s is there: the speed gained holds g sin θ, 0.8 m/s."""
    box = computer(0.22)
    feed(box, REST, 0.0, 0.2)
    feed(box, 8.0 * G, 0.2, 0.6)
    feed(box, -1.0, 0.6, 2.0)
    (end,) = [e for e in box.events if e["event"] == "stroke_end"]
    assert end["speed_gain"] == pytest.approx(8.0 * G * 0.38, abs=0.3)


def test_so_many_events_are_kept_and_no_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flight_computer, "MOST_EVENTS", 3)
    box = computer()
    for t in range(5):
        box._note(float(t), "note")
    assert [e["t"] for e in box.events] == [2.0, 3.0, 4.0]


@pytest.mark.parametrize("axis", ["+x", "-x", "+y", "-y", "+z", "-z"])
def test_the_stroke_ends_along_the_launch_axis_whatever_its_sign(axis: Any) -> None:
    """The same push along each axis gives the same events; on the others a force that has no end."""
    box = FlightComputer(SETTINGS, Spotter(2.02), Oracle(), RATE, axis=axis)
    place, sign = "xyz".index(axis[1]), -1.0 if axis[0] == "-" else 1.0
    for k in range(round(4.0 * RATE)):
        t = k / RATE
        force = [44.0, 44.0, 44.0]
        force[place] = sign * (REST if t < 2.0 else 50.0 if t < 2.4 else -1.0)
        box.accelerometer(t, *force)
    assert events(box)["stroke_end"] == pytest.approx(events(launched())["stroke_end"], abs=0.003)


def test_a_safe_throttle_is_all_that_there_is_at_the_most() -> None:
    box = computer(throttle_climb=50.0)
    assert box._safe(0.5) == 1.0
    assert box._safe(-0.5) == 0.0
    assert box._safe(math.radians(SETTINGS.level_pitch_deg)) == pytest.approx(SETTINGS.safe_throttle)


def test_what_can_wait_is_done_at_the_reading_after_one_of_the_head() -> None:
    class Tidy(Oracle):
        aided = True  # type: ignore[assignment]

        def accelerometer(self, *reading: float) -> None:
            self.told.append(("force", reading[0]))

        def tidy(self) -> None:
            self.told.append(("tidy", NAN))

    estimator = Tidy()
    estimator.next = (0.01, 0.0, 1.0, 0.0, 101_325.0, 101_325.0, True, NAN, NAN)
    box = FlightComputer(SETTINGS, Spotter(), estimator, RATE)
    box.air_data(0.01, 101_325.0, 101_325.0, 288.15, 0.01, 0.01)
    for k in range(11, 14):
        box.accelerometer(0.001 * k, REST, 0.0, -9.6)
    assert [what for what, _ in estimator.told] == ["force", "tidy", "force", "force"]
