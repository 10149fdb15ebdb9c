"""Detectors count time, not samples: regular ones against decisions on record; lost, late and jittering ones."""

import inspect
import math
import random
from dataclasses import asdict
from zlib import crc32

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from uavsim.onboard.launch import KINDS as REGISTERED
from uavsim.onboard.launch import DetectorSettings, MultiLevelWindow, build
from uavsim.onboard.launch.detector import periods

NAN = math.nan
RATE = 1000.0  # Hz
KINDS = tuple(REGISTERED)
FIELD = ("px4", "px4-norm", "ardupilot", "inav", "paparazzi", "altos")
WINDOWS = ("multi-level-window", "threshold-window", "sliding-window", "sequence-window", "glr-bank")
HOLDS = ("single-threshold", "double-threshold")
ALL_AXES = ("+x", "-x", "+y", "-y", "+z", "-z")


def make(kind):
    return build(DetectorSettings(kind=kind), RATE)


def shaken(samples, seed=4):
    """Forces along x, y and z, m/s²: levels that jump, with uniform noise of ±12."""
    draw = random.Random(seed)
    level, left, force = 0.0, 0, []
    for _ in range(samples):
        if not left:
            level, left = draw.choice((0.0, 30.0, 38.0, 44.0, 46.0, 50.0, -46.0)), draw.randrange(2, 120)
        left -= 1
        force.append(tuple(level * share + 24.0 * draw.random() - 12.0 for share in (1.0, 0.3, -1.0)))
    return force


def decisions(detector, record):
    """Indices of recognition in a record of (t, fx, fy, fz); each is followed by a reset."""
    found = []
    for k, sample in enumerate(record):
        if detector.step(*sample):
            found.append(k)
            detector.reset()
    return found


RECORDED = {  # how often and where (CRC-32), on 10⁵ samples, before a sample could count more than once
    "multi-level-window": (56, 3357507468),
    "threshold-window": (138, 1606501198),
    "sliding-window": (268, 4286957328),
    "sequence-window": (195, 2928526301),
    "glr-bank": (141, 732545615),
    "any": (2529, 3583396153),
    ("+x", "-x", "-z"): (540, 2611125415),
}


@pytest.mark.parametrize("which", RECORDED)
def test_regular_samples_count_once(which):
    """A failure means that decisions on regular sampling are not those of the first release of these detectors."""
    record = [(k / RATE, *f) for k, f in enumerate(shaken(100_000))]
    levels = {"trigger": 47.0, "threshold": 45.0, "samples": 9, "levels": 3, "ratio": 0.8}
    detector = make(which) if which in KINDS else MultiLevelWindow(**levels, axes=which, period=1.0 / RATE)
    found = decisions(detector, record)
    assert (len(found), crc32(repr(found).encode())) == RECORDED[which]


def test_periods_that_a_sample_stands_for():
    shares = (0.01, 1.0, 1.49, 1.51, 2.0, 2.49, 2.51, 3.0, 3.0000001, 3.1, math.inf)
    assert [periods(0.001 * share, 0.001) for share in shares] == [1, 1, 1, 2, 2, 2, 3, 3, 3, 0, 0]


LOSSES = st.lists(
    st.tuples(st.sampled_from([1, 1, 1, 1, 2, 2, 3]), st.sampled_from([60.0, 50.0, 46.0, 44.0, 30.0, 0.0, NAN])),
    min_size=1,
    max_size=120,
)


@settings(derandomize=True, deadline=None, max_examples=150)
@given(steps=LOSSES, start=st.sampled_from([0, 1, 700, 123_457]), kind=st.sampled_from(WINDOWS))
def test_a_window_takes_lost_samples_to_be_like_the_next(steps, start, kind):
    """Exactly: the record with every lost sample filled in decides at the same samples."""
    tick, sparse, full = start, [], []
    for k, (step, f) in enumerate(steps):
        filled = [tick] if k == 0 else list(range(tick + 1, tick + step + 1))
        tick = filled[-1]
        full += [(t / RATE, f, 0.0, -9.6) for t in filled]
        sparse.append(full[-1])
    whole, lossy = make(kind), make(kind)
    first = next((sample[0] for sample in full if whole.step(*sample)), None)
    expected = None if first is None else next(t for t, *_ in sparse if t >= first)
    assert next((sample[0] for sample in sparse if lossy.step(*sample)), None) == expected


@settings(derandomize=True, deadline=None, max_examples=100)
@given(
    steps=st.lists(st.tuples(st.integers(1, 3), st.sampled_from([50.0, 44.0, 0.0, -50.0, NAN])), max_size=60),
    axes=st.one_of(st.just("any"), st.lists(st.sampled_from(ALL_AXES), min_size=1, unique=True).map(tuple)),
)
def test_every_counter_takes_lost_samples_to_be_like_the_next(steps, axes):
    def new(period):
        return MultiLevelWindow(trigger=47.0, threshold=43.0, samples=4, levels=3, ratio=0.75, axes=axes, period=period)

    lossy, whole, tick = new(1.0 / RATE), new(None), 0
    for k, (step, f) in enumerate(steps):
        tick += step if k else 0
        force = (f, -f, 0.3 * f)
        answer = lossy.step(tick / RATE, *force)
        assert answer is (True in [whole.step(tick + 0.1 * copy, *force) for copy in range(step if k else 1)])
        if answer:
            return


@pytest.mark.parametrize("kind", WINDOWS)
@pytest.mark.parametrize("lost", [2, 3, 5, 7, 11])
def test_a_lost_sample_costs_neither_time_nor_the_decision(kind, lost):
    """A launch of 60 m/s² of which any one sample is missing: recognised at the same time, or 1 ms later."""
    force = [2.0] * 20 + [60.0] * 60
    record = [(k / RATE, f, 0.3, -9.6) for k, f in enumerate(force)]
    found = decisions(make(kind), record)[0]
    for missing in range(lost, len(record), lost):
        sparse = record[:missing] + record[missing + 1 :]
        detector = make(kind)
        t = next(sample[0] for sample in sparse if detector.step(*sample))
        assert t == pytest.approx((found + (missing == found)) / RATE, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_jitter_changes_no_window_and_hardly_a_time(kind):
    """Clocks that shake by 20 % of a period: windows decide at the same samples, times within two.

    A rule of the field may run at other samples, so within a run of 20 ms.
    """
    draw = random.Random(8)
    force = [2.0] * 1200 + [60.0] * 400
    regular = [(k / RATE, f, 0.3, -9.6) for k, f in enumerate(force)]
    shaky = [(t + 0.4 * (draw.random() - 0.5) / RATE, *f) for t, *f in regular]
    first, other = (
        next(k for k, s in enumerate(record) if detector.step(*s))
        for record, detector in ((regular, make(kind)), (shaky, make(kind)))
    )
    assert abs(first - other) <= (0 if kind in WINDOWS else 20 if kind in FIELD else 2)


@pytest.mark.parametrize("kind", [*WINDOWS, *HOLDS])
def test_a_gap_begins_anew(kind):
    """What was counted before 3.5 missing periods is forgotten; the sample after counts like the first."""
    force = [60.0] * 60
    first = decisions(make(kind), [(k / RATE, f, 0.0, 0.0) for k, f in enumerate(force)])[0]
    detector = make(kind)
    assert not any(detector.step(k / RATE, 60.0, 0.0, 0.0) for k in range(first))
    gap = (first - 1 + 3.5) / RATE
    assert [k for k, f in enumerate(force) if detector.step(gap + k / RATE, f, 0.0, 0.0)] == [first]


@pytest.mark.parametrize("kind", KINDS)
def test_samples_faster_than_the_rate_are_no_gap_and_do_not_stop_it(kind):
    """Twice the samples: times are kept where it is time that counts, and counts are reached no later."""
    quiet, launch = (
        [(k / 2.0 / RATE, f, 0.3, -9.6) for k in range(*span)] for f, span in ((2.0, (2400,)), (60.0, (2400, 3400)))
    )
    usual = [(k / RATE, 2.0 if k < 1200 else 60.0, 0.3, -9.6) for k in range(1700)]
    detector, fast = make(kind), make(kind)
    t = next(s[0] for s in usual if detector.step(*s))
    assert next(s[0] for s in quiet + launch if fast.step(*s)) <= t + 0.001


@pytest.mark.parametrize("kind", KINDS)
def test_late_and_nan_samples_do_not_speak_for_a_launch(kind):
    """60 m/s² only in samples that are late, without a time or NaN: nothing, and the windows go on."""
    detector = make(kind)
    for k in range(2000):
        assert not detector.step(k / RATE, 2.0, 0.3, -9.6)
        for t in (k / RATE, (k - 0.5) / RATE, -1.0, NAN, math.inf, -math.inf):
            assert not detector.step(t, 60.0, 0.3, -9.6)
        if k % 5 == 0:
            assert not detector.step((k + 0.3) / RATE, NAN, NAN, NAN)
    assert any(detector.step((2000 + k) / RATE, 60.0, 0.3, -9.6) for k in range(500))


@pytest.mark.parametrize("kind", FIELD)
def test_a_rule_of_the_field_has_one_default(kind):
    """The class, the keys of its group and what is built are the same."""
    group = asdict(getattr(DetectorSettings(), REGISTERED[kind].reads[0]))
    parameters = inspect.signature(REGISTERED[kind].cls.__init__).parameters
    assert group == {key: parameters[key].default for key in group}
    assert {*parameters} == {"self", "rate", "axis", *group}


@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        ("px4", "acceleration", 61.0),
        ("px4-norm", "time", 0.1),
        ("ardupilot", "acceleration", 61.0),
        ("ardupilot", "delay", 0.1),
        ("ardupilot", "count", 2),
        ("inav", "acceleration", 61.0),
        ("inav", "time", 0.03),
        ("inav", "cutoff", 3.0),
        ("paparazzi", "calls", 4),
        ("paparazzi", "call_rate", 100.0),
        ("altos", "speed", 6.0),
    ],
)
def test_keys_of_a_rule_reach_it(kind, key, value):
    """It decides as the class does with that argument, and not as it does without, on 60 m/s² beyond 2 at rest."""
    changed = TypeAdapter(DetectorSettings).validate_python({"kind": kind, REGISTERED[kind].reads[0]: {key: value}})
    record = [(k / RATE, 62.0 if k >= 1200 else 2.0, 0.3, -9.6) for k in range(1600)]
    built, bare, usual = (
        decisions(detector, record)[:1]
        for detector in (build(changed, RATE), REGISTERED[kind].cls(RATE, **{key: value}), make(kind))
    )
    assert built == bare != usual != []


@pytest.mark.parametrize("far", [3.0, 1000.0])
def test_counters_of_several_axes_leave_out_one_stamp_far_ahead(far):
    """The next sample follows the one before it, so decisions are those without the stray one."""
    levels = {"trigger": 47.0, "threshold": 43.0, "samples": 4, "levels": 3, "ratio": 0.75}
    record = [(k / RATE, 50.0 if k >= 300 else 2.0, 0.0, -9.6) for k in range(400)]
    stray = [*record[:299], (record[298][0] + far, 50.0, 0.0, -9.6), *record[299:]]
    plain = decisions(MultiLevelWindow(**levels, axes=("+x", "-z"), period=1.0 / RATE), record)
    found = decisions(MultiLevelWindow(**levels, axes=("+x", "-z"), period=1.0 / RATE), stray)
    assert plain
    assert [stray[k] for k in found] == [record[k] for k in plain]


@pytest.mark.parametrize("kind", WINDOWS)
def test_what_a_window_shows_is_nothing_again_after_a_quiet_second(kind):
    detector = make(kind)
    shown = set()
    for k in range(1200):
        assert not detector.step(k / RATE, 46.0 if 100 <= k < 103 else 2.0, 0.0, -9.6)
        shown.add((detector.level, detector.count, detector.total, detector.triggered))
    assert len(shown) > 1
    assert (detector.level, detector.count, detector.total, detector.triggered) == (0, 0, 0, False)
