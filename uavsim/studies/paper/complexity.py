"""Table 3 and figure 9: what a sample costs, against the number of samples in the window.

Printed are O(log n), O(n) and O(n²) for the three methods. All three do a bounded number of operations a sample with a
counter (and the sliding window with a ring of bits): O(1) a sample, O(n) for n samples. What grows is the recount of
the whole window at each sample, O(n) a sample and O(n²) for n samples; that is measured beside them.

The class comes from the slope s of log cost over log n, fitted from n = 100 on: O(1) for s < 0.25, O(n) for
0.75 < s < 1.25, O(n²) for 1.75 < s < 2.25. Times are the least of several runs, µs.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log
from time import perf_counter
from typing import Protocol

import numpy as np

from sensors import Streams
from uavsim.onboard.launch import MultiLevelWindow, SlidingWindow, ThresholdWindow
from uavsim.studies.paper.entry import Entry

Progress = Callable[[float], None]

SIZES = (10, 30, 100, 300, 1000)  # samples in a window
FITTED = 100  # samples, from which on the slope is fitted
FED = 6000  # samples a run
REPEATS = 5
RATE = 1000.0  # Hz
CLASSES = ((0.0, "O(1)"), (1.0, "O(n)"), (2.0, "O(n^2)"))
MARGIN = 0.25
NAMES = {
    "algorithm1": "multi-level time window",
    "algorithm2": "threshold + time window",
    "algorithm3": "threshold + sliding time window",
    "recount": "sliding window, recounted at each sample",
}


class Stepped(Protocol):
    """What is timed."""

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample."""


class Recount:
    """A sliding window as it is written down without a thought: all of it is counted again at each sample."""

    def __init__(self, threshold: float, samples: int, ratio: float) -> None:
        self._window: deque[float] = deque(maxlen=samples)
        self._threshold = threshold
        self._needed = ratio * samples

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample."""
        self._window.append(fx)
        return sum([x > self._threshold for x in self._window]) >= self._needed


@dataclass(frozen=True)
class ComplexityStudy:
    """Cost of a sample, µs, for each method and each of `SIZES`, and the slope of its logarithm over that of n."""

    cost: Mapping[str, Sequence[float]]
    slopes: Mapping[str, float]

    def entries(self) -> dict[str, Entry]:
        """Table 3."""
        found = {name: class_of(slope) for name, slope in self.slopes.items()}
        return {
            "table3": Entry(
                title="Complexity of the three methods",
                paper={"algorithm1": "O(log n)", "algorithm2": "O(n)", "algorithm3": "O(n^2)"},
                ours={name: found[name] for name in ("algorithm1", "algorithm2", "algorithm3")},
                documented=False,
                note="Wrong in the paper: each method is O(1) a sample with a running count, whatever its window. Only "
                f"a recount of the whole window grows ({found['recount']} a sample). An exponential growth, as the "
                "text has it, is none of the printed classes.",
                details={"per": "sample", "recount": found["recount"]},
            )
        }


def class_of(slope: float) -> str:
    """Class by the slope of log cost over log n; what lies between two classes is named by its power."""
    return next((name for middle, name in CLASSES if abs(slope - middle) < MARGIN), f"O(n^{slope:.1f})")


def methods(samples: int) -> dict[str, Stepped]:
    """The three as they fly, on windows of so many samples, and the recount."""
    level, window = 0.0, samples / RATE
    return {
        "algorithm1": MultiLevelWindow(trigger=level, threshold=level, samples=samples, levels=4, ratio=1.0),
        "algorithm2": ThresholdWindow(RATE, threshold=level, window=window, ratio=1.0),
        "algorithm3": SlidingWindow(RATE, threshold=level, window=window, ratio=1.0),
        "recount": Recount(level, samples, 1.0),
    }


def study(progress: Progress) -> ComplexityStudy:
    """Measure."""
    values = Streams(1, 0)("paper.complexity").standard_normal(FED).tolist()  # half above: windows are always open
    best: dict[str, list[float]] = {name: [np.inf] * len(SIZES) for name in NAMES}
    for repeat in range(REPEATS):
        for i, samples in enumerate(SIZES):
            for name, method in methods(samples).items():
                best[name][i] = min(best[name][i], _time(method, values))
        progress((repeat + 1) / REPEATS)
    return ComplexityStudy(best, {name: slope_of(SIZES, cost) for name, cost in best.items()})


def _time(method: Stepped, values: Sequence[float]) -> float:
    """Cost of a sample, µs."""
    step = method.step
    begun = perf_counter()
    for k, x in enumerate(values):
        step(k / RATE, x, 0.0, 0.0)
    return 1e6 * (perf_counter() - begun) / len(values)


def slope_of(sizes: Sequence[int], cost: Sequence[float]) -> float:
    """Slope of log cost over log n from `FITTED` samples on, least squares."""
    pairs = [(log(n), log(c)) for n, c in zip(sizes, cost, strict=True) if n >= FITTED]
    x, y = (np.array(column) for column in zip(*pairs, strict=True))
    return float(np.polyfit(x, y, 1)[0])
