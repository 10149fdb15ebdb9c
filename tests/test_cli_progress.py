"""Progress of many flights: a bar on a terminal, a line now and then elsewhere."""

import io
import re
import sys

import pytest

from uavsim.cli.progress import EVERY, FlightsBar, counted, duration


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self) -> bool:
        return True


class Clock:
    """Seconds that a test sets."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_a_log_gets_a_line_now_and_then(capsys: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    with FlightsBar("flying gusty", clock=clock) as bar:
        for done in range(0, 1001, 10):
            clock.now = done / 2.0
            bar.flew(done, 1000, {"cruise": done - done // 100, "crashed": done // 100})
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1000 / 2.0 // EVERY
    assert lines[0] == "flying gusty: 60/1000 · 2 flights/s · 8 min left · cruise 60, crashed 0"
    assert lines[-1].startswith("flying gusty: 960/1000 · 2 flights/s · 20 s left · cruise 951, crashed 9")


def test_a_terminal_gets_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    screen, clock = Screen(), Clock()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr("uavsim.cli.common.PATIENCE", -1.0)
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("TERM", "xterm")
    with FlightsBar("flying [red]\x1b[31mgusty", clock=clock) as bar:
        bar.flew(0, 1000, {})
        clock.now = 40.0
        bar.flew(412, 1000, {"cruise": 408, "crashed": 4})
    shown = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", screen.getvalue())
    assert "flying [red]\\x1b[31mgusty" in shown
    assert "412/1000 · 10.3 flights/s · 57 s left · cruise 408, crashed 4" in shown


def test_the_rate_is_that_of_the_last_minute_and_a_resume_does_not_count() -> None:
    clock = Clock()
    bar = FlightsBar("flying", clock=clock)
    bar.flew(500, 1000, {})  # flown before
    clock.now = 10.0
    assert "1 flights/s" in bar.told(510, 1000, {})
    for second in range(11, 200):
        clock.now = float(second)
        words = bar.told(510 + (second - 10) // 10, 1000, {})
    assert re.search(r" (5\.9|6) flights/min · ", words)


def test_nothing_done_says_no_time() -> None:
    bar = FlightsBar("flying", clock=Clock())
    assert bar.told(0, 10, {}) == "0/10"


def test_outcomes_are_told_the_most_frequent_first() -> None:
    many = {"crashed": 4, "cruise": 408, "landed": 4, "diverged": 1, "timeout": 2, "failed": 1}
    assert counted(many) == "cruise 408, crashed 4, landed 4, timeout 2, others 2"
    assert counted({}) == ""


@pytest.mark.parametrize(
    ("seconds", "words"), [(4.4, "4 s"), (89.0, "89 s"), (300.0, "5 min"), (12_000.0, "3 h 20 min"), (4e5, "5 days")]
)
def test_times_are_as_people_say_them(seconds: float, words: str) -> None:
    assert duration(seconds) == words
