"""One table of the paper beside ours: what is printed there, what comes out here, and whether that is the same."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Entry:
    """A table.

    Attributes
    ----------
    title
        What it is about.
    paper, ours
        Alike in shape: what is printed, what was computed.
    note
        What is behind an agreement or a difference.
    tolerance
        Most that two numbers may differ; None where nothing may.
    documented
        Whether they are expected to agree: what is wrong in the paper does not become right here.
    details
        What else was computed: probabilities, measurements.
    """

    title: str
    paper: Mapping[str, Any]
    ours: Mapping[str, Any]
    note: str
    tolerance: float | None = None
    documented: bool = True
    details: Mapping[str, Any] = field(default_factory=dict)

    @property
    def agrees(self) -> bool:
        """Whether ours is what is printed."""
        return agree(self.paper, self.ours, self.tolerance)

    @property
    def as_documented(self) -> bool:
        """Whether it agrees or differs as it should."""
        return self.agrees == self.documented

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "title": self.title,
            "paper": self.paper,
            "ours": self.ours,
            "agrees": self.agrees,
            "tolerance": self.tolerance,
            "documented": self.documented,
            "note": self.note,
            "details": self.details,
        }


def agree(paper: Any, ours: Any, tolerance: float | None) -> bool:
    """Compare nested values: the same keys, numbers within the tolerance, everything else equal."""
    if isinstance(paper, Mapping):
        return (
            isinstance(ours, Mapping)
            and paper.keys() == ours.keys()
            and all(agree(value, ours[key], tolerance) for key, value in paper.items())
        )
    if isinstance(paper, list | tuple):
        return (
            isinstance(ours, list | tuple)
            and len(paper) == len(ours)
            and all(agree(a, b, tolerance) for a, b in zip(paper, ours, strict=True))
        )
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (paper, ours))
    if numbers and tolerance is not None:
        return bool(abs(paper - ours) <= tolerance)
    return bool(paper == ours)
