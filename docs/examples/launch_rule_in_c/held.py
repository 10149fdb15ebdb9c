"""A launch rule written in C, as a plug-in through cffi, and the same rule in Python.

    pip install cffi
    cc -O2 -ffp-contract=off -shared -fPIC -o libheld.so held.c
    uavsim fly catapult --plugin held.py --set detector.kind=held-in-c

The library lies beside this file. It is decision for decision the rule in Python: the same operations in the same
order, none of them fused.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Interval

from uavsim.plugins import detector

DECLARATIONS = """
typedef struct { double level, hold, longest, last, since; bool begun, above, done; } held_t;
void held_init(held_t *h, double rate, double level, double hold);
void held_reset(held_t *h);
bool held_step(held_t *h, double t, double fx);
"""


@dataclass(frozen=True)
class Settings:
    """Of both: a level, m/s², and for how long the force is above it, s."""

    level: Annotated[float, Interval(gt=0.0, le=2000.0)] = 45.0
    hold: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.010


@detector("held-in-c", level="f_x over level", unit="m/s²")
class HeldInC:
    """The rule in C."""

    Settings = Settings

    def __init__(self, rate: float, settings: Settings = Settings()) -> None:
        from cffi import FFI

        ffi = FFI()
        ffi.cdef(DECLARATIONS)
        self._library = ffi.dlopen(str(Path(__file__).with_name("libheld.so")))
        self._state = ffi.new("held_t *")
        self._library.held_init(self._state, rate, settings.level, settings.hold)
        self._level = settings.level

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.level = fx - self._level
        return bool(self._library.held_step(self._state, t, fx))

    def reset(self) -> None:
        self._library.held_reset(self._state)


@detector("held-in-python", level="f_x over level", unit="m/s²")
class HeldInPython:
    """The same rule in Python."""

    Settings = Settings

    def __init__(self, rate: float, settings: Settings = Settings()) -> None:
        self.settings, self.longest = settings, 3.5 / rate
        self.reset()

    def reset(self) -> None:
        self.last = self.since = None
        self.done = False

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        self.level = fx - self.settings.level
        if self.last is None or not 0.0 < t - self.last <= self.longest:
            self.since = None
        self.last = t
        if not self.settings.level < fx < 4000.0:
            self.since = None
            return False
        if self.since is None:
            self.since = t
        if self.done or t - self.since < self.settings.hold:
            return False
        self.done = True
        return True
