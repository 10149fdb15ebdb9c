"""The paper's tables and figures beside ours, each by one study with its `entries`."""

from collections.abc import Callable
from dataclasses import dataclass

from uavsim.studies.paper import centrifuge, complexity, recognition
from uavsim.studies.paper.centrifuge import CentrifugeStudy
from uavsim.studies.paper.complexity import ComplexityStudy
from uavsim.studies.paper.entry import Entry
from uavsim.studies.paper.recognition import RecognitionStudy

__all__ = ["NOT_REPRODUCED", "Entry", "Reproduction", "reproduce"]

NOT_REPRODUCED = {
    "Tables 5, 7 and 8, figures 19 to 21": "the airspeed; it is no part of this version's command",
    "Tables 4 and 6, figures 10 to 14": "flow computations: geometry, mesh and boundary conditions are not given",
    "Figures 1 to 6, 15, 16 and 18": "diagrams and photographs, without data",
}
"""What of the paper is not here, and why."""


@dataclass(frozen=True)
class Reproduction:
    """What was reproduced."""

    recognition: RecognitionStudy
    complexity: ComplexityStudy
    centrifuge: CentrifugeStudy

    @property
    def entries(self) -> dict[str, Entry]:
        """Tables by their names, in the paper's order."""
        return {**self.recognition.entries(), **self.complexity.entries(), **self.centrifuge.entries()}

    @property
    def as_documented(self) -> bool:
        """Whether everything agrees or differs as it should."""
        return all(entry.as_documented for entry in self.entries.values())


def reproduce(progress: Callable[[float], None] = lambda _: None) -> Reproduction:
    """Compute all of it, in well below three minutes.

    Parameters
    ----------
    progress
        Called now and then with the share that is done, 0 … 1.
    """

    def part(first: float, last: float) -> Callable[[float], None]:
        return lambda share: progress(first + share * (last - first))

    return Reproduction(
        recognition=recognition.study(part(0.0, 0.4)),
        complexity=complexity.study(part(0.4, 0.6)),
        centrifuge=centrifuge.study(part(0.6, 1.0)),
    )
