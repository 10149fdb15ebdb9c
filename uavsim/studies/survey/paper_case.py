"""The published method's own survey, its Figures 13 and 14, on this aircraft: Mach 0.6, 300 K, 101 325 Pa, α = 1°.

It reads from a pressure map that "the static pressure is the same at various positions", that "the total pressure" is
high at the front, at the wing's leading and at its trailing edge, and mounts the head at the windward front and the
leading edge. Its device's own map is said to have the smallest total pressure "in the middle of the plane". The
pressures here are those of holes in the surface; total pressure in the sense of stagnation is the same everywhere
outside boundary layers and wakes, p_t = p_s·(1 + 0.2·M²)^3.5.
"""

from dataclasses import dataclass
from math import radians
from typing import Any

import numpy as np

from uavsim import airdata
from uavsim.studies.survey.compressible import critical_coefficient
from uavsim.studies.survey.flow import AircraftFlow
from uavsim.studies.survey.geometry import Outline
from uavsim.studies.survey.places import Place, at_wing, places

MACH, TEMPERATURE, PRESSURE, ALPHA = 0.6, 300.0, 101_325.0, radians(1.0)  # Table 6
SPEED = MACH * airdata.speed_of_sound(TEMPERATURE)  # m/s
FRONT = ("nose, hole at the tip", "leading edge")
OFF_CENTRE = (0.0, 0.25, 0.5, 0.75, 0.9)  # of the radius from the middle of a round front


@dataclass(frozen=True, slots=True)
class Reading:
    """What a place reads in the published case.

    Attributes
    ----------
    name : str
    coefficient : float
        Cp.
    pressure : float
        Pa.
    supersonic : bool
        The local flow is faster than sound, where the rules here end.
    """

    name: str
    coefficient: float
    pressure: float
    supersonic: bool


def readings(candidates: list[Place]) -> list[Reading]:
    """Pressure at each place in the published case, the highest first."""
    impact = airdata.impact_pressure(static=PRESSURE, mach=MACH)
    over = airdata.impact_over_dynamic(MACH)
    least = critical_coefficient(MACH)
    at = np.array(ALPHA), np.array(0.0), np.array(MACH)
    found = []
    for place in candidates:
        share = float(place.share(*at))
        found.append(Reading(place.name, share * over, PRESSURE + share * impact, bool(share * over < least)))
    return sorted(found, key=lambda each: -each.pressure)


@dataclass(frozen=True, slots=True)
class Curve:
    """Cp along a line of the surface in the published case.

    Attributes
    ----------
    name : str
    part : str
        "fuselage" or "wing".
    x : tuple of float
        Along the fuselage, m, or x/c.
    cp : tuple of float
    """

    name: str
    part: str
    x: tuple[float, ...]
    cp: tuple[float, ...]


def curves(outline: Outline, source: str) -> list[Curve]:
    """Cp along fuselage and wing in the published case, as its Figure 14 shows it in colours."""
    flow = AircraftFlow(outline, source, MACH, SPEED)
    wing, over = outline.wing, airdata.impact_over_dynamic(MACH)
    at = np.array(ALPHA), np.array(0.0), np.array(MACH)
    first, length = outline.stations[0], outline.stations[-1] - outline.stations[0]
    stations = first + length * np.linspace(0.0, 0.96, 97) ** 1.5
    chords = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 60)))[:-1]
    found = []
    for name, azimuth in (("top", 0.0), ("side", 0.5 * np.pi), ("bottom", np.pi)):
        clear = [x for x in map(float, stations) if not at_wing(outline, x)]
        cp = tuple(float(flow.hole_on_body(x, azimuth)(*at)) * over for x in clear)
        found.append(Curve(name, "fuselage", tuple(clear), cp))
    for span in (0.5, 0.9):
        y = span * wing.tip
        for side, word in ((1.0, "upper"), (-1.0, "lower")):
            shares = (flow.hole_on_section(wing, y, side * x, flow.wing_angle(y))(*at) for x in map(float, chords))
            name = f"{word} side at {100 * span:.0f} % of span"
            found.append(Curve(name, "wing", tuple(map(float, chords)), tuple(float(s) * over for s in shares)))
    return found


def paper_case(outline: Outline, source: str) -> dict[str, Any]:
    """Judge the published conclusion by the pressures on this aircraft: a table with figures and notes."""
    flow = AircraftFlow(outline, source, MACH, SPEED)
    candidates = [place for place in places(flow) if place.kind == "hole"]
    read = readings(candidates)
    total = airdata.total_pressure(static=PRESSURE, mach=MACH)
    front = [each for each in read if each.name.endswith(FRONT)]
    rest = [each for each in read if not each.name.endswith(FRONT)]
    aft = [each for each in read if each.name.endswith("95 % of chord")]
    sides = [each for each in rest if not each.name.endswith("95 % of chord")]
    holds = min(each.pressure for each in front) > max((each.pressure for each in rest), default=PRESSURE)
    return {
        "mach": MACH, "temperature": TEMPERATURE, "p_static": PRESSURE, "alpha_deg": 1.0,
        "p_total": total, "impact_pressure": total - PRESSURE, "critical_cp": critical_coefficient(MACH),
        "front_and_leading_edge_highest": holds,
        "front": {each.name: {"cp": each.coefficient, "p": each.pressure} for each in front},
        "trailing_edge": {"cp": _span(aft, "coefficient"), "p": _span(aft, "pressure")},
        "elsewhere": {"cp": _span(sides, "coefficient"), "p": _span(sides, "pressure")},
        "off_the_middle_of_the_front": _off_centre(flow),
        "notes": _notes(holds, front, aft, sides),
        "readings": [
            {"place": r.name, "cp": r.coefficient, "p": r.pressure, "supersonic": r.supersonic} for r in read
        ],
    }  # fmt: skip


def _off_centre(flow: AircraftFlow) -> list[dict[str, float]]:
    """Cp across the front of the fuselage from its middle outwards, at α = 0: where the largest pressure is."""
    body = flow.body()
    x, r = body.middle
    nose = x < x[int(np.argmax(r))]
    over = airdata.impact_over_dynamic(MACH)
    zero, mach = np.array(0.0), np.array(MACH)
    found = []
    for share in OFF_CENTRE:
        station = float(np.interp(share * r.max(), r[nose], x[nose])) if share else flow.outline.stations[0]
        cp = float(flow.hole_on_body(station, 0.0)(zero, zero, mach)) * over
        found.append({"radius_share": share, "x": station, "cp": cp})
    return found


def _span(read: list[Reading], name: str) -> list[float]:
    values = [getattr(each, name) for each in read]
    return [min(values), max(values)] if values else []


def _notes(holds: bool, front: list[Reading], aft: list[Reading], sides: list[Reading]) -> list[str]:
    low, high = _span(front, "coefficient")
    verdict = "comes out" if holds else "does not come out"
    notes = [
        f"Windward front and leading edges as the places of highest pressure: {verdict}, Cp {low:.2f} to {high:.2f}.",
        "A flush hole reads the total pressure only where the flow stands still; a tube pointing forwards reads it "
        "anywhere outside boundary layers and wakes.",
    ]
    if aft:
        low, high = _span(aft, "coefficient")
        notes.append(
            f"The trailing edge is high only beside the suction ahead of it: Cp {low:.2f} to {high:.2f}; it "
            "is no place for a total port."
        )
    low, high = _span(sides, "coefficient") or (0.0, 0.0)
    notes.append(
        f"The static pressure is not the same at various positions: elsewhere Cp runs from {low:.2f} to {high:.2f}; "
        "it decides where the static port goes."
    )
    notes.append(
        "The total pressure is not smallest in the middle of a windward plane: the flow stands still there, and a hole "
        "reads less the farther it is from the middle."
    )
    return notes
