"""The multi-level window against the published tables, a naive reading of its definition, and its defined effects."""

import doctest
import math
from dataclasses import fields

import numpy as np
import pydantic
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uavsim.onboard import launch
from uavsim.onboard.launch import (
    DetectorSettings,
    MultiLevelWindow,
    cusum,
    glr,
    hold,
    nested,
    sequence_window,
    sliding_window,
)
from uavsim.onboard.launch import settings as launch_settings

ALL_AXES = ("+x", "-x", "+y", "-y", "+z", "-z")
NAN = math.nan


def test_examples():
    for module in (nested, sliding_window, sequence_window, hold, cusum, glr, launch_settings):
        results = doctest.testmod(module)
        assert results.attempted > 0 == results.failed


def make(**changes):
    return MultiLevelWindow(**{"trigger": 45.0, "threshold": 45.0, "samples": 10, "levels": 4, "ratio": 0.8} | changes)


def recognised(detector, force, period=0.001):
    """Indices at which `step` is True for samples along x."""
    return [k for k, f in enumerate(force) if detector.step(k * period, f, 0.0, -9.8)]


def ring_curve(samples, period=0.001):
    """A launch plateau of amplitude 1 with a decaying structural ring, rising in 3 ms."""
    t = np.arange(samples) * period
    ring = 0.5 * np.exp(-t / 0.050) * np.cos(2 * np.pi * 120.0 * t + 7 * np.pi / 4)
    return (np.minimum(t / 0.003, 1.0) * (1.0 + ring)).tolist()


def test_published_table_2():
    """Counts 7, 14, 22, 32 of 10, 20, 30, 40 above 3/4 of the amplitude: recognised in window 4, with 0.8 ≥ k₁."""
    detector = make(trigger=0.75, threshold=0.75, samples=10)
    ends = []
    for k, f in enumerate(ring_curve(80)):
        recognised_now = detector.step(0.001 * k, f, 0.0, 0.0)
        if detector.total in (10, 20, 30, 40) and len(ends) < detector.level:
            ends.append((detector.level, detector.count, detector.total, detector.triggered, recognised_now))
    assert ends == [
        (1, 7, 10, True, False),
        (2, 14, 20, True, False),
        (3, 22, 30, True, False),
        (4, 32, 40, True, True),
    ]


@pytest.mark.parametrize(("levels", "answer"), [(4, True), (1, False)])
def test_published_table_1(levels, answer):
    """Algorithm 1 recognises; one window alone (algorithm 2, which does not trigger again) does not."""
    detector = make(trigger=0.75, threshold=0.75, samples=10, levels=levels, rearm=False)
    assert bool(recognised(detector, ring_curve(400))) is answer


def test_ratio_is_reached_not_exceeded():
    force = [50.0] * 8 + [0.0] * 2
    assert recognised(make(levels=1), force) == [9]
    assert recognised(make(levels=1), [50.0] * 7 + [0.0] * 3) == []


@pytest.mark.parametrize("samples", range(20, 401, 20))
def test_ratio_is_compared_in_whole_numbers(samples):
    """0.55 of a multiple of 20 is whole, but 0.55·samples in floating point is above it for some."""
    needed = 11 * samples // 20
    force = [50.0] * needed + [0.0] * (samples - needed)
    assert recognised(make(samples=samples, levels=1, ratio=0.55), force) == [samples - 1]
    force[needed - 1] = 0.0
    assert recognised(make(samples=samples, levels=1, ratio=0.55), force) == []


def test_trigger_and_threshold_are_strict():
    assert recognised(make(samples=1, levels=1), [45.0, math.nextafter(45.0, 50.0)]) == [1]
    hysteresis = {"trigger": 50.0, "threshold": 40.0, "samples": 2, "levels": 1, "ratio": 1.0}
    assert recognised(make(**hysteresis), [45.0, 45.0, 51.0, 40.0, 51.0, 40.1]) == [5]


def test_trigger_sample_counts():
    """Eight above of ten with the trigger's own sample the first of them."""
    force = [0.0, 0.0, 50.0, 0.0, 0.0] + [50.0] * 7
    assert recognised(make(levels=1), force) == [11]


def test_recognised_once_until_reset():
    detector = make()
    assert recognised(detector, [50.0] * 200) == [9]
    state = detector.level, detector.count, detector.total, detector.triggered
    assert state == (1, 10, 10, True)
    detector.reset()
    assert (detector.level, detector.count, detector.total, detector.triggered) == (0, 0, 0, False)
    assert recognised(detector, [0.0] * 5 + [50.0] * 200) == [14]  # times start at 0 again


def test_rearms_after_the_last_window():
    bump = [50.0] * 3 + [0.0] * 17
    launch_force = [50.0] * 20
    assert recognised(make(levels=2), bump + launch_force) == [29]
    assert recognised(make(levels=2, rearm=False), bump + launch_force * 5) == []
    early = [50.0] * 3 + [0.0] * 16 + launch_force  # the launch begins while the bump's window is still open
    assert recognised(make(levels=2), early) == [29]


def test_failed_window_is_shown_and_then_cleared():
    for rearm in (True, False):
        detector = make(samples=2, levels=2, rearm=rearm)
        shown = []
        for k, f in enumerate([50.0, 0.0, 0.0, 50.0, 0.0, 0.0]):
            detector.step(0.001 * k, f, 0.0, 0.0)
            shown.append((detector.level, detector.count, detector.total, detector.triggered))
        assert shown == [
            (1, 1, 1, True),
            (1, 1, 2, True),
            (2, 1, 3, True),
            (2, 2, 4, False),
            (0, 0, 0, False),
            (0, 0, 0, False),
        ]


@pytest.mark.parametrize(("axis", "index", "sign"), [(a, "xyz".index(a[1]), float(a[0] + "1")) for a in ALL_AXES])
def test_each_signed_axis(axis, index, sign):
    def run(axes, value):
        detector = make(axes=axes)
        force = [0.0, 0.0, 0.0]
        force[index] = value
        return [k for k in range(30) if detector.step(0.001 * k, *force)]

    others = tuple(a for a in ALL_AXES if a != axis)
    assert run((axis,), sign * 50.0) == [9]
    assert run((axis,), -sign * 50.0) == []
    assert run(others, sign * 50.0) == []
    assert run(ALL_AXES, sign * 50.0) == [9]
    assert run("any", sign * 50.0) == [9]


def test_axes_count_apart_but_any_does_not():
    """A shaking force that changes its axis or sign every sample: the literal rule takes it for a launch."""
    shake = [(50.0, 0.0, 0.0), (-50.0, 0.0, 0.0), (0.0, 50.0, 0.0), (0.0, 0.0, -50.0)] * 20
    any_axis, apart = make(axes="any"), make(axes=ALL_AXES)
    assert [k for k, f in enumerate(shake) if any_axis.step(0.001 * k, *f)] == [9]
    assert not any(apart.step(0.001 * k, *f) for k, f in enumerate(shake))


def test_state_is_that_of_the_furthest_axis():
    detector = make(axes=("+x", "+y"), samples=4)
    for k, (fx, fy) in enumerate([(0.0, 50.0), (50.0, 0.0), (50.0, 0.0)]):
        detector.step(0.001 * k, fx, fy, 0.0)
    assert (detector.level, detector.count, detector.total, detector.triggered) == (1, 1, 3, True)


def test_nan_is_a_sample_that_does_not_exceed():
    force = [NAN, 50.0, 50.0, NAN, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, NAN, 50.0]
    assert recognised(make(levels=1), force) == [10]
    assert recognised(make(levels=1), [50.0, NAN, NAN, NAN] + [50.0] * 6) == []
    detector = make(axes="any", levels=1)
    assert [k for k in range(20) if detector.step(0.001 * k, NAN, -50.0, NAN)] == [9]


def test_times_that_do_not_increase_are_ignored():
    detector = make(levels=1)
    answers = []
    for k in range(10):
        answers.append(detector.step(0.001 * k, 50.0, 0.0, 0.0))
        for late in (0.001 * k, 0.001 * k - 0.0005, -1.0, NAN):
            assert not detector.step(late, 0.0 if k < 9 else 50.0, 0.0, 0.0)
    assert answers == [False] * 9 + [True]


def test_gap_abandons_the_window():
    def run(gap, period):
        detector = make(levels=1, period=period, rearm=False)
        times = [0.001 * k for k in range(5)] + [0.004 + gap + 0.001 * k for k in range(30)]
        return [k for k, t in enumerate(times) if detector.step(t, 50.0, 0.0, 0.0)]

    assert run(0.003, 0.001) == [7]  # not longer than the limit, also in floating point: five, three and two make ten
    assert run(0.0031, 0.001) == [14]  # the sample after the gap opens a new window, and the failed one is not held
    assert run(10.0, None) == [9]


@pytest.mark.parametrize("start", [0.0, 0.1, 7.3, 1234.567])
def test_two_missing_samples_cost_no_time_and_three_are_a_gap(start):
    """Three nominal periods at 1 kHz, whatever the rounding of k/rate: 18 ms are full with the sample at 18 ms."""
    times = [start + k / 1000.0 for k in range(19) if k % 3 == 0]
    detector = launch.build(DetectorSettings(kind="multi-level-window"), 1000.0)
    assert [k for k, t in enumerate(times) if detector.step(t, 60.0, 0.0, 0.0)] == [6]
    detector.reset()
    assert [k for k, t in enumerate(times[:5]) if detector.step(t, 60.0, 0.0, 0.0)] == []
    assert detector.total == 13
    detector.step(times[4] + 0.004, 60.0, 0.0, 0.0)
    assert detector.total == 1


def test_gap_before_the_window_does_not_matter():
    detector = make(period=0.001, levels=1)
    detector.step(0.0, 0.0, 0.0, 0.0)
    assert [k for k in range(20) if detector.step(0.9 + 0.001 * k, 50.0, 0.0, 0.0)] == [9]


def naive(times, force, *, trigger, threshold, samples, levels, ratio, rearm, period):
    """The definition read word by word over a whole record: index of recognition, or None.

    A sample that comes two or three periods after the last stands in the record two or three times.
    """
    kept = []  # index, whether there is a gap before it
    last = None
    for index, t in enumerate(times):
        if last is None or t > last:
            ticks = 1 if last is None or not period else round((t - last) / period)
            kept += [(index, ticks > 3)] + [(index, False)] * (ticks - 1 if ticks <= 3 else 0)
            last = t
    numerator, denominator = ratio
    start = 0
    while start < len(kept):
        if not force[kept[start][0]] > trigger:
            start += 1
            continue
        for level in range(1, levels + 1):
            window = kept[start : start + level * samples]
            gaps = [k for k in range(1, len(window)) if window[k][1]]
            if gaps:
                start += gaps[0]
                break
            if len(window) < level * samples:
                return None
            if sum(force[k] > threshold for k, _ in window) * denominator >= numerator * len(window):
                return window[-1][0]
        else:
            start += levels * samples
            if not rearm:
                return None
    return None


SAMPLE = st.tuples(
    st.sampled_from([0.001, 0.001, 0.001, 0.001, 0.002, 0.003, 0.005, 0.0, -0.001]),
    *[st.sampled_from([50.0, 50.0, 47.0, 44.0, 0.0, -47.0, -50.0, NAN])] * 3,
)


@settings(derandomize=True, deadline=None, max_examples=600)
@given(
    record=st.lists(SAMPLE, max_size=60),
    trigger=st.sampled_from([43.0, 45.0, 47.0]),
    samples=st.integers(1, 5),
    levels=st.integers(1, 4),
    ratio=st.sampled_from([(1, 5), (1, 2), (11, 20), (2, 3), (4, 5), (1, 1)]),
    axes=st.one_of(st.just("any"), st.lists(st.sampled_from(ALL_AXES), min_size=1, unique=True).map(tuple)),
    rearm=st.booleans(),
    period=st.sampled_from([None, 0.001]),
)
def test_against_the_definition(record, trigger, samples, levels, ratio, axes, rearm, period):
    common = {"trigger": trigger, "threshold": 43.0, "samples": samples, "levels": levels, "rearm": rearm}
    steps, *force = zip(*record, strict=True) if record else ((), (), (), ())
    times = [0.001 * round(1000 * t) for t in np.cumsum(steps)]
    if axes == "any":
        with np.errstate(invalid="ignore"):
            along = [np.fmax.reduce(np.abs(np.array(force)), axis=0, initial=0.0).tolist()]
    else:
        along = [[float(axis[0] + "1") * f for f in force["xyz".index(axis[1])]] for axis in axes]
    expected = [naive(times, f, ratio=ratio, period=period, **common) for f in along]
    first = min((k for k in expected if k is not None), default=None)

    detector = MultiLevelWindow(**common, ratio=ratio[0] / ratio[1], axes=axes, period=period)
    answers = [k for k, (t, *f) in enumerate(zip(times, *force, strict=True)) if detector.step(t, *f)]
    assert answers == ([] if first is None else [first])


@settings(derandomize=True, deadline=None, max_examples=100)
@given(
    force=st.lists(st.sampled_from([50.0, 44.0, 0.0, -50.0]), max_size=80),
    scale=st.sampled_from([2.0**-10, 0.5, 4.0]),
    shift=st.sampled_from([-8.0, 0.5, 64.0]),
)
def test_units_and_origin_of_time_do_not_matter(force, scale, shift):
    """Exact: the factors are powers of two."""
    period = 2.0**-10
    plain, other = make(samples=3), make(samples=3, trigger=45.0 * scale, threshold=45.0 * scale)
    first = [plain.step(k * period, f, 0.0, 0.0) for k, f in enumerate(force)]
    assert first == [other.step(shift + k * period, f * scale, 0.0, 0.0) for k, f in enumerate(force)]


@pytest.mark.parametrize(
    "changes",
    [
        {"trigger": 44.9},
        {"trigger": NAN},
        {"threshold": NAN},
        {"samples": 0},
        {"levels": 0},
        {"ratio": 0.0},
        {"ratio": 1.01},
        {"ratio": NAN},
        {"axes": ()},
        {"axes": ("x",)},
        {"axes": ("+x", "+x")},
        {"axes": "all"},
        {"period": 0.0},
        {"period": NAN},
    ],
)
def test_settings_out_of_bounds_are_refused(changes):
    with pytest.raises(ValueError, match="must"):
        make(**changes)


@pytest.mark.parametrize(("rate", "samples"), [(1000.0, 18), (3200.0, 58), (104.0, 2), (50.0, 1), (20.0, 1)])
def test_multi_level_window_keeps_its_window_in_time(rate, samples):
    chosen = DetectorSettings(kind="multi-level-window")
    assert recognised(launch.build(chosen, rate), [46.0] * 100, period=1.0 / rate) == [samples - 1]
    assert recognised(launch.build(chosen, rate), [45.1] * 100, period=1.0 / rate) == []


def test_default_at_the_centrifuge():
    """The published centrifuge: 4.1 g must not be recognised, 15.15 g must; 60 s without noise."""
    g = 9.80665
    assert recognised(launch.default(), [4.1 * g] * 60_000) == []
    assert recognised(launch.default(), [0.0] * 1000 + [15.15 * g] * 59_000) == [1009]  # the tenth passes 9 g·ms


def test_default_looks_forward_only():
    detector = launch.default()
    assert not any(detector.step(0.001 * k, -60.0, 60.0, -60.0) for k in range(200))


def test_settings_validate_and_build():
    adapter = pydantic.TypeAdapter(DetectorSettings)
    assert adapter.validate_python({}) == DetectorSettings()
    kind = {"kind": "multi-level-window"}
    read = adapter.validate_python({**kind, "trigger": 50.0, "window": 0.01, "axes": ["-z", "+y"], "rearm": False})
    detector = launch.build(read, 1000.0)
    assert [k for k in range(30) if detector.step(0.001 * k, 0.0, 51.0, 0.0)] == [9]
    assert launch.build(adapter.validate_python({**kind, "axes": "any"}), 100.0).step(0.0, 0.0, 0.0, 0.0) is False
    for wrong in (
        {"ratio": 1.2},
        {"levels": 0},
        {"threshold": -1.0},
        {"axes": ["forward"]},
        {"axes": []},
    ):
        with pytest.raises(pydantic.ValidationError):
            adapter.validate_python(wrong)
    for kind in ("multi-level-window", "double-threshold"):
        with pytest.raises(ValueError, match="trigger must not be below"):
            launch.build(DetectorSettings(kind=kind, trigger=40.0), 1000.0)
    with pytest.raises(ValueError, match="rate"):
        launch.build(DetectorSettings(), 0.0)


def test_settings_tell_their_defaults_once():
    """`default` flies what a scenario without a [detector] section flies."""
    assert {f.name for f in fields(DetectorSettings)} >= {"kind", "threshold", "window", "levels", "ratio"}
    force = ring_curve(200)
    scaled = [80.0 * f for f in force]
    assert recognised(launch.default(), scaled) == recognised(launch.build(DetectorSettings(), 1000.0), scaled) != []


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"samples": 1.5}, "whole numbers"),
        ({"levels": 2.5}, "whole numbers"),
        ({"threshold": math.nan}, "finite"),
        ({"trigger": math.inf}, "finite"),
    ],
)
def test_settings_that_are_no_counts_or_no_numbers_are_refused(wrong, says):
    right = {"trigger": 45.0, "threshold": 45.0, "samples": 10, "levels": 4, "ratio": 0.8}
    with pytest.raises(ValueError, match=says):
        launch.MultiLevelWindow(**{**right, **wrong})


@pytest.mark.parametrize("kind", launch.KINDS)
def test_what_is_tuned_beside_the_level_is_a_setting_and_some_values_for_it(kind):
    settings = DetectorSettings(kind=kind)
    second = launch.KINDS[kind].second_of(settings)
    if second is not None:
        group, _, key = second.key.rpartition(".")
        assert hasattr(getattr(settings, group) if group else settings, key)
        assert len(second.values) > 1
        assert all(isinstance(value, (int, float)) for value in second.values)
