"""Where to mount an air-data head: surface pressures of an aircraft over the envelope that its flights visit.

`survey` joins the rooms: the outline (`geometry`), the flow about fuselage and sections (`body`, `section`,
`lifting_line`, `edge`, `compressible`, `flow`), candidate `places`, the `envelope` of flights, the `ranking` by
airspeed error, and the published method's own case (`paper_case`).
"""

from dataclasses import dataclass
from typing import Any

from uavsim.airdata.surfaces import Polynomial
from uavsim.studies.survey.edge import Source, choose_source, disagreement
from uavsim.studies.survey.envelope import Envelope
from uavsim.studies.survey.flow import MACHS, AircraftFlow, reynolds
from uavsim.studies.survey.geometry import Outline, read_outline
from uavsim.studies.survey.paper_case import paper_case
from uavsim.studies.survey.places import CHORDS, Place, places
from uavsim.studies.survey.ranking import Rank, box, choose, probe_polynomial, ranked

__all__ = ["Survey", "box", "choose", "read_outline", "survey"]


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


def survey(outline: Outline, envelope: Envelope, source: Source = "auto") -> Survey:
    """Survey an aircraft.

    Parameters
    ----------
    outline : Outline
        As `read_outline` gives it.
    envelope : Envelope
        Where its flights have been.
    source : {"auto", "neuralfoil", "panels"}
        What gives the speed along sections; auto takes NeuralFoil if it is installed.

    Raises
    ------
    ValueError
        NeuralFoil is asked for and not installed, or the envelope is faster than the rules for compressibility hold.
    """
    chosen = choose_source(source)
    fastest = envelope.range("mach")[1]
    if fastest > MACHS[-1]:
        raise ValueError(f"the flights reach Mach {fastest:.2f}; the survey ends at {MACHS[-1]}")
    flow = AircraftFlow(outline, chosen, fastest)
    candidates = places(flow)
    total, static = (ranked(candidates, role, envelope) for role in ("total", "static"))
    polynomial, error = probe_polynomial(choose(static).place, envelope)
    return Survey(
        outline, chosen, flow, candidates, envelope, total, static, polynomial, error,
        paper_case(outline, chosen), _cross_check(outline, envelope) if chosen == "neuralfoil" else None,
    )  # fmt: skip


def _cross_check(outline: Outline, envelope: Envelope) -> dict[float, float]:
    sides = tuple(side * chord for side in (1.0, -1.0) for chord in CHORDS)
    return disagreement(outline.wing.airfoil, sides, reynolds(outline.wing.root_chord), box(envelope)[0])
