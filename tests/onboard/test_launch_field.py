"""The autopilots' rules: examples worked out by hand from their sources, and their defined effects."""

import math

import pytest

import uavsim
from uavsim.onboard.launch import ArduPilot, DetectorSettings, Inav, Px4, build
from uavsim.onboard.launch.inav import lowpass

NAN = math.nan
G = 9.80665  # m/s², ISO 80000-3
REST = 1200  # samples on the rail at 1 kHz: more than the two blocks that the mean needs
KINDS = ("px4", "px4-norm", "ardupilot", "inav", "paparazzi", "altos")


def make(kind, rate=1000.0):
    return build(DetectorSettings(kind=kind), rate)


def after_rest(detector, force, rest=2.1, period=0.001):
    """Time from the end of the rest to recognition, s, for forces along x that come on top of it; None if never."""
    quiet = round(1.2 / period)
    for k, f in enumerate([0.0] * quiet + list(force)):
        if detector.step(k * period, rest + f, 0.3, -9.6):
            return (k - quiet) * period
    return None


@pytest.mark.parametrize(
    ("kind", "just", "below"),
    [("px4", 30.1, 29.9), ("px4-norm", 30.1, 29.9), ("ardupilot", 15.01, 14.9), ("altos", 20.1, 19.9)],
)
def test_gravity_on_the_rail_does_not_count(kind, just, below):
    assert after_rest(make(kind), [just] * 600) is not None
    assert after_rest(make(kind), [below] * 400) is None  # the mean has not yet the launch in it


@pytest.mark.parametrize(("kind", "level"), [("inav", 18.63), ("paparazzi", 1.5 * G)])
def test_gravity_on_the_rail_counts(kind, level):
    assert after_rest(make(kind), [level - 2.1 + 0.1] * 400) is not None
    assert after_rest(make(kind), [level - 2.1 - 0.1] * 400) is None


@pytest.mark.parametrize("kind", ["px4", "px4-norm"])
def test_px4_needs_three_runs_at_50_hz(kind):
    """3 · 20 ms > 50 ms, 2 · 20 are not: between 40 and 60 ms after the first sample, and nothing at 50 Hz for two."""
    latency = after_rest(make(kind), [60.0] * 200)
    assert 0.040 <= latency <= 0.060
    assert after_rest(build(DetectorSettings(kind=kind), 50.0), [60.0] * 3, period=0.02) == pytest.approx(0.04)
    assert after_rest(build(DetectorSettings(kind=kind), 50.0), [60.0] * 2 + [0.0] + [60.0] * 2, period=0.02) is None


def test_px4_norm_feels_every_direction():
    for axis in range(3):
        force = [0.0, 0.0, 0.0]
        force[axis] = -35.0
        norm, forward = make("px4-norm"), make("px4")
        for k in range(REST):
            assert not norm.step(0.001 * k, 0.0, 0.0, 0.0)
            assert not forward.step(0.001 * k, 0.0, 0.0, 0.0)
        assert any(norm.step(0.001 * k, *force) for k in range(REST, REST + 100))
        assert not any(forward.step(0.001 * k, *force) for k in range(REST, REST + 100))


def test_ardupilot_looks_once_and_then_waits():
    """One value of 75 m/s² in the mean of five is 15: launched 0.2 s later, whatever happens in between."""
    detector = build(DetectorSettings(kind="ardupilot"), 50.0)
    assert after_rest(detector, [75.1] + [0.0] * 20, period=0.02) == pytest.approx(0.2)
    assert after_rest(build(DetectorSettings(kind="ardupilot"), 50.0), [74.9] + [0.0] * 20, period=0.02) is None


def test_inav_holds_behind_its_low_pass():
    """40 ms above the level at once; later behind the low-pass, whose step response passes the level at some time."""
    bare = Inav(1000.0, cutoff=600.0)
    assert after_rest(bare, [30.0] * 100) == pytest.approx(0.039)
    assert 0.045 < after_rest(make("inav"), [30.0] * 200) < 0.065
    assert after_rest(Inav(1000.0, cutoff=600.0), ([30.0] * 39 + [0.0]) * 20) is None


def test_low_pass_is_a_butterworth():
    """Power halved at the cutoff, all of it at rest, none at half the sampling rate."""
    b0, a1, a2 = lowpass(0.015)
    assert 4.0 * b0 / (1.0 + a1 + a2) == pytest.approx(1.0, rel=1e-9)
    z = complex(math.cos(0.03 * math.pi), -math.sin(0.03 * math.pi))  # z⁻¹ at the cutoff
    gain = b0 * (1.0 + z) ** 2 / (1.0 + a1 * z + a2 * z * z)
    assert abs(gain) == pytest.approx(math.sqrt(0.5), rel=1e-9)


def test_paparazzi_needs_five_calls_in_a_row():
    def run(force):
        detector = build(DetectorSettings(kind="paparazzi"), 60.0)
        return [k for k, f in enumerate(force) if detector.step(k / 60.0, f, 0.0, 0.0)]

    assert run([15.0] * 4 + [14.0] + [15.0] * 5) == [9]
    assert run([1.5 * G] * 5) == [4]  # reached is enough


def test_altos_needs_the_speed_too():
    """25 m/s² make 5 m/s in 0.2 s; 15 m/s² make it too, but are too weak."""
    assert after_rest(make("altos"), [25.0] * 300) == pytest.approx(0.200, abs=0.0011)
    assert after_rest(make("altos"), [15.0] * 400) is None
    assert after_rest(make("altos"), [40.0] * 100) is None


@pytest.mark.parametrize("kind", KINDS)
def test_common_effects(kind):
    """Once until reset; NaN, late samples and those without a time never speak for a launch."""
    detector = make(kind)
    first = after_rest(detector, [60.0] * 400)
    assert first is not None
    assert not detector.step(10.0, 60.0, 0.0, 0.0)
    assert detector.triggered
    detector.reset()
    assert (detector.level, detector.count, detector.total, detector.triggered) == (0, 0, 0, False)
    assert after_rest(detector, [60.0] * 400) == first
    detector.reset()
    assert after_rest(detector, [NAN] * 400) is None
    for late in (0.0, -1.0, NAN, math.inf):
        assert not detector.step(late, 90.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_a_gap_begins_anew(kind):
    """30 ms of launch, a second without samples, 30 ms again: no rule takes the two for one."""
    detector = make(kind)
    assert after_rest(detector, [60.0] * 30) is None
    assert not any(detector.step(2.5 + 0.001 * k, 60.0, 0.3, -9.6) for k in range(30))


@pytest.mark.parametrize(
    "wrong", [{"acceleration": NAN}, {"time": 0.0}, {"time": NAN}, {"rate": 0.0}, {"rate": math.inf}, {"axis": "x"}]
)
@pytest.mark.parametrize("kind", [Px4, Inav])
def test_settings_out_of_bounds_are_refused(kind, wrong):
    with pytest.raises(ValueError, match="must"):
        kind(**{"rate": 1000.0} | wrong)


def test_a_flight_ends_in_cruise():
    flight = uavsim.fly("catapult", overrides=["detector.kind=px4", "duration=35"])
    assert flight.score["outcome"] == "cruise"
    assert flight.score["launch"]["false_detections"] == 0


# -- gravity taken off -----------------------------------------------------------------------------------------------

GRAVITY_FREE = ("px4", "px4-norm", "ardupilot", "altos")
BY_ATTITUDE = ("px4", "px4-norm", "ardupilot")


def first(detector, stretches, period=0.005):
    """Time of recognition, s, in stretches of (seconds, force along x)."""
    k = 0
    for seconds, force in stretches:
        for _ in range(round(seconds / period)):
            if detector.step(k * period, force, 0.3, -9.6):
                return k * period
            k += 1
    return None


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("lasts", [0.04, 0.4, 3.0])
def test_an_arrest_in_a_net_is_no_launch(kind, lasts):
    """-8 g: what no rest can read is none of gravity, so that rest is no launch after it.

    But for PX4's rule by magnitude, as the real one: it takes the arrest itself for one, whatever its direction.
    """
    found = first(make(kind, 200.0), [(3.0, 2.1), (lasts, -8.0 * G), (3.0, 2.1)])
    assert (found is not None) is (kind == "px4-norm" and lasts > 0.05)
    assert found is None or found < 3.0 + lasts


@pytest.mark.parametrize("kind", GRAVITY_FREE)
@pytest.mark.parametrize("rest", [0.0, 0.01, 0.1, 0.3, 1.0])
def test_none_is_blind_in_the_first_second(kind, rest):
    """7 g for 0.4 s, the log trimmed to so little of rest before it."""
    found = first(make(kind, 200.0), [(rest, 2.1), (0.4, 7.0 * G), (0.5, 2.1)])
    assert found is not None
    assert found < rest + 0.35


@pytest.mark.parametrize("kind", GRAVITY_FREE)
@pytest.mark.parametrize("rest", [-G, 0.0, G])
def test_rest_in_any_attitude_is_no_launch_from_the_first_sample_on(kind, rest):
    assert first(make(kind, 200.0), [(1.0, rest)]) is None
    if kind != "px4-norm":  # begins in a net
        assert first(make(kind, 200.0), [(0.3, -8.0 * G), (1.0, 0.7 * rest)]) is None


@pytest.mark.parametrize("kind", BY_ATTITUDE)
def test_gravity_is_taken_off_by_an_attitude_that_is_told(kind):
    """Held nose up by 40° and at once level, pushed by just too little; nose down by 25°, by what is just enough."""
    weak = {"ardupilot": 14.5}.get(kind, 29.5)
    told = make(kind, 200.0)
    for k in range(600):
        push = weak if k >= 400 else 0.0
        pitch = math.radians(40.0) if k < 400 else 0.0
        told.attitude(0.0, pitch)
        assert not told.step(0.005 * k, push + G * math.sin(pitch), 0.0, -G * math.cos(pitch))
    told.reset()
    told.attitude(0.0, math.radians(-25.0))
    felt = weak + 1.0 + G * math.sin(math.radians(-25.0))
    assert first(told, [(1.0, felt)]) is not None  # begins in the push: no rest is needed
    told.reset()
    told.attitude(NAN, NAN)
    assert first(told, [(1.0, felt)]) is None  # a mean again, from the first sample on: at most 1 g of it


def test_px4_norm_takes_all_of_gravity_off_by_attitude():
    roll, pitch = 0.4, -0.5
    felt = (G * math.sin(pitch), -G * math.cos(pitch) * math.sin(roll), -G * math.cos(pitch) * math.cos(roll))
    for push, expected in ((29.9, False), (30.1, True)):
        detector = make("px4-norm", 100.0)
        detector.attitude(roll, pitch)
        found = [detector.step(0.01 * k, felt[0], felt[1] + push, felt[2]) for k in range(30)]
        assert any(found) is expected


def test_ardupilot_wants_so_many_events_by_turns():
    """Shaken: forwards, backwards, forwards; two of the same sign are one, and 0.5 s between them too long."""

    def make_one(count):
        return ArduPilot(50.0, count=count, delay=0.0)

    forth, back, rest = (0.2, 25.0), (0.2, -20.0), (0.4, 2.1)
    assert first(make_one(3), [(1.0, 2.1), forth, back, forth], period=0.02) == pytest.approx(1.52, abs=0.05)
    assert first(make_one(3), [(1.0, 2.1), forth, rest, forth, rest, forth], period=0.02) is None
    assert first(make_one(3), [(1.0, 2.1), forth, back, (1.0, 2.1), forth], period=0.02) is None
    assert first(make_one(2), [(1.0, 2.1), forth, back], period=0.02) == pytest.approx(1.32, abs=0.05)


def test_ardupilot_without_a_level_launches_when_the_delay_is_over():
    """MINACC 0, as the firmware ships."""
    assert first(ArduPilot(50.0, acceleration=0.0), [(1.0, 2.1)], period=0.02) == pytest.approx(0.2, abs=0.021)


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, -31.0), (0.0, 46.0), (31.0, 0.0), (-31.0, 0.0)])
def test_ardupilot_ends_a_launch_of_an_attitude_that_none_has(roll, pitch):
    detector = ArduPilot(50.0)
    for k in range(200):
        attitude = (roll, pitch) if k >= 55 else (0.0, 10.0)
        detector.attitude(*map(math.radians, attitude))
        assert not detector.step(0.02 * k, 60.0 if 50 <= k < 60 else 2.0, 0.0, -9.6)


def test_inav_is_thrown_by_six_satellites_above_three_metres_a_second():
    def found(speed, number, force):
        detector = make("inav", 200.0)
        detector.satellites(speed, number)
        return first(detector, [(1.0, force)])

    assert found(5.0, 6, 4.0) == pytest.approx(0.035, abs=0.006)  # 40 ms, of which the first sample stands for 5
    for speed, number, force in ((5.0, 5, 4.0), (2.9, 9, 4.0), (5.0, 6, -1.0), (NAN, 9, 4.0), (5.0, NAN, 4.0)):
        assert found(speed, number, force) is None


def test_inav_is_no_launch_when_tilted():
    detector = make("inav", 200.0)
    detector.attitude(0.0, math.radians(46.0))
    assert first(detector, [(1.0, 60.0)]) is None
    detector.attitude(NAN, 0.0)
    assert first(detector, [(0.5, 2.0), (1.0, 60.0)]) is not None
