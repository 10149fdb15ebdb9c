"""The places on an aircraft where a head could be mounted."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import pi
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.survey.flow import PIPE, AircraftFlow, Share
from uavsim.studies.survey.geometry import Outline, Surface

Array = NDArray[np.float64]
Kind = Literal["hole", "tube", "boom"]
Role = Literal["total", "static"]

SPANS = (0.3, 0.5, 0.7, 0.9)  # of the half span, fuselage included
CLEAR = 1.3  # radii of the fuselage, within which a wing's place is in its junction
CHORDS = (0.05, 0.15, 0.30, 0.50, 0.75, 0.95)  # x/c, upper and lower side
BODY = (0.02, 0.10, 0.20, 0.30, 0.40, 0.50, 0.60, 0.70, 0.80)  # of the fuselage's length
NEAR_WING = 0.85  # chords from the wing's quarter chord, within which its lifting line says nothing of the fuselage
BEHIND_WING = "behind the wing: its wake, and its panels where they fold back"
ON_TAIL = "behind the wing, ahead of a propeller, on a surface that deflects"
ON_FIN = "behind the wing, beside a propeller"
SHIFT = 0.002  # m, a hole drilled beside its place


@dataclass(frozen=True)
class Place:
    """A place and what it reads.

    Attributes
    ----------
    name : str
    part : str
        nose, fuselage, wing, tail or fin.
    kind : str
        hole, flush with the surface; tube, open ahead; boom, static holes on a tube ahead of the aircraft.
    roles : tuple
        What it can serve as.
    position : (x, y, z)
        Of the place, or the right one of a pair, m, structural frame.
    shares : tuple of Share
        Of the holes whose mean pressure it reads.
    folded : tuple of Share
        The same with the wing folded; empty if it makes no difference.
    folds : bool
        In the stream only when the wing is out.
    caveat : str
        What is not in the flow here and speaks against the place; empty where nothing does.
    shifted : tuple of Share
        The same holes 2 mm further aft; empty where that means nothing.
    """

    name: str
    part: str
    kind: Kind
    roles: tuple[Role, ...]
    position: tuple[float, float, float]
    shares: tuple[Share, ...]
    folds: bool = False
    caveat: str = ""
    shifted: tuple[Share, ...] = ()
    folded: tuple[Share, ...] = ()

    def share(self, alpha: Array, beta: Array, mach: Array, wing_out: NDArray[np.bool_] | bool = True) -> Array:
        """(p − p_s)/q_c of the mean of its holes, of angles in rad, the Mach number and whether the wing is out."""
        at = np.broadcast_arrays(*(np.asarray(each, dtype=float) for each in (alpha, beta, mach)))
        out = np.mean([share(*at) for share in self.shares], axis=0)
        if not self.folded or np.all(wing_out):
            return np.asarray(out)
        folded = np.mean([share(*at) for share in self.folded], axis=0)
        return np.asarray(np.where(wing_out, out, folded), dtype=float)

    def slope(self, alpha: float, beta: float, mach: float) -> float | None:
        """How much the share changes a millimetre along the surface, 1/mm; None where that means nothing."""
        if not self.shifted:
            return None
        at = (np.array(alpha), np.array(beta), np.array(mach))
        moved = np.mean([share(*at) for share in self.shifted])
        return float((moved - self.share(*at)) / (1e3 * SHIFT))


def places(flow: AircraftFlow) -> list[Place]:
    """Return all candidate places of an aircraft."""
    found = [*_nose(flow), *_fuselage(flow), *_wing(flow)]
    if flow.outline.tail is not None:
        found += _tail(flow, flow.outline.tail)
    if flow.outline.fin is not None:
        found += _fin(flow, flow.outline.fin)
    return found


def _nose(flow: AircraftFlow) -> Iterator[Place]:
    front, diameter = flow.outline.stations[0], max(flow.outline.diameters)

    def place(name: str, kind: Kind, role: Role, ahead: float, share: Callable[[AircraftFlow], Share]) -> Place:
        folded = tuple(share(each) for each in _folded(flow))
        return Place(name, "nose", kind, (role,), (front - ahead, 0.0, 0.0), (share(flow),), folded=folded)

    yield place("nose, hole at the tip", "hole", "total", 0.0, lambda each: each.hole_on_body(front, 0.0))
    yield place("nose, tube", "tube", "total", PIPE, AircraftFlow.tube_at_nose)
    for ahead in (0.5, 1.0, 1.5):
        distance = ahead * diameter
        boom = partial(AircraftFlow.boom_at_nose, distance=distance)
        yield place(f"nose, boom {ahead:g} diameters ahead", "boom", "static", distance, boom)


def _folded(flow: AircraftFlow) -> tuple[AircraftFlow, ...]:
    """Return the flow with the wing folded, if it folds."""
    return (replace(flow, wing_out=False),) if flow.outline.folding else ()


def _fuselage(flow: AircraftFlow) -> Iterator[Place]:
    outline = flow.outline
    first, length = outline.stations[0], outline.stations[-1] - outline.stations[0]
    for share in BODY:
        x = first + share * length
        if at_wing(outline, x):
            continue
        radius = outline.radius(x)
        for name, azimuths in (
            ("top", (0.0,)), ("side", (0.5 * pi,)), ("bottom", (pi,)), ("both sides", (0.5 * pi, 1.5 * pi)),
            ("ring of four", (0.25 * pi, 0.75 * pi, 1.25 * pi, 1.75 * pi)),
        ):  # fmt: skip
            position = (x, radius * float(np.sin(azimuths[0])), radius * float(np.cos(azimuths[0])))
            holes, moved = (
                tuple(flow.hole_on_body(station, azimuth) for azimuth in azimuths) for station in (x, x + SHIFT)
            )
            folded = tuple(each.hole_on_body(x, azimuth) for each in _folded(flow) for azimuth in azimuths)
            yield Place(
                f"fuselage at {1e3 * x:.0f} mm, {name}", "fuselage", "hole", ("static",), position, holes,
                caveat=BEHIND_WING if x > outline.wing.quarter_chord else "", shifted=moved, folded=folded,
            )  # fmt: skip


def at_wing(outline: Outline, x: float) -> bool:
    """Tell whether a station is beside the wing, where the flow of their junction is not known here."""
    return abs(x - outline.wing.quarter_chord) < NEAR_WING * outline.wing.root_chord


def _wing(flow: AircraftFlow) -> Iterator[Place]:
    wing, folds = flow.outline.wing, flow.outline.folding
    for span in SPANS:
        y = span * wing.tip
        if y < CLEAR * flow.outline.radius(wing.quarter_chord):
            continue
        angle = flow.wing_angle(y)
        front, chord, name = wing.leading_edge(y), wing.chord(y), f"wing at {100 * span:.0f} % of span"
        nose = flow.hole_on_section(wing, y, 0.0, angle)
        yield Place(f"{name}, leading edge", "wing", "hole", ("total",), (front, y, 0.0), (nose,), folds)
        tube = flow.tube_ahead_of_section(wing, y, angle)
        yield Place(f"{name}, tube", "wing", "tube", ("total",), (front - PIPE, y, 0.0), (tube,), folds)
        boom = flow.boom_ahead_of_section(wing, y, angle)
        yield Place(f"{name}, boom 1 chord ahead", "wing", "boom", ("static",), (front - chord, y, 0.0), (boom,), folds)
        for side, word in ((1.0, "upper"), (-1.0, "lower")):
            for x in CHORDS:
                hole, moved = (
                    flow.hole_on_section(wing, y, side * (x + shift / chord), angle) for shift in (0.0, SHIFT)
                )
                label = f"{name}, {word} side at {100 * x:.0f} % of chord"
                position = (front + x * chord, y, 0.0)
                yield Place(label, "wing", "hole", ("static",), position, (hole,), folds, shifted=(moved,))


def _tail(flow: AircraftFlow, tail: Surface) -> Iterator[Place]:
    y = 0.5 * (tail.root + tail.tip)
    angle, front, chord = flow.tail_angle(y), tail.leading_edge(y), tail.chord(y)
    nose = flow.hole_on_section(tail, y, 0.0, angle)
    yield Place("tail, leading edge", "tail", "hole", ("total",), (front, y, tail.z), (nose,), caveat=ON_TAIL)
    tube = flow.tube_ahead_of_section(tail, y, angle)
    yield Place("tail, tube", "tail", "tube", ("total",), (front - PIPE, y, tail.z), (tube,), caveat=ON_TAIL)
    for side, word in ((1.0, "upper"), (-1.0, "lower")):
        for x in (0.15, 0.5, 0.75):
            hole = flow.hole_on_section(tail, y, side * x, angle)
            label = f"tail, {word} side at {100 * x:.0f} % of chord"
            yield Place(label, "tail", "hole", ("static",), (front + x * chord, y, tail.z), (hole,), caveat=ON_TAIL)


def _fin(flow: AircraftFlow, fin: Surface) -> Iterator[Place]:
    z = 0.5 * (fin.root + fin.tip)
    front, chord = fin.leading_edge(z), fin.chord(z)
    yield Place(
        "fin, leading edge", "fin", "hole", ("total",), (front, 0.0, z), (flow.hole_on_fin(fin, z, 0.0),), caveat=ON_FIN
    )
    for x in (0.15, 0.5, 0.75):
        sides = tuple(flow.hole_on_fin(fin, z, side * x) for side in (1.0, -1.0))
        label = f"fin, both sides at {100 * x:.0f} % of chord"
        yield Place(label, "fin", "hole", ("static",), (front + x * chord, 0.0, z), sides, caveat=ON_FIN)
