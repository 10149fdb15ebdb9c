"""The paper's tables: printed values against ours, the rule of agreement, exact probabilities against drawn noise."""

import numpy as np
import pytest

from uavsim.onboard.launch import SlidingWindow
from uavsim.studies.paper import centrifuge, complexity, recognition
from uavsim.studies.paper.entry import Entry, agree


def nothing(share: float) -> None:
    assert 0.0 <= share <= 1.0


@pytest.fixture(scope="module")
def recognised() -> recognition.RecognitionStudy:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recognition, "TRIALS", 400)
        patch.setattr(recognition, "SIGMAS", (0.01, 0.05))
        return recognition.study(nothing)


# -- agreement -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("paper", "ours", "tolerance", "same"),
    [
        (1.0, 1.019, 0.02, True),
        (1.0, 1.021, 0.02, False),
        (1.0, 1.0 + 1e-12, None, False),
        ({"a": [1, 2]}, {"a": (1, 2)}, None, True),
        ({"a": [1, 2]}, {"a": [1]}, None, False),
        ({"a": 1}, {"a": 1, "b": 2}, None, False),
        ({"a": 1}, 1, None, False),
        ([1], 1, None, False),
        (True, False, 1.0, False),
        ("Yes", "Yes", 0.1, True),
        (1.0, None, 0.1, False),
    ],
)
def test_agreement(paper: object, ours: object, tolerance: float | None, same: bool) -> None:
    assert agree(paper, ours, tolerance) is same


def test_a_difference_may_be_as_documented() -> None:
    entry = Entry("t", {"a": 1}, {"a": 2}, "why", documented=False)
    assert not entry.agrees
    assert entry.as_documented
    assert not Entry("t", {"a": 1}, {"a": 2}, "why").as_documented
    assert entry.to_dict().keys() >= {"paper", "ours", "agrees", "tolerance", "note"}


# -- tables 1 and 2 --------------------------------------------------------------------------------------------------


def test_table_1_is_yes_no_yes(recognised: recognition.RecognitionStudy) -> None:
    assert recognised.plain == {"algorithm1": True, "algorithm2": False, "algorithm3": True}
    assert recognised.rearmed
    assert recognised.entries()["table1"].agrees


def test_table_2_is_7_14_22_32_in_window_4(recognised: recognition.RecognitionStudy) -> None:
    assert recognised.counts == (7, 14, 22, 32)
    assert recognised.window == 4
    assert recognised.entries()["table2"].agrees


def test_another_curve_does_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without its ring the curve is recognised in the first window by each: nothing is hard-coded."""
    monkeypatch.setattr(recognition, "SIGMAS", ())
    t = np.arange(100) / 1000.0
    monkeypatch.setattr(recognition, "curve", lambda: (t, np.minimum(t / 3e-3, 1.0)))
    entries = recognition.study(nothing).entries()
    assert not entries["table1"].agrees
    assert not entries["table2"].agrees


def test_probabilities_are_those_of_the_limits(recognised: recognition.RecognitionStudy) -> None:
    """P(7, 14, 22, 32) and P(No, No, No, Yes), from another implementation's simulation, to its two digits."""
    low, high = recognised.probabilities["0.01"], recognised.probabilities["0.05"]
    assert low["counts"]["exact"] == pytest.approx(0.81, abs=0.01)
    assert low["no_no_no_yes"]["exact"] == pytest.approx(0.99, abs=0.01)
    assert high["counts"]["exact"] == pytest.approx(0.11, abs=0.01)
    assert high["no_no_no_yes"]["exact"] == pytest.approx(0.36, abs=0.01)


def check_bands(study: recognition.RecognitionStudy, most_outside: int) -> None:
    pairs = [v for row in study.probabilities.values() for v in row.values() if v["exact"] is not None]
    assert pairs
    outside = [v for v in pairs if not v["band"][0] <= v["exact"] <= v["band"][1]]
    assert len(outside) <= most_outside


def test_drawn_noise_agrees_with_the_exact_chains(recognised: recognition.RecognitionStudy) -> None:
    """10 comparisons with 95 % bands of 400 draws: more than 2 outside by chance 1 % of the time.

    A probability off by 0.08 near one half is outside in 9 of 10 cases. Fixed seeds.
    """
    check_bands(recognised, 2)


@pytest.mark.slow
def test_drawn_noise_agrees_with_the_exact_chains_as_published() -> None:
    """20 comparisons with 95 % bands of 4000 draws: more than 3 outside by chance 1.6 % of the time; catches 0.025."""
    check_bands(recognition.study(nothing), 3)


def test_the_drawn_curve_counts_its_own_noise(recognised: recognition.RecognitionStudy) -> None:
    drawn = recognised.drawn
    above = drawn.noisy > drawn.threshold
    assert drawn.trigger == int(np.argmax(above))
    assert drawn.counts == tuple(int(above[drawn.trigger :][: 10 * level].sum()) for level in (1, 2, 3, 4))
    assert np.std(drawn.noisy - drawn.force) == pytest.approx(recognition.SHOWN, rel=0.25)  # 3.5 sigma of 100 samples


# -- table 3 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("power", "name"), [(0.0, "O(1)"), (1.0, "O(n)"), (2.0, "O(n^2)"), (1.5, "O(n^1.5)")])
def test_classes_by_the_slope(power: float, name: str) -> None:
    cost = [3.0 * n**power for n in complexity.SIZES]
    assert complexity.slope_of(complexity.SIZES, cost) == pytest.approx(power, abs=1e-9)
    assert complexity.class_of(power) == name


def test_the_recount_decides_as_the_ring_does() -> None:
    values = np.random.default_rng(4).standard_normal(3000) + 0.9
    ring = SlidingWindow(1000.0, threshold=0.0, window=0.030, ratio=0.95)
    recount = complexity.Recount(0.0, 30, 0.95)
    first = [
        next(k for k, x in enumerate(values.tolist()) if detector.step(k / 1000.0, x, 0.0, 0.0))
        for detector in (ring, recount)
    ]
    assert first[0] == first[1] > 30


def test_table_3_differs_as_documented() -> None:
    """Whatever a machine measures: three methods of one class are not the three classes that are printed."""
    cost = {name: [1.0] * len(complexity.SIZES) for name in complexity.NAMES}
    entry = complexity.ComplexityStudy(cost, dict.fromkeys(cost, 0.02)).entries()["table3"]
    assert entry.ours == {"algorithm1": "O(1)", "algorithm2": "O(1)", "algorithm3": "O(1)"}
    assert not entry.agrees
    assert entry.as_documented


def test_every_method_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(complexity, "FED", 200)
    monkeypatch.setattr(complexity, "REPEATS", 1)
    study = complexity.study(nothing)
    assert study.cost.keys() == study.slopes.keys() == complexity.NAMES.keys()
    assert all(len(cost) == len(complexity.SIZES) and min(cost) > 0.0 for cost in study.cost.values())


# -- centrifuge ------------------------------------------------------------------------------------------------------


def test_the_centrifuge_reads_and_recognises_what_is_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(centrifuge, "UNITS", 1)
    study = centrifuge.study(nothing)
    entry = study.entries()["centrifuge"]
    assert entry.agrees
    assert study.drawn == {"4 g": 0, "15 g": 1}
    assert entry.details["error_percent"]["4 g"] == pytest.approx(2.5, abs=0.05)
    assert entry.details["error_percent"]["15 g"] == pytest.approx(1.0, abs=0.05)
