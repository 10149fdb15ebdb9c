"""How a part that is not ours fails: what it raises, and answers that are none, end the flight with a reason.

Such parts are guarded (`onboard.launch.guarded`, `onboard.airspeed.guarded`, `plants.guarded`). Ours are not: they
return, whatever they read.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

FAILED = "onboard_failed"
"""Outcome of a flight that a part ended so."""


class PartError(Exception):
    """A part has failed; one line: which, when and how."""


def said(error: BaseException) -> str:
    """Return an exception's name and what it says, in one line, whatever it makes of being asked."""
    try:
        text = str(error)
    except Exception:  # noqa: BLE001 (somebody else's class)
        text = "it does not say what"
    return " ".join(f"{type(error).__name__}: {text}".split())[:300]


def raised(part: str, t: float, error: BaseException) -> PartError:
    """Say that a part raised an exception."""
    return PartError(f"{part} raised {said(error)} at {t:.4f} s")


@contextmanager
def blamed(part: str, t: float) -> Iterator[None]:
    """Turn whatever a part raises at a time, s, into its failure, an attempt to end the program too."""
    try:
        yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise raised(part, t, error) from error


@contextmanager
def built(part: str) -> Iterator[None]:
    """Turn what making a part raises into one line; it has not flown yet, so it is the user's to mend."""
    try:
        yield
    except KeyboardInterrupt:
        raise
    except PartError as failure:
        raise ValueError(str(failure)) from failure
    except BaseException as error:
        raise ValueError(f"{part} cannot be made: {said(error)}") from error


def shown(answer: Any) -> str:
    """Return an answer in at most 80 letters."""
    try:
        text = " ".join(repr(answer).split())
    except Exception:  # noqa: BLE001 (somebody else's class)
        text = f"something of {type(answer).__name__}"
    return text if len(text) <= 80 else f"{text[:77]}…"
