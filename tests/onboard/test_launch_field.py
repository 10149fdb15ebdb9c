"""The autopilots' rules: examples worked out by hand from their sources, and their defined effects."""

import math

import pytest

import uavsim
from uavsim.onboard.launch import DetectorSettings, Inav, Px4, build
from uavsim.onboard.launch.inav import lowpass

NAN = math.nan
G = 9.80665  # m/s², ISO 80000-3
REST = 1200  # samples on the rail at 1 kHz: more than the two blocks that the mean needs
KINDS = ("px4", "px4-norm", "ardupilot", "inav", "paparazzi", "altos")


def make(kind):
    return build(DetectorSettings(kind=kind), 1000.0)


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
