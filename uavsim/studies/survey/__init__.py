"""Where to mount an air-data head: surface pressures of an aircraft over the envelope that its flights visit.

`survey` joins the rooms: the outline (`geometry`), the flow about fuselage and sections (`body`, `section`,
`lifting_line`, `edge`, `compressible`, `flow`), candidate `places`, the `envelope` of flights, the `ranking` by
airspeed error, and the published method's own case (`paper_case`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from uavsim.airdata.surfaces import Polynomial
from uavsim.studies.survey.edge import Source, choose_source, disagreement
from uavsim.studies.survey.envelope import Envelope, envelope_of, fly_envelope, load_envelope, model_of
from uavsim.studies.survey.flow import MACHS, AircraftFlow, reynolds
from uavsim.studies.survey.geometry import Outline, read_outline
from uavsim.studies.survey.paper_case import paper_case
from uavsim.studies.survey.places import CHORDS, Place, places
from uavsim.studies.survey.ranking import Rank, box, choose, probe_polynomial, ranked

__all__ = [
    "Envelope", "Survey", "box", "check_envelope", "choose", "choose_source", "envelope_of", "fly_envelope",
    "load_envelope", "model_of", "read_outline", "survey",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Survey:
    """Where to mount a head on an aircraft.

    Attributes
    ----------
    outline : Outline
    source : str
        What gave the speed along sections, "neuralfoil" or "panels".
    flow : AircraftFlow
    places : list of Place
    envelope : Envelope
    total, static : list of Rank
        All places that can serve as either, the best first.
    polynomial : Polynomial
        Position error of the static place that is named, as the probe model reads it.
    polynomial_error : float
        Largest difference of polynomial and flow within the envelope's box, share of q_c.
    paper : dict
        The published case on this aircraft.
    cross_check : dict or None
        Largest difference of NeuralFoil's edge speed and ours over the envelope's angles, a place on the wing.
    """

    outline: Outline
    source: str
    flow: AircraftFlow
    places: list[Place]
    envelope: Envelope
    total: list[Rank]
    static: list[Rank]
    polynomial: Polynomial
    polynomial_error: float
    paper: dict[str, Any]
    cross_check: dict[float, float] | None


def check_envelope(envelope: Envelope) -> None:
    """Refuse flights faster than the rules for compressibility hold; ValueError."""
    fastest = envelope.range("mach")[1]
    if fastest > MACHS[-1]:
        raise ValueError(f"the flights reach Mach {fastest:.2f}; the survey ends at {MACHS[-1]}")


def survey(
    outline: Outline,
    envelope: Envelope,
    source: Source = "auto",
    *,
    progress: Callable[[float], None] | None = None,
) -> Survey:
    """Survey an aircraft.

    Parameters
    ----------
    outline : Outline
        As `read_outline` gives it.
    envelope : Envelope
        Where its flights have been.
    source : {"auto", "neuralfoil", "panels"}
        What gives the speed along sections; auto takes NeuralFoil if it is installed.
    progress : function, optional
        Called with the share that is done, 0 … 1.

    Raises
    ------
    ValueError
        NeuralFoil is asked for and not installed, or the envelope is faster than the rules for compressibility hold.
    """
    tell = progress or (lambda share: None)
    chosen = choose_source(source)
    check_envelope(envelope)
    flow = AircraftFlow(outline, chosen, envelope.range("mach")[1], envelope.mean_speed)
    candidates = places(flow)
    tell(0.4)
    total, static = (ranked(candidates, role, envelope) for role in ("total", "static"))
    polynomial, error = probe_polynomial(choose(static).place, envelope)
    tell(0.6)
    paper = paper_case(outline, chosen)
    cross_check = _cross_check(outline, envelope) if chosen == "neuralfoil" else None
    tell(1.0)
    return Survey(outline, chosen, flow, candidates, envelope, total, static, polynomial, error, paper, cross_check)


def _cross_check(outline: Outline, envelope: Envelope) -> dict[float, float]:
    sides = tuple(side * chord for side in (1.0, -1.0) for chord in CHORDS)
    return disagreement(
        outline.wing.airfoil, sides, reynolds(envelope.mean_speed, outline.wing.root_chord), box(envelope)[0]
    )
