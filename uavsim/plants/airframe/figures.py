"""Whether a mass, an inertia and a size can be: SI, by the units that the file states.

A rigid body has m > 0 and a positive definite tensor of inertia whose principal moments obey I₁ + I₂ ≥ I₃ (any
textbook of mechanics). The bounds hold whatever flies, from a palm-sized drone to the largest aeroplane.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from uavsim.plants.airframe.markup import Element, MarkupError
from uavsim.plants.airframe.tables import number

_FT, _LB, _SLUG = 0.3048, 0.45359237, 14.59390294
LENGTH: Mapping[str, float] = {"FT": _FT, "M": 1.0, "IN": _FT / 12.0}
AREA: Mapping[str, float] = {"FT2": _FT**2, "M2": 1.0}
MASS: Mapping[str, float] = {"LBS": _LB, "KG": 1.0, "SLUG": _SLUG}
INERTIA: Mapping[str, float] = {"SLUG*FT2": _SLUG * _FT**2, "KG*M2": 1.0}
# SI a unit; the first is what JSBSim takes where none is stated

METRICS = {
    "wingspan": (LENGTH, 0.01, 200.0, "m"),
    "chord": (LENGTH, 0.001, 100.0, "m"),
    "wingarea": (AREA, 1e-5, 1e4, "m²"),
}
TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
LIGHTEST, HEAVIEST = 1e-3, 1e6  # kg
LEAST_INERTIA = 1e-9  # kg m²
REACH = 100.0  # m, beyond which no part of an aircraft lies
ROUNDING = 0.02  # of the sum, by which two moments may fall short of the third: figures are rounded


def check_places(root: Element) -> None:
    """Refuse a part that lies beyond `REACH`."""
    for place in root.all():
        if place.tag in {"location", "drain_location"}:
            inches = {"unit": place.attributes.get("unit", "IN")}
            for axis in place.children:
                _bounded(axis, _si(Element(axis.tag, inches, axis.line, text=axis.text), LENGTH), -REACH, REACH, "m")


def check_body(metrics: Element, balance: Element) -> None:
    """Refuse sizes, masses and inertias that cannot be: all of them in one line, the first with its line."""
    found: list[tuple[str, int]] = []
    for element, value, least, greatest, unit in (*_sizes(metrics), *_masses(balance)):
        if not least <= value <= greatest:
            found.append((_out(element, value, least, greatest, unit), element.line))
    if not found and (problem := of_inertia(*(_of(balance, tag) for tag in TENSOR))):
        found.append((f"<mass_balance>: {problem}", balance.line))
    if found:
        first, *others = found
        raise MarkupError("; ".join((first[0], *(f"line {line}: {said}" for said, line in others))), first[1])


def _sizes(metrics: Element) -> Iterator[tuple[Element, float, float, float, str]]:
    """Each size with its bounds and its unit."""
    for tag, (unit, least, greatest, shown) in METRICS.items():
        element = metrics.find(tag)
        assert element is not None  # the grammar needs it
        yield element, _si(element, unit), least, greatest, shown


def _masses(balance: Element) -> Iterator[tuple[Element, float, float, float, str]]:
    """Each mass and moment of inertia with its bounds and its unit."""
    empty = balance.find("emptywt")
    assert empty is not None
    yield empty, _si(empty, MASS), LIGHTEST, HEAVIEST, "kg"
    for point in balance.children:
        if point.tag == "pointmass" and (weight := point.find("weight")) is not None:
            yield weight, _si(weight, MASS), 0.0, HEAVIEST, "kg"
    for tag in TENSOR[:3]:
        element = balance.find(tag)
        assert element is not None
        yield element, _si(element, INERTIA), LEAST_INERTIA, HEAVIEST * REACH**2, "kg m²"


def of_inertia(ixx: float, iyy: float, izz: float, ixy: float, ixz: float, iyz: float) -> str:
    """Say why no body has this tensor of inertia, kg m²; nothing if one has."""
    least, middle, greatest = np.linalg.eigvalsh([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    if least <= 0.0:
        return "the products of inertia are too great for the moments: no body has them"
    if least + middle < greatest * (1.0 - ROUNDING):
        return (
            f"moments of inertia {least:.3g}, {middle:.3g}, {greatest:.3g} kg m²: two must add up to the third at least"
        )
    return ""


def _of(balance: Element, tag: str) -> float:
    element = balance.find(tag)
    return 0.0 if element is None else _si(element, INERTIA)


def _si(element: Element, units: Mapping[str, float]) -> float:
    """Value of an element in SI."""
    stated = element.attributes.get("unit", next(iter(units)))
    if stated not in units:
        raise MarkupError(f"<{element.tag}>: unit {stated!r} does not fit; allowed: {', '.join(units)}", element.line)
    value = number(element.text)
    assert value is not None  # the grammar has seen to it
    return value * units[stated]


def _bounded(element: Element, value: float, least: float, greatest: float, unit: str) -> None:
    if not least <= value <= greatest:
        raise MarkupError(_out(element, value, least, greatest, unit), element.line)


def _out(element: Element, value: float, least: float, greatest: float, unit: str) -> str:
    """Say that a figure is out of its bounds."""
    return f"<{element.tag}>: is {value:.4g} {unit}; from {least:g} to {greatest:g} {unit} are allowed"
