"""Ctrl-C and its kin: counted where something must become whole, KeyboardInterrupt elsewhere."""

import os
import signal
from collections.abc import Iterator

import pytest

from uavsim.interrupts import SIGNALS, Interrupts, like_ctrl_c

if os.name != "posix":
    pytest.skip("signals", allow_module_level=True)


@pytest.fixture(autouse=True)
def as_at_start() -> Iterator[None]:
    """Handlers as Python has them at its start in a terminal, and those of the test's process afterwards."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_all_are_like_ctrl_c_inside_and_as_before_outside(number: int) -> None:
    before = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt), like_ctrl_c():
        signal.raise_signal(number)
    assert signal.getsignal(number) is before


def test_what_is_ignored_or_handled_stays_so() -> None:
    """A job in the background, `nohup`, a program of somebody's own."""
    heard: list[int] = []
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda number, _: heard.append(number))
    with like_ctrl_c(), Interrupts() as seen:
        for number in SIGNALS:
            signal.raise_signal(number)
    assert (heard, seen.count) == ([signal.SIGTERM], 0)


def test_interrupts_come_when_all_is_whole() -> None:
    whole: list[int] = []

    def write() -> None:
        with Interrupts() as seen:
            for number in SIGNALS:
                signal.raise_signal(number)
                with Interrupts():  # one inside changes nothing
                    whole.append(number)
            assert seen.count == len(SIGNALS)

    with pytest.raises(KeyboardInterrupt), like_ctrl_c():
        write()
    assert whole == list(SIGNALS)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_what_goes_wrong_inside_is_told_rather_than_the_interrupt() -> None:
    def fail() -> None:
        with Interrupts():
            signal.raise_signal(signal.SIGINT)
            raise OSError("full")

    with pytest.raises(OSError, match="full"):
        fail()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
