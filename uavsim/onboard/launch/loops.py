"""Detectors' loops over arrays, whoever runs them: over many made records, or over a long log.

A kind that has no loop is stepped, at the times k / rate as a loop has them.
"""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.interface import Detector
from uavsim.onboard.launch.compiled import Forces, Loop
from uavsim.onboard.plausible import MOST_FORCE

Indices = NDArray[np.int64]


def row_of(force: Forces, name: str) -> Forces:
    """Return what a loop reads of forces of the shape (n, 3): a signed axis, or the largest plausible magnitude."""
    if name == "any":
        size = np.abs(force)
        return cast(Forces, np.where(size < MOST_FORCE, size, 0.0).max(axis=1))  # NaN is not below either
    column = force[:, "xyz".index(name[1])]
    return column if name[0] == "+" else -column


def loop_of(detector: Any) -> tuple[Loop, Callable[..., int]]:
    """Return a detector's loop and what runs it; numba is loaded here, if there is a loop."""
    if not hasattr(detector, "loop"):
        run = stepped(detector)
        return Loop(run, (), rows=("+x", "+y", "+z")), run
    found: Loop = detector.loop()
    return found, found.function()


def stepped(detector: Detector) -> Callable[..., int]:
    """Return what steps a detector through arrays; its state is its own, the sample at which it begins resets it."""

    def run(f: Forces, k0: int, rate: float, _p: object, _q: object, _x: object, y: Indices, out: Indices) -> int:
        if k0 == y[0]:
            detector.reset()
        alarms = 0
        for k, (fx, fy, fz) in enumerate(f.T.tolist(), k0):
            if detector.step(k / rate, fx, fy, fz):
                detector.reset()
                out[alarms] = k
                alarms += 1
                if alarms == out.size:
                    break
        return alarms

    return run
