"""Launch detectors that are not ours: their answer is True or False; anything else ends the flight with a reason."""

from math import nan
from typing import Any

from uavsim.failure import PartError, blamed, shown
from uavsim.onboard.interface import Detector

STATE = ("level", "count", "total", "triggered")
"""Attributes of a detector that are recorded, where it has them."""


class GuardedDetector:
    """A launch detector of somebody else's.

    Parameters
    ----------
    name : str
        As registered.
    detector : Detector
    """

    __slots__ = ("_detector", "_part", "_t")

    def __init__(self, name: str, detector: Detector) -> None:
        self._part, self._detector, self._t = f"detector {name!r}", detector, nan

    def __getattr__(self, name: str) -> Any:
        """Return what it has of the state that is recorded, as a number or None."""
        if name == "loop":
            return self._detector.loop  # type: ignore[attr-defined]  # if it has one
        if name not in STATE:
            raise AttributeError(name)
        with blamed(f"{self._part}, attribute {name!r},", self._t):
            value = getattr(self._detector, name, None)
            return value if value is None else bool(value) if name == "triggered" else float(value)

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; see `Detector`."""
        self._t = t
        with blamed(self._part, self._t):
            answer: Any = self._detector.step(t, fx, fy, fz)
        if isinstance(answer, bool):
            return answer
        if type(answer).__name__ not in ("bool", "bool_", "int") or answer not in (0, 1):  # numpy's are two
            raise PartError(f"{self._part} answered {shown(answer)} at {t:.4f} s; it must be True or False")
        return bool(answer)

    def reset(self) -> None:
        """Forget everything; see `Detector`."""
        with blamed(self._part, self._t):
            self._detector.reset()
