"""Loops that are compiled to machine code by numba when they are first called.

What a compiled function calls of its module's names must be `compiled`, too. It adds and multiplies in the order that
is written: no fused or reordered arithmetic. Without the JIT (NUMBA_DISABLE_JIT) it runs as plain Python. Where machine
code is kept is in `uavsim.machine_code`. numba is imported with the first call and not before.
"""

from collections.abc import Callable, Iterator
from functools import cached_property, update_wrapper
from hashlib import sha256
from types import CodeType, FunctionType
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

P = ParamSpec("P")
R = TypeVar("R")


def jit() -> bool:
    """Whether numba compiles at all here."""
    from numba import config

    return not config.DISABLE_JIT  # type: ignore[attr-defined]  # numba reads it from the environment


class Compiled(Generic[P, R]):
    """A function that is compiled when it is first called.

    Parameters
    ----------
    function : callable
    plain : callable, optional
        What stands for it without a JIT, if that is another.
    """

    def __init__(self, function: Callable[P, R], plain: Callable[P, R] | None = None) -> None:
        assert isinstance(function, FunctionType)
        self.function, self._plain = function, plain
        update_wrapper(self, function)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Call the machine code."""
        found: R = self.code(*args, **kwargs)
        return found

    @cached_property
    def code(self) -> Any:
        """The machine code; without a JIT plain Python."""
        if not jit():
            return self._plain or self._alone()
        from uavsim.machine_code import compile_function

        return compile_function(self._alone(), self.digest)

    @cached_property
    def digest(self) -> str:
        """Of the function and of all that it takes from its module: numbers, arrays, other compiled functions."""
        found = sha256()
        for part in _parts(self.function.__code__):
            found.update(part)
        for name, value in sorted(self._names().items()):
            found.update(name.encode())
            if isinstance(value, Compiled):
                found.update(value.digest.encode())
            elif isinstance(value, np.ndarray):
                found.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
            else:  # a number or text; a function or a module of others goes by its name
                found.update(repr(getattr(value, "__name__", value)).encode())
        return found.hexdigest()

    def _names(self) -> dict[str, Any]:
        """What the function uses of its module, by name."""
        f = self.function
        return {name: f.__globals__[name] for name in f.__code__.co_names if name in f.__globals__}

    def _alone(self) -> FunctionType:
        """Return the same function with just the names that it uses; those of compiled ones mean their code."""
        f = self.function
        scope = {name: value.code if isinstance(value, Compiled) else value for name, value in self._names().items()}
        scope |= {"__name__": f.__module__, "__builtins__": f.__globals__["__builtins__"]}
        same = FunctionType(f.__code__, scope, f.__name__, f.__defaults__, f.__closure__)
        same.__module__, same.__qualname__, same.__doc__ = f.__module__, f.__qualname__, f.__doc__
        return same


def _parts(code: CodeType) -> Iterator[bytes]:
    """What a function's code says, wherever it stands."""
    yield code.co_code
    yield repr((code.co_names, code.co_varnames)).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _parts(constant)
        else:
            yield repr(constant).encode()


def compiled(function: Callable[P, R]) -> Compiled[P, R]:
    """Compile at the first call, and keep the machine code where that is safe.

    Division by zero is not looked for: the only divisors are the rate and times above 0.
    """
    return Compiled(function)


def _wide(value: float) -> float:
    return np.float64(value)


def _same(value: float) -> float:
    return value


wide = Compiled(_wide, plain=_same)
"""Return a number of a record in double precision."""
