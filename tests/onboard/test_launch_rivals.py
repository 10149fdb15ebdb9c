"""The detectors of one signed axis: hand-computed examples, naive readings of the definitions, defined effects."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import uavsim
from uavsim.onboard import launch
from uavsim.onboard.launch import (
    Cusum,
    DetectorSettings,
    DoubleThreshold,
    GlrBank,
    SequenceWindow,
    SingleThreshold,
    SlidingWindow,
    ThresholdWindow,
    build,
)
from uavsim.scenario import load_scenario

NAN = math.nan
G = 9.80665  # m/s², ISO 80000-3
FIELD = ("px4", "px4-norm", "ardupilot", "inav", "paparazzi", "altos")
KINDS = tuple(k for k in launch.KINDS if k not in FIELD and k != "multi-level-window")


def recognised(detector, force, period=0.001):
    """Indices at which `step` is True for samples along x."""
    return [k for k, f in enumerate(force) if detector.step(k * period, f, 0.0, -9.8)]


def ring_curve(samples):
    """A plateau of amplitude 1 with a decaying structural ring, rising in 3 ms; see test_launch.py."""
    ring = [0.5 * math.exp(-k / 50) * math.cos(0.24 * math.pi * k + 1.75 * math.pi) for k in range(samples)]
    return [min(k / 3, 1.0) * (1.0 + r) for k, r in enumerate(ring)]


# -- windows ---------------------------------------------------------------------------------------------------------


def test_published_table_1():
    """Of its three algorithms the second (one window, no second try) fails on the ring, the third (sliding) does not.

    The first 7 of 10 above 3/4 of the amplitude are too few; the third algorithm sees 10 of 10 later.
    """
    level = {"threshold": 0.75, "window": 0.010, "ratio": 0.8}
    assert recognised(ThresholdWindow(1000.0, **level, rearm=False), ring_curve(400)) == []
    assert recognised(SlidingWindow(1000.0, **level), ring_curve(400)) != []
    assert recognised(ThresholdWindow(1000.0, **level), ring_curve(400)) != []


def test_threshold_window_is_tested_at_its_end_and_opens_again():
    force = [50.0] * 3 + [0.0] * 7 + [0.0, 50.0] + [50.0] * 9
    detector = ThresholdWindow(1000.0, threshold=45.0, window=0.010, ratio=0.8)
    assert recognised(detector, force) == [20]
    assert (detector.level, detector.count, detector.total, detector.triggered) == (1, 10, 10, True)
    opened_above = ThresholdWindow(1000.0, threshold=45.0, trigger=55.0, window=0.010, ratio=0.8)
    assert recognised(opened_above, [50.0] * 5 + [56.0] + [50.0] * 20) == [14]


def test_sliding_window_is_tested_at_every_sample():
    """Eight of the last ten: two gaps in the plateau delay it by what they take."""
    make = {"rate": 1000.0, "threshold": 45.0, "window": 0.010, "ratio": 0.8}
    assert recognised(SlidingWindow(**make), [50.0] * 3 + [0.0, 0.0] + [50.0] * 20) == [9]
    assert recognised(SlidingWindow(**make), [50.0] * 3 + [0.0] * 3 + [50.0] * 20) == [13]
    assert recognised(SlidingWindow(**make), [50.0] * 7 + [0.0] * 3 + [50.0] * 7 + [0.0] * 3) == []
    assert recognised(SlidingWindow(**make), [45.0] * 30) == []  # strictly above


@pytest.mark.parametrize("samples", range(20, 401, 20))
def test_sliding_ratio_is_compared_in_whole_numbers(samples):
    """0.55·samples is whole but, in floating point, above it for some."""
    needed = 11 * samples // 20
    detector = SlidingWindow(1000.0, threshold=45.0, window=0.001 * samples, ratio=0.55)
    assert recognised(detector, [50.0] * samples) == [needed - 1]


def test_sequence_window_needs_some_in_a_row():
    make = {"threshold": 40.0, "trigger": 45.0, "window": 0.006, "ratio": 0.8, "sequence": 0.003}
    alternating = [50.0, 50.0, 0.0] * 20
    assert recognised(SequenceWindow(1000.0, **make), alternating) == []
    assert recognised(SequenceWindow(1000.0, **make), [50.0, 50.0, 42.0, 50.0, 50.0, 50.0, 42.0, 42.0, 42.0]) == [8]
    assert recognised(SequenceWindow(1000.0, **make), [50.0] * 3 + [0.0] * 3 + [50.0] * 6) == [11]  # opens again
    assert recognised(SequenceWindow(1000.0, **make | {"window": 0.003}), [50.0] * 5) == [2]


def counted(times, force):
    """Index and force of each sample, as often as it stands for a period of 1 ms; None after a gap."""
    last = None
    for index, (t, f) in enumerate(zip(times, force, strict=True)):
        if last is not None and not t > last:
            continue
        ticks = 1 if last is None else round(1000.0 * (t - last))
        last = t
        if ticks > 3:
            yield index, None
        for _ in range(ticks if ticks <= 3 else 1):
            yield index, f


def naive_sliding(times, force, needed, samples):
    """Counts anew at each sample among the last n since the last gap."""
    kept = []
    for index, f in counted(times, force):
        kept = [] if f is None else [*kept, f]
        if sum(f > 45.0 for f in kept[-samples:]) >= needed:
            return [index]
    return []


STEPS = st.lists(
    st.tuples(
        st.sampled_from([1, 1, 1, 1, 1, 2, 3, 5, 0, -1]), st.sampled_from([60.0, 50.0, 48.0, 44.0, 30.0, 0.0, NAN])
    ),
    max_size=80,
)


def clocked(record, start=0):
    """Times in s and forces of steps in whole nominal periods."""
    ticks = [start]
    for step, _ in record[1:]:
        ticks.append(ticks[-1] + step)
    return [k / 1000.0 for k in ticks[: len(record)]], [f for _, f in record]


@settings(derandomize=True, deadline=None, max_examples=400)
@given(record=STEPS, samples=st.integers(1, 9), share=st.sampled_from([(1, 2), (2, 3), (4, 5), (1, 1)]))
def test_sliding_window_against_the_definition(record, samples, share):
    times, force = clocked(record)
    needed = math.ceil(share[0] * samples / share[1] - 1e-9)
    detector = SlidingWindow(1000.0, threshold=45.0, window=0.001 * samples, ratio=share[0] / share[1])
    answers = [k for k, (t, f) in enumerate(zip(times, force, strict=True)) if detector.step(t, f, 0.0, 0.0)]
    assert answers == naive_sliding(times, force, needed, samples)


# -- thresholds to be held -------------------------------------------------------------------------------------------


def test_single_threshold_is_held():
    detector = SingleThreshold(1000.0, threshold=45.0, window=0.014)
    assert recognised(detector, [50.0] * 13 + [45.0] + [50.0] * 14 + [50.0] * 9) == [27]


def test_double_threshold_begins_above_one_level_and_is_held_above_the_other():
    def make():
        return DoubleThreshold(1000.0, trigger=47.0, threshold=42.0, window=0.005)

    assert recognised(make(), [45.0] * 20) == []
    assert recognised(make(), [45.0, 45.0, 48.0, 43.0, 43.0, 43.0, 43.0]) == [6]
    assert recognised(make(), [48.0, 43.0, 42.0, 43.0, 43.0, 43.0, 43.0, 48.0] + [43.0] * 4) == [11]


def test_a_hold_counts_time_not_samples():
    """Every third sample missing: 14 ms pass in fewer samples. The first counts 1 ms, the others what has passed."""
    times = [k / 1000.0 for k in range(40) if k % 3 != 1]  # 0, 2, 3, 5, 6, 8, 9, 11, 12, 14 ms
    detector = SingleThreshold(1000.0, threshold=45.0, window=0.014)
    found = [t for t in times if detector.step(t, 50.0, 0.0, 0.0)]
    assert found == [0.014]


# -- statistical -----------------------------------------------------------------------------------------------------


def test_cusum_by_hand():
    """c = 4.5 g, +1 g and -2 g at most: 0.5, 1.5, 2.5, 0.5, 0 (not below), 1 g·ms."""
    detector = Cusum(1000.0)
    sums = []
    for k, f in enumerate((5.0, 5.5, 30.0, -10.0, 4.0, 6.0)):
        assert not detector.step(0.001 * k, f * G, 0.0, -G)
        sums.append(detector.sum / (0.001 * G))
    assert sums == pytest.approx([0.5, 1.5, 2.5, 0.5, 0.0, 1.0], abs=1e-9)


def test_cusum_exceeds_its_limit():
    """At 5 g, half a g·ms a sample: 28 samples reach 14 g·ms, and the 29th exceeds it; a shock of 14 ms never does."""
    assert recognised(Cusum(1000.0), [5.0 * G] * 60) == [28]
    assert recognised(Cusum(1000.0), [50.0 * G] * 14 + [0.0] * 60) == []
    assert recognised(Cusum(1000.0), [4.5 * G] * 1000) == []


@pytest.mark.parametrize("start", [0.0, 0.1, 7.3, 1234.567])
def test_cusum_at_the_clip_does_not_depend_on_the_rounding_of_time(start):
    detector = Cusum(1000.0)
    found = [k for k in range(40) if detector.step(start + k / 1000.0, 100.0, 0.0, 0.0)]
    assert found == [14]


def test_cusum_counts_time_not_samples():
    """Every second sample missing: each stands for 2 ms, the first for one, so the eighth makes 15 g·ms."""
    detector = Cusum(1000.0)
    assert [k for k in range(20) if detector.step(0.002 * k, 100.0, 0.0, 0.0)] == [7]


def test_a_sample_after_a_gap_counts_for_three_periods():
    detector = Cusum(1000.0)
    detector.step(0.0, 100.0, 0.0, 0.0)
    detector.step(0.9, 100.0, 0.0, 0.0)
    assert detector.sum == pytest.approx(4e-3 * G, rel=1e-12)


def naive_cusum(times, force):
    total, last = 0.0, None
    for index, (t, f) in enumerate(zip(times, force, strict=True)):
        if last is not None and not t > last:
            continue
        dt = 0.001 if last is None else min(t - last, 0.003)
        excess = -2.0 * G if math.isnan(f) else min(max(f - 4.5 * G, -2.0 * G), G)
        total, last = max(0.0, total + excess * dt), t
        if total > 0.0055 * G:
            return [index]
    return []


@settings(derandomize=True, deadline=None, max_examples=400)
@given(record=STEPS)
def test_cusum_against_the_definition(record):
    times, force = clocked(record)
    detector = Cusum(1000.0, limit=0.0055 * G)
    answers = [k for k, (t, f) in enumerate(zip(times, force, strict=True)) if detector.step(t, f, 0.0, 0.0)]
    assert answers == naive_cusum(times, force)


def naive_glr(times, force, lengths, limit):
    """Sums every window anew at each sample; before the first and after a gap they are filled with the lower clip."""
    clipped = [-G] * max(lengths)
    for index, f in counted(times, force):
        if f is None:
            clipped = [-G] * max(lengths)
            continue
        clipped.append(-G if math.isnan(f) else min(max(f - 4.5 * G, -G), G))
        if any(0.001 * sum(clipped[-n:]) / math.sqrt(0.001 * n) > limit for n in lengths):
            return [index]
    return []


@settings(derandomize=True, deadline=None, max_examples=400)
@given(record=STEPS, start=st.integers(0, 1000))
def test_glr_bank_against_the_definition(record, start):
    times, force = clocked(record, start)
    limit = 1.37 * G * math.sqrt(0.001)
    detector = GlrBank(1000.0, limit=limit, windows=(0.002, 0.004, 0.009))
    answers = [k for k, (t, f) in enumerate(zip(times, force, strict=True)) if detector.step(t, f, 0.0, 0.0)]
    assert answers == naive_glr(times, force, (2, 4, 9), limit)


def test_glr_bank_forgets_exactly():
    """However long it shook, sums return to those of a new one."""
    detector, fresh = GlrBank(1000.0), GlrBank(1000.0)
    shake = [4.2 * G + 3.0 * math.sin(0.7 * k) for k in range(20_000)]
    assert recognised(detector, shake + [0.0] * 96) == []
    assert not detector.triggered
    launch = [5.2 * G + math.sin(k) for k in range(200)]
    later = [k for k, f in enumerate(launch) if detector.step(20.5 + 0.001 * k, f, 0.0, 0.0)]
    assert later == recognised(fresh, launch) != []


def test_glr_bank_takes_different_lengths_only_once():
    """At 50 Hz windows of 6, 12 and 24 ms are one sample: 20 ms at 1 g are 4.5 g √ms."""
    assert recognised(GlrBank(50.0), [6.0 * G], 0.02) == [0]
    assert recognised(GlrBank(50.0), [5.2 * G], 0.02) == []


# -- what all of them have in common ---------------------------------------------------------------------------------


@pytest.fixture(params=KINDS)
def detector(request):
    return build(DetectorSettings(kind=request.param), 1000.0)


def test_recognised_once_until_reset(detector):
    assert (detector.level, detector.count, detector.total, detector.triggered) == (0, 0, 0, False)
    first = recognised(detector, [60.0] * 300)
    assert len(first) == 1
    assert detector.triggered is True
    detector.reset()
    assert (detector.level, detector.count, detector.total, detector.triggered) == (0, 0, 0, False)
    assert recognised(detector, [60.0] * 300) == first  # times start at 0 again


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("axis", ["+x", "-x", "+y", "-y", "+z", "-z"])
def test_each_signed_axis(kind, axis):
    force = [0.0, 0.0, 0.0]
    force["xyz".index(axis[1])] = float(axis[0] + "1") * 60.0
    expected = recognised(build(DetectorSettings(kind=kind), 1000.0), [60.0] * 100)
    along, against = (build(DetectorSettings(kind=kind, axes=(axis,)), 1000.0) for _ in range(2))
    assert [k for k in range(100) if along.step(0.001 * k, *force)] == expected
    assert not any(against.step(0.001 * k, *(-f for f in force)) for k in range(100))


def test_a_published_centrifuge_at_4_1_g_is_none_and_15_g_is_a_launch(detector):
    """Without noise every sample is like the last, so 2 s say what 60 s would."""
    assert recognised(detector, [4.1 * G] * 2000) == []
    detector.reset()
    assert len(recognised(detector, [15.15 * G] * 100)) == 1


def test_nan_never_speaks_for_a_launch(detector):
    assert recognised(detector, [NAN] * 300) == []
    assert not detector.triggered
    detector.reset()
    assert recognised(detector, [60.0, 60.0, NAN, NAN, NAN, NAN] * 100) == []
    detector.reset()
    assert [k for k in range(100) if detector.step(0.001 * k, 60.0, NAN, NAN)] != []  # the other axes are not read


def test_late_samples_and_those_without_a_time_are_ignored(detector):
    expected = recognised(detector, [60.0] * 100)
    detector.reset()
    answers = []
    for k in range(100):
        answers.append(detector.step(0.001 * k, 60.0, 0.0, 0.0))
        for late in (0.001 * k, 0.001 * k - 0.0005, -1.0, -math.inf, NAN, math.inf):
            assert not detector.step(late, 0.0, 0.0, 0.0)
    assert [k for k, answer in enumerate(answers) if answer] == expected


def test_samples_a_second_apart_are_no_launch(detector):
    """Windows and holds begin anew, and a sum grows by three periods at most and falls by as much as twice."""
    assert not any(detector.step(float(k), 60.0 if k % 2 else 0.0, 0.0, 0.0) for k in range(60))


@pytest.mark.parametrize("force", [math.inf, 1e300, 4000.0])
def test_a_force_beyond_every_accelerometer_is_none(detector, force):
    """However long it lasts; just below, 408 g, it is one as any other."""
    assert recognised(detector, [force, -force] * 100) == []
    detector.reset()
    assert recognised(detector, [force] * 200) == []
    detector.reset()
    assert recognised(detector, [3999.0] * 100) == recognised(build_like(detector), [400.0] * 100) != []


def build_like(detector):
    """A new one of the same kind."""
    kind = next(kind.name for kind in launch.KINDS.values() if kind.cls is type(detector))
    return build(DetectorSettings(kind=kind), 1000.0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rate", [20.0, 50.0, 104.0, 833.0, 3200.0])
def test_windows_are_times_at_every_rate(kind, rate):
    """A launch of 6.7 g is recognised within 60 ms, or three samples, whatever the rate."""
    found = recognised(build(DetectorSettings(kind=kind), rate), [6.7 * G] * 400, 1.0 / rate)
    assert len(found) == 1
    assert (found[0] + 1) / rate <= max(0.060, 3.0 / rate)


RIGHT = {
    ThresholdWindow: {"threshold": 45.0, "window": 0.01, "ratio": 0.8},
    SlidingWindow: {"threshold": 45.0, "window": 0.01, "ratio": 0.8},
    SequenceWindow: {"threshold": 45.0, "window": 0.01, "ratio": 0.8, "sequence": 0.003},
    SingleThreshold: {"threshold": 45.0, "window": 0.01},
    DoubleThreshold: {"threshold": 45.0, "window": 0.01},
    Cusum: {},
    GlrBank: {},
}
WRONG = [
    *((kind, {"rate": rate}) for kind in RIGHT for rate in (0.0, -1.0, NAN, math.inf)),
    *((kind, {"axis": "x"}) for kind in RIGHT),
    *((kind, {key: NAN}) for kind, right in RIGHT.items() for key in right),
    *((kind, {"window": 0.0}) for kind, right in RIGHT.items() if "window" in right),
    *((kind, {"trigger": 44.0}) for kind in (ThresholdWindow, SequenceWindow, DoubleThreshold)),
    (SequenceWindow, {"sequence": 0.011}),
    *((kind, {key: wrong}) for kind in (Cusum, GlrBank) for key in ("limit", "rise", "fall") for wrong in (0.0, NAN)),
    *((kind, {"reference": NAN}) for kind in (Cusum, GlrBank)),
    (GlrBank, {"windows": ()}),
    (GlrBank, {"windows": (0.01, 0.0)}),
]


@pytest.mark.parametrize(("kind", "changes"), WRONG)
def test_settings_out_of_bounds_are_refused(kind, changes):
    with pytest.raises(ValueError, match="must"):
        kind(**{"rate": 1000.0} | RIGHT[kind] | changes)


@pytest.mark.parametrize("axes", ["any", ("+x", "-x")])
@pytest.mark.parametrize("kind", KINDS)
def test_one_axis_is_one_axis(kind, axes):
    with pytest.raises(ValueError, match="one signed axis"):
        build(DetectorSettings(kind=kind, axes=axes), 1000.0)


# -- in a scenario ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["multi-level-window", "sliding-window"])
def test_a_flight_ends_in_cruise(kind):
    flight = uavsim.fly("catapult", overrides=[f"detector.kind={kind}"])
    assert flight.score["outcome"] == "cruise"
    assert flight.score["launch"]["false_detections"] == 0
    assert 0.0 < flight.score["launch"]["latency"] < 0.060  # the bound for a launch of 6.7 g
    detector = build(DetectorSettings(kind=kind), 833.0)
    found = [row[0] for row in flight.accelerometer.to_numpy().tolist() if detector.step(*row)]
    assert found[:1] == [next(event["t"] for event in flight.events if event["event"] == "launch_detected")]


@pytest.mark.parametrize(
    ("sets", "says"),
    [
        (["kind=cusum", "threshold=40"], "is not read by kind = 'cusum', which reads cusum, axes"),
        (
            ["sequence=0.01"],
            "detector.sequence: is not read by kind = 'adaptive-cusum', which reads adaptive, threshold",
        ),
        (["kind=sliding-window", "trigger=50"], "is not read by kind = 'sliding-window'"),
        (["kind=cusum", "axes=any"], "must be one signed axis for kind = 'cusum'"),
        (["kind=cusum", "cusum.reference=400"], "detector.cusum.reference = 400 m/s²: lsm6dso32 at ±32 g can never"),
        (["kind=glr-bank", "glr.reference=400"], "detector.glr.reference = 400 m/s²"),
        (["kind=px4", "threshold=40"], "is not read by kind = 'px4', which reads px4, axes"),
        (["kind=px4", "cusum.limit=0.2"], "detector.cusum.limit: is not read by kind = 'px4', which reads px4, axes"),
        (["px4.time=0.1"], "detector.px4.time: is not read by kind = 'adaptive-cusum'"),
        (["kind=px4-norm", "px4.acceleration=400"], "detector.px4.acceleration = 400 m/s²: lsm6dso32 at ±32 g can"),
        (["kind=inav", "inav.time=0.5"], "detector.inav.time: takes 500 ms"),
        (["kind=paparazzi", "paparazzi.calls=31"], "detector.paparazzi.calls: takes 500 ms"),
        (["kind=altos", "altos.speed=40"], "detector.altos.speed: takes 500 ms"),
        (["kind=ardupilot", "ardupilot.acceleration=400"], "detector.ardupilot.acceleration = 400 m/s²"),
        (["kind=double-threshold", "trigger=20"], "must be at least the threshold"),
        (
            ["kind=single-threshold", "window=0.5"],
            "detector.window: takes 500 ms, and a stroke of 5.2 m at 80.0 m/s² lasts no more than 361 ms",
        ),
        (["adaptive.limit=4"], "detector.adaptive.limit: takes 408 ms"),
        (["threshold=400"], "detector.threshold = 400 m/s²: lsm6dso32 at ±32 g can never"),
        (["adaptive.reference=400"], "detector.adaptive.reference = 400 m/s²"),
        (["kind=cusum", "cusum.limit=4"], "detector.cusum.limit: takes 408 ms"),
        (["kind=px4", "kind=inav", "axes=any"], "must be one signed axis for kind = 'inav'"),
        (["kind=glr-bank", "glr.windows=[0.7, 0.6]"], "detector.glr.windows: takes 600 ms"),
    ],
)
def test_a_scenario_refuses_what_cannot_work(sets, says):
    with pytest.raises(ValueError, match=r"^--set: ") as error:
        load_scenario("catapult", overrides=[f"detector.{x}" for x in sets])
    assert says in str(error.value)
