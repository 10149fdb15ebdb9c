"""Batch evaluation is held against the detectors' own `step`: the same alarms at the same samples, none left out.

The authority is `step` itself at the times k / rate; there is no tolerance.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from uavsim.onboard.launch import KINDS, DetectorSettings, build
from uavsim.studies.detections import BatchDetector, has_loop

Array = NDArray[np.float64]
RATES = (50.0, 833.0, 1000.0, 4000.0)  # Hz


def by_step(chosen: DetectorSettings, rate: float, force: Array) -> list[int]:
    """Every alarm of a detector that begins anew after each."""
    detector, found = build(chosen, rate), []
    for k, (fx, fy, fz) in enumerate(force.tolist()):
        if detector.step(k / rate, fx, fy, fz):
            found.append(k)
            detector.reset()
    return found


def rough(rate: float, n: int, seed: int) -> Array:
    """Loads of all lengths, shocks, noise, NaN, infinite and implausible readings; (n, 3), m/s²."""
    generator = np.random.default_rng(seed)
    force = np.empty((n, 3))
    for axis in range(3):
        at = 0
        while at < n:
            long = max(1, int(rate * generator.choice([0.002, 0.02, 0.2, 1.2]) * generator.random()))
            force[at : at + long, axis] = generator.choice([3.0, 3.0, -30.0, 20.0, 46.0, 55.0, 150.0])
            at += long
    force += generator.choice([0.0, 3.0, 10.0], (n, 1)) * generator.standard_normal((n, 3))
    force[generator.random((n, 3)) < 0.002] = np.nan
    force[generator.random((n, 3)) < 0.0005] = np.inf
    force[generator.random((n, 3)) < 0.0005] = -np.inf
    for size in (3999.9, 4000.0, -4000.0, 1e30):
        force[generator.random((n, 3)) < 0.0005] = size
    at = n // 3
    force[at : at + n // 20] = 5000.0
    return force


def variants(kind: str) -> list[DetectorSettings]:
    """Settings as shipped, and others that a kind reads."""
    plain = DetectorSettings(kind=kind)
    group = KINDS[kind].reads[0]
    if hasattr(getattr(plain, group), "acceleration"):
        own = getattr(plain, group)
        return [
            plain,
            *(
                replace(plain, ardupilot=replace(plain.ardupilot, acceleration=level, count=n))
                for level, n in ((4.0, 2), (4.0, 3), (0.0, 1))
                if kind == "ardupilot"
            ),
            replace(plain, **{group: replace(own, acceleration=40.0)}, axes=("-z",)),
            replace(plain, **{group: replace(own, acceleration=5.0)}, axes=("+y",)),
        ]
    if kind == "cusum":
        return [plain] + [replace(plain, cusum=replace(plain.cusum, limit=h), axes=("-x",)) for h in (0.03, 0.5)]
    if kind == "adaptive-cusum":
        quick = replace(plain.adaptive, limit=0.02, highest=0.1, memory=0.002, mean=0.0005)
        fixed = replace(plain.adaptive, limit=0.05, highest=0.05, gain=1.0, reference=20.0)
        return [plain, replace(plain, adaptive=quick, axes=("-y",)), replace(plain, adaptive=fixed)]
    if kind == "glr-bank":
        short = replace(plain.glr, windows=(0.003, 0.020), limit=0.4)
        return [plain, replace(plain, glr=short, axes=("+z",)), replace(plain, glr=replace(plain.glr, reference=20.0))]
    low = replace(plain, threshold=25.0, window=0.007, ratio=0.6, axes=("-y",))
    found = [plain, low]
    if "trigger" in KINDS[kind].reads:
        found.append(replace(low, trigger=50.0))
    if "rearm" in KINDS[kind].reads:
        found.append(replace(low, rearm=False))
    if kind == "multi-level-window":
        found += [replace(low, axes="any"), replace(low, axes=("+x", "-y", "+z"), levels=2)]
        found.append(replace(low, axes=("+x", "-y"), window=0.010))  # 6 of 10 at 1 kHz: the ratio may be met exactly
    return found


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("kind", KINDS)
def test_alarms_are_those_of_step(kind: str, rate: float) -> None:
    force = rough(rate, 6000, seed=int(rate))
    for chosen in variants(kind):
        assert BatchDetector(chosen, rate).alarms(force).tolist() == by_step(chosen, rate, force)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_raises_alarms_here(kind: str) -> None:
    """Or the comparison above would say nothing."""
    force = rough(1000.0, 6000, seed=1000)
    assert any(BatchDetector(chosen, 1000.0).alarms(force).size > 1 for chosen in variants(kind))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("single", [False, True])
def test_blocks_change_nothing(kind: str, single: bool) -> None:
    force = rough(1000.0, 5000, seed=2)
    if single:
        force = force.astype(np.float32).astype(np.float64)
    for chosen in variants(kind):
        whole, parts = BatchDetector(chosen, 1000.0), BatchDetector(chosen, 1000.0)
        blocks = np.split(force.astype(np.float32) if single else force, [1, 2, 40, 41, 2000, 3333])
        found = np.concatenate([parts.alarms(block) for block in blocks])
        assert found.tolist() == whole.alarms(force).tolist()


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_alarm_of_each_record_is_that_of_step(kind: str) -> None:
    trials = np.stack([rough(1000.0, 2500, seed) for seed in range(3)])
    trials[1] = 0.0
    for chosen in variants(kind):
        expected = [next(iter(by_step(chosen, 1000.0, trial)), -1) for trial in trials]
        batch = BatchDetector(chosen, 1000.0)
        batch.alarms(trials[0])  # what was read before is not remembered
        assert batch.first(trials).tolist() == expected


@settings(max_examples=60, deadline=None)
@given(
    kind=st.sampled_from(list(KINDS)),
    rate=st.floats(40.0, 5000.0),
    seed=st.integers(0, 2**32),
    threshold=st.floats(5.0, 60.0),
    over=st.floats(0.0, 30.0),
    window=st.floats(0.001, 0.05),
    ratio=st.floats(0.1, 1.0),
    levels=st.integers(1, 5),
)
def test_any_settings_agree(
    kind: str, rate: float, seed: int, threshold: float, over: float, window: float, ratio: float, levels: int
) -> None:
    chosen = DetectorSettings(
        kind=kind,
        threshold=threshold,
        trigger=threshold + over,
        window=window,
        ratio=ratio,
        levels=levels,
        sequence=min(window, 0.003),
    )
    chosen = replace(chosen, cusum=replace(chosen.cusum, reference=threshold, limit=10.0 * window, rise=5.0 + over))
    chosen = replace(chosen, adaptive=replace(chosen.adaptive, reference=threshold, limit=window, highest=2.0 * window))
    force = rough(rate, 1500, seed)
    assert BatchDetector(chosen, rate).alarms(force).tolist() == by_step(chosen, rate, force)


def test_the_one_axis_may_come_alone() -> None:
    force = rough(1000.0, 4000, seed=3)
    chosen = DetectorSettings(kind="cusum", axes=("-y",))
    batch = BatchDetector(chosen, 1000.0)
    assert batch.columns == (1,)
    assert batch.alarms(force[:, 1]).tolist() == by_step(chosen, 1000.0, force)


@pytest.mark.parametrize(
    ("axes", "columns"), [(("+x",), (0,)), (("-z", "+y"), (1, 2)), ("any", (0, 1, 2)), (("+x", "-x"), (0,))]
)
def test_columns_are_those_of_the_axes(axes: object, columns: tuple[int, ...]) -> None:
    chosen = DetectorSettings(kind="multi-level-window", axes=axes)  # type: ignore[arg-type]
    assert BatchDetector(chosen, 1000.0).columns == columns


@pytest.mark.parametrize("shape", [(5, 2), (5, 3, 1)])
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="shape"):
        BatchDetector(DetectorSettings(), 1000.0).alarms(np.zeros(shape))


def test_one_axis_is_not_enough_for_three() -> None:
    with pytest.raises(ValueError, match="shape"):
        BatchDetector(DetectorSettings(kind="px4-norm"), 1000.0).alarms(np.zeros(5))


def test_every_kind_has_a_kernel() -> None:
    assert all(has_loop(DetectorSettings(kind=kind), 1000.0) for kind in KINDS)


def test_without_a_place_for_machine_code_it_is_compiled_all_the_same() -> None:
    """A function without a file has none, as one in an installation that nobody may write to."""
    from uavsim.compiled import compiled

    names: dict[str, object] = {}
    exec("def double(x):\n    return 2 * x", names)
    assert compiled(names["double"])(21) == 42  # type: ignore[type-var, operator]
