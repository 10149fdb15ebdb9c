"""Progress of many flights: how fast they fly, how long the rest takes, how those that ended have ended.

On a terminal it is a bar; anywhere else, as in the log of a build, a plain line now and then, so that somebody who
reads it later or waits for it sees that something happens.
"""

import sys
from collections.abc import Callable, Mapping
from time import monotonic
from typing import TYPE_CHECKING

from uavsim.cli.common import Bar
from uavsim.views.text import message

if TYPE_CHECKING:
    from rich.progress import Progress

EVERY = 30.0  # s between lines where nobody watches a terminal
RECENT = 60.0  # s over which the rate is taken: workers that have just begun, or were lost, show soon
OUTCOMES = 4  # that are told apart; the others are counted together


class FlightsBar(Bar):
    """Progress on standard error.

    Parameters
    ----------
    what
        What is flown, as "flying gusty".
    clock
        Seconds, for tests.
    """

    def __init__(self, what: str, *, clock: Callable[[], float] = monotonic) -> None:
        super().__init__(what)
        self._clock = clock
        self._past: list[tuple[float, int]] = []  # times, s, and how many were done
        self._line = clock()  # when the last line was written

    def __enter__(self) -> "FlightsBar":
        return self

    def flew(self, done: int, total: int, outcomes: Mapping[str, int]) -> None:
        """Show how far it is.

        Parameters
        ----------
        done, total
            Flights; `done` counts those of a resumed campaign, too.
        outcomes
            How many of each, of those that are done.
        """
        now, words = self._clock(), self.told(done, total, outcomes)
        self.show(done / total if total else 1.0, words)
        if self._progress is None and not watched() and now - self._line >= EVERY and sys.stderr is not None:
            self._line = now
            print(message(f"{self._what}: {words}"), file=sys.stderr, flush=True)  # noqa: T201

    def show(self, share: float, words: str = "") -> None:
        """Show that `share`, 0 … 1, is done, and some words beside it."""
        super().show(share)
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], words=words)

    def told(self, done: int, total: int, outcomes: Mapping[str, int]) -> str:
        """Note how far it is and return it in words."""
        now = self._clock()
        self._past.append((now, done))
        while len(self._past) > 2 and self._past[1][0] < now - RECENT:
            del self._past[0]
        parts = [f"{done}/{total}"]
        rate = self._rate()
        if rate > 0.0:
            parts.append(f"{rate:.3g} flights/s" if rate >= 0.1 else f"{60.0 * rate:.2g} flights/min")
            if done < total:
                parts.append(f"{duration((total - done) / rate)} left")
        if outcomes:
            parts.append(counted(outcomes))
        return " · ".join(parts)

    def _rate(self) -> float:
        """Flights a second over the last minute."""
        (since, before), (now, done) = self._past[0], self._past[-1]
        return (done - before) / (now - since) if now > since else 0.0

    def _start(self) -> "Progress":
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        what = TextColumn("{task.description}", markup=False)
        told = TextColumn("{task.fields[words]}", markup=False)
        progress = Progress(what, BarColumn(bar_width=16), told, console=Console(stderr=True), transient=True)
        progress.add_task(message(self._what, 30), total=1.0, words="")
        progress.start()
        return progress


def watched() -> bool:
    """Whether standard error is a terminal."""
    return sys.stderr is not None and sys.stderr.isatty()


def counted(outcomes: Mapping[str, int]) -> str:
    """Return outcomes in words, the most frequent first: "cruise 408, crashed 4"."""
    ordered = sorted(outcomes.items(), key=lambda item: (-item[1], item[0]))
    told = [f"{name} {count}" for name, count in ordered[:OUTCOMES]]
    rest = sum(count for _, count in ordered[OUTCOMES:])
    return ", ".join([*told, f"others {rest}"] if rest else told)


def duration(seconds: float) -> str:
    """Return a time as people say it: "40 s", "5 min", "3 h 20 min", "4 days".

    Examples
    --------
    >>> duration(12_000)
    '3 h 20 min'
    """
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    if minutes < 90:
        return f"{minutes} min"
    hours, minutes = divmod(minutes, 60)
    if hours < 48:
        return f"{hours} h {minutes} min"
    return f"{round(hours / 24)} days"
