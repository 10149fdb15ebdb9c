"""Loops compiled to machine code by numba; plain Python, a hundred times slower, where its JIT is off.

Without the JIT (NUMBA_DISABLE_JIT) the kernels are handed lists of Python's own numbers, with which they run three
times as fast as with arrays. Where machine code is kept is in `uavsim.studies.machine_code`.
"""

from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from typing import Any, TypeVar, cast

import numpy as np
from numba import config, njit

from uavsim.studies.machine_code import Kept

F = TypeVar("F", bound=Callable[..., Any])

JIT = not cast(Any, config).DISABLE_JIT


def compiled(function: F) -> F:
    """Compile at the first call, and keep the machine code where that is safe; the function itself without a JIT.

    Division by zero is not looked for: the only divisors are the rate and times above 0.
    """
    if not JIT:
        return function
    made: Any = njit(nogil=True, error_model="numpy")(function)
    with suppress(RuntimeError, OSError, AttributeError, TypeError):  # nowhere to keep it, or another numba's insides
        made._cache = Kept(function)
    return cast(F, made)


def _as_float(value: float) -> float:
    return np.float64(value)


wide: Callable[[float], float] = cast(Any, compiled(_as_float)) if JIT else float
"""A number of a record, in double precision."""


def on_plain_numbers(kernel: Callable[..., int]) -> Callable[..., int]:
    """Hand a kernel of `uavsim.studies.kernels` lists where arrays serve: without a JIT that is three times as fast."""

    @wraps(kernel)
    def call(f: Any, k0: int, rate: float, p: Any, q: Any, x: Any, y: Any, out: Any) -> int:
        state = x.tolist()
        alarms = kernel(_Row(f) if f.ndim == 1 else f, k0, rate, p, q, state, y, out)
        x[:] = state
        return alarms

    return call


class _Row(list[float]):
    """Forces as plain numbers, with the array's `size`."""

    def __init__(self, array: Any) -> None:
        super().__init__(array.tolist())
        self.size = len(self)
