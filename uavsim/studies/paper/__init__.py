"""The paper's tables and figures beside ours, each by one study with its `entries`."""

from collections.abc import Callable
from dataclasses import dataclass

from uavsim.studies.paper import air_data, centrifuge, complexity, pipe, recognition, tunnel
from uavsim.studies.paper.air_data import AirDataStudy
from uavsim.studies.paper.centrifuge import CentrifugeStudy
from uavsim.studies.paper.complexity import ComplexityStudy
from uavsim.studies.paper.entry import Entry
from uavsim.studies.paper.pipe import PipeStudy
from uavsim.studies.paper.recognition import RecognitionStudy
from uavsim.studies.paper.tunnel import TunnelStudy

__all__ = ["NOT_REPRODUCED", "Entry", "Reproduction", "reproduce"]

NOT_REPRODUCED = {
    "Table 8": "its errors have no unit, and of which speeds and air they are is not said; as shares of the airspeed "
    "at 25 to 40 m/s they fit the printed noise",
    "Table 4, figures 10 and 11": "the flow round the device's own box, of which three lengths are given; that the "
    "pressure is least in the middle of the surface that faces the stream contradicts stagnation",
    "Table 6, figures 13 and 14": "the flow round an aircraft whose shape is not given; uavsim survey computes where "
    "to mount the head on an aircraft of one's own",
    "Figures 1 to 6, 15, 16 and 18": "diagrams and photographs, without data; what pipes of 5 cm do is computed",
}
"""What of the paper is not here, and why."""


@dataclass(frozen=True)
class Reproduction:
    """What was reproduced."""

    recognition: RecognitionStudy
    complexity: ComplexityStudy
    air_data: AirDataStudy
    tunnel: TunnelStudy
    pipe: PipeStudy
    centrifuge: CentrifugeStudy

    @property
    def entries(self) -> dict[str, Entry]:
        """Tables by their names, in the paper's order."""
        studies = (self.recognition, self.complexity, self.air_data, self.tunnel, self.pipe, self.centrifuge)
        return {name: entry for study in studies for name, entry in study.entries().items()}

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
        recognition=recognition.study(part(0.0, 0.25)),
        complexity=complexity.study(part(0.25, 0.35)),
        air_data=air_data.study(),
        tunnel=tunnel.study(part(0.35, 0.75)),
        pipe=pipe.study(),
        centrifuge=centrifuge.study(part(0.75, 1.0)),
    )
