"""The outline of an aircraft that a survey needs, read from its `geometry.toml`.

Structural frame: x aft from the nose, y right, z up, m; angles in degrees where a name ends in _deg.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite, radians
from pathlib import Path
from typing import Any

from sensors.data_files import read_toml
from uavsim.plants.hangar import aircraft, hangar
from uavsim.studies.survey.section import naca_four_digit

LARGEST = 100.0  # m; no UAV is larger
MOST_INCIDENCE = 30.0  # deg
MOST_STATIONS = 200  # of a fuselage: each is a ring of panels
LONGEST_NAME = 100  # characters


@dataclass(frozen=True, slots=True)
class Surface:
    """A wing, tailplane or fin with straight edges.

    Attributes
    ----------
    airfoil : str
    quarter_chord : float
        x of the quarter chord, m.
    root, tip : float
        Distance of the ends from the plane of symmetry (a fin: from the axis), m.
    root_chord, tip_chord : float
        m.
    incidence : float
        rad.
    z : float
        Height of a wing or tailplane, m.
    """

    airfoil: str
    quarter_chord: float
    root: float
    tip: float
    root_chord: float
    tip_chord: float
    incidence: float = 0.0
    z: float = 0.0

    def chord(self, y: float) -> float:
        """Chord at a distance from the plane of symmetry, m."""
        share = (y - self.root) / (self.tip - self.root)
        return self.root_chord + (self.tip_chord - self.root_chord) * share

    def leading_edge(self, y: float) -> float:
        """Place of the leading edge, x, m."""
        return self.quarter_chord - 0.25 * self.chord(y)


@dataclass(frozen=True, slots=True)
class Outline:
    """What a survey needs to know of an aircraft.

    Attributes
    ----------
    name : str
    stations, diameters : tuple of float
        Of the round fuselage, m.
    wing, tail, fin : Surface
        The wing out; tail and fin None if there is none.
    folding : bool
        Whether the wing's places are in the stream only when it is out.
    """

    name: str
    stations: tuple[float, ...]
    diameters: tuple[float, ...]
    wing: Surface
    tail: Surface | None
    fin: Surface | None
    folding: bool

    def radius(self, x: float) -> float:
        """Radius of the fuselage between its stations, m, linear: where it is drawn."""
        from numpy import interp

        return 0.5 * float(interp(x, self.stations, self.diameters))


def read_outline(name: str) -> Outline:
    """Read the outline of an aircraft.

    Parameters
    ----------
    name : str
        A packaged aircraft, or a folder that holds `geometry.toml`.

    Raises
    ------
    ValueError
        No such aircraft, or what is wrong in its file: file, key, what is allowed.
    """
    path = _find(name)
    try:
        return _outline(read_toml(path), path.parent.name)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _find(name: str) -> Path:
    for folder in (hangar() / name, Path(name).expanduser()):
        if name and (folder / "geometry.toml").is_file():
            return folder.resolve() / "geometry.toml"
    known = ", ".join(one for one in aircraft() if (hangar() / one / "geometry.toml").is_file())
    raise ValueError(f"no geometry.toml for aircraft {name!r}; packaged: {known}; or the path of a folder with one")


def _outline(data: Mapping[str, Any], folder: str) -> Outline:
    fuselage = _group(data, "fuselage")
    stations, diameters = _column(fuselage, "fuselage.x"), _column(fuselage, "fuselage.diameter")
    if len(stations) != len(diameters) or len(stations) < 3:
        raise ValueError("fuselage.x and fuselage.diameter: as many numbers in both, three at least")
    if any(b <= a for a, b in pairwise(stations)):
        raise ValueError("fuselage.x: must increase")
    if diameters[0] != 0.0 or any(d <= 0.0 for d in diameters[1:-1]) or diameters[-1] < 0.0:
        raise ValueError("fuselage.diameter: 0 at the nose and above 0 behind it")
    title = data.get("name", folder)
    if not isinstance(title, str) or len(title) > LONGEST_NAME:
        raise ValueError(f"name: must be text of at most {LONGEST_NAME} characters")
    return Outline(
        title, stations, diameters, _wing(_group(data, "wing")), _tail(data), _fin(data),
        "sweep_folded_deg" in data["wing"],
    )  # fmt: skip


def _wing(w: Mapping[str, Any]) -> Surface:
    """Two rectangular panels on pivots, out, through the fuselage."""
    pivot = _column(w, "wing.pivot")
    if len(pivot) != 2:
        raise ValueError("wing.pivot: x and y, two numbers")
    chord, length = _positive(w, "wing.chord"), _positive(w, "wing.length")
    if pivot[1] + length <= 0.0:
        raise ValueError("wing.pivot: y must be on the right side, with wing.length beyond it")
    front = pivot[0] - _number(w, "wing.pivot_chord_fraction") * chord
    return Surface(
        _airfoil(w, "wing.airfoil"), front + 0.25 * chord, 0.0, pivot[1] + length, chord, chord,
        radians(_number(w, "wing.incidence_deg", 0.0)),
    )  # fmt: skip


def _tail(data: Mapping[str, Any]) -> Surface | None:
    if "tail" not in data:
        return None
    t = _group(data, "tail")
    surface = Surface(
        _airfoil(t, "tail.airfoil"), _number(t, "tail.quarter_chord_x"), _number(t, "tail.root_y"),
        _positive(t, "tail.tip_y"), _positive(t, "tail.root_chord"), _positive(t, "tail.tip_chord"),
        radians(_number(t, "tail.incidence_deg", 0.0)), _number(t, "tail.z", 0.0),
    )  # fmt: skip
    return _ordered(surface, "tail.tip_y: must be beyond tail.root_y")


def _fin(data: Mapping[str, Any]) -> Surface | None:
    if "fin" not in data:
        return None
    f = _group(data, "fin")
    surface = Surface(
        _airfoil(f, "fin.airfoil"), _number(f, "fin.quarter_chord_x"), _number(f, "fin.root_z"),
        _positive(f, "fin.tip_z"), _positive(f, "fin.root_chord"), _positive(f, "fin.tip_chord"),
    )  # fmt: skip
    return _ordered(surface, "fin.tip_z: must be beyond fin.root_z")


def _ordered(surface: Surface, message: str) -> Surface:
    if surface.tip <= surface.root:
        raise ValueError(message)
    return surface


def _group(data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = data.get(key)
    if not isinstance(value, Mapping):
        raise ValueError(f"{key}: the group [{key}] is missing")  # noqa: TRY004 (what a user wrote)
    return value


def _number(group: Mapping[str, Any], key: str, default: float | None = None) -> float:
    value = group.get(key.split(".")[1], default)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        raise ValueError(f"{key}: must be a number")
    most = MOST_INCIDENCE if key.endswith("_deg") else LARGEST
    if abs(value) > most:
        raise ValueError(f"{key}: must be from -{most:g} to {most:g}")
    return float(value)


def _positive(group: Mapping[str, Any], key: str) -> float:
    value = _number(group, key)
    if value <= 0.0:
        raise ValueError(f"{key}: must be above 0")
    return value


def _column(group: Mapping[str, Any], key: str) -> tuple[float, ...]:
    value = group.get(key.split(".")[1])
    if not isinstance(value, list) or any(
        isinstance(each, bool) or not isinstance(each, (int, float)) or not abs(each) <= LARGEST for each in value
    ):
        raise ValueError(f"{key}: must be a list of numbers, each from -{LARGEST:g} to {LARGEST:g}")
    if len(value) > MOST_STATIONS:
        raise ValueError(f"{key}: has {len(value)} numbers; it must have {MOST_STATIONS} at most")
    return tuple(float(each) for each in value)


def _airfoil(group: Mapping[str, Any], key: str) -> str:
    value = group.get("airfoil")
    if not isinstance(value, str):
        raise ValueError(f'{key}: must name a section, as "naca4412"')  # noqa: TRY004 (what a user wrote)
    try:
        naca_four_digit(value)
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from None
    return value
