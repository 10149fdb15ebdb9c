"""A rule of a detector as a loop over arrays, compiled to machine code by numba when it is first called.

A kind of detector may have its rule twice in its file: as `step`, which people read and port, and as a loop, which
takes the same decisions at the times k / rate a hundred times as fast. A loop adds and multiplies in the order of
`step`, so sums agree to the last bit: no fused or reordered arithmetic. It takes for every sample

    dt_k = t_k - t_{k-1},   a detector's first sample: 1 / rate

Regular sampling has no gaps; forces that are NaN or implausible have the effect that `step` gives them. At an alarm
the detector begins anew with the next sample. All loops are called alike:

    (f, k₀, rate, p, q, x, y, out) → number of alarms

    f      forces along the launch axis, m/s², (n,), or (rows, n) where a rule needs several, float32 or float64
    k₀     number of the first of them
    p, q   the detector's numbers, real and whole
    x, y   its state, real and whole, kept from block to block; y[0]: number of the first sample since it began
    out    receives the numbers of the samples with an alarm; the loop ends when it is full

What a loop calls of its module's names must be `compiled`, too. Without the JIT (NUMBA_DISABLE_JIT) a loop runs as
plain Python, on lists of Python's own numbers, with which it is three times as fast as on arrays. What compiles and
where machine code is kept is in `uavsim.compiled`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import Compiled, compiled, jit, wide

__all__ = ["Counts", "Forces", "Loop", "Numbers", "Reals", "Wholes", "compiled", "on_plain_numbers", "wide"]

Forces = NDArray[np.float64] | NDArray[np.float32]
Reals = NDArray[np.float64]
Wholes = NDArray[np.int64]
Numbers = tuple[float, ...]
Counts = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Loop:
    """A detector's loop: the compiled rule, its numbers, and its state before the first sample.

    Attributes
    ----------
    rule : callable
        Compiled; called as the module says.
    p, q : tuple or ndarray
        The detector's numbers.
    x, y : tuple
        Its state before the first sample.
    rows : tuple of str
        Signed body axes that it reads; "any": the largest plausible magnitude; empty: those that the detector is set
        to.
    """

    rule: Callable[..., int]
    p: Numbers
    q: Counts | Wholes = (0,)
    x: Numbers = (0.0,)
    y: Counts = (0,)
    rows: tuple[str, ...] = field(default=())

    def function(self) -> Callable[..., int]:
        """Return what runs the rule on arrays."""
        code: Callable[..., int] = self.rule.code if isinstance(self.rule, Compiled) else self.rule
        return code if jit() else on_plain_numbers(code)


def on_plain_numbers(rule: Callable[..., int]) -> Callable[..., int]:
    """Hand a loop lists where arrays serve: without a JIT that is three times as fast."""

    def call(f: Any, k0: int, rate: float, p: Any, q: Any, x: Any, y: Any, out: Any) -> int:
        state = x.tolist()
        alarms = rule(_Row(f) if f.ndim == 1 else f, k0, rate, p, q, state, y, out)
        x[:] = state
        return alarms

    return call


class _Row(list[float]):
    """Forces as plain numbers, with the array's `size`."""

    def __init__(self, array: Any) -> None:
        super().__init__(array.tolist())
        self.size = len(self)
