"""Dispersions of a scenario, drawn: what a flight of a campaign is, given the scenario, its seed and its number.

Each dispersion draws a standard normal value (normal) or a uniform one (the others) from a stream of its own name,

    Streams(seed, index)("dispersion." + key)

so that a flight depends on scenario, seed and index alone, and one more dispersion leaves the draws of all others as
they were. Correlated ones are made of their own normal values by Cholesky's factor in the order of the file
(`uavsim.spread.correlated`): one more that is correlated changes those that it is linked to and that come after it,
and nothing before it. Instead of random values those of a point of the unit cube can be taken, by the inverse of each
distribution: that is what designs are made of.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sensors import Streams
from sensors.choice import shown
from uavsim.scenario import ImpossibleError, Scenario, with_values
from uavsim.spread.correlated import correlated
from uavsim.spread.distribution import Distribution, distribution
from uavsim.spread.key import find
from uavsim.spread.settings import Chosen

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Point = NDArray[Any]

EDGE = 2.0**-53  # how near to 0 and 1 a coordinate is taken: the normal distribution has no value at either


def keys(scenario: Scenario) -> tuple[str, ...]:
    """Keys of a scenario's dispersions, in their order."""
    return tuple(one.key for one in scenario.dispersions)


def drawn(scenario: Scenario, index: int, point: "Point | None" = None) -> dict[str, Chosen]:
    """Draw the values of one flight.

    Parameters
    ----------
    scenario
        With its dispersions and its seed.
    index
        Number of the flight under that seed.
    point
        Of the unit cube, shape (number of dispersions,), in place of random values.

    Returns
    -------
    dict
        Values in each key's own unit, by key.

    Raises
    ------
    ValueError
        The point is none of that cube.
    """
    found = {one.key: _distribution(scenario, one.key, i) for i, one in enumerate(scenario.dispersions)}
    base = _random(found, Streams(scenario.seed, index)) if point is None else _of_point(found, point)
    normals = {key: base[key] for key, one in found.items() if one.is_normal}
    normals = correlated(normals, scenario.correlations) if scenario.dispersions else {}
    return {
        key: one.of_normal(normals[key]) if one.is_normal else one.of_uniform(base[key]) for key, one in found.items()
    }


def resolved(scenario: Scenario, index: int, point: "Point | None" = None) -> Scenario:
    """Return one flight's own scenario: its dispersions drawn, none left, and its number.

    What the scenario has from outside stays as it was read; a preset or an aircraft that is drawn is read now.

    Parameters
    ----------
    scenario, index, point
        As of `drawn`.

    Raises
    ------
    ValueError
        One line: these values are not possible together, with the number of the flight.
    """
    if not scenario.dispersions:
        plain = scenario.index == index and not scenario.correlations
        return scenario if plain else replace(scenario, index=index, correlations=())
    values = drawn(scenario, index, point)
    bare = replace(scenario, index=index, dispersions=(), correlations=())
    try:
        return with_values(bare, values)
    except ImpossibleError as error:
        raise ValueError(
            f"{scenario.name}: seed {scenario.seed}, index {index} draws {_listed(values, error.keys)}: {error}"
        ) from None


def _distribution(scenario: Scenario, name: str, i: int) -> Distribution:
    key = find(scenario, name)
    return distribution(scenario.dispersions[i], key.own(scenario), key.number)


def _random(found: Mapping[str, Distribution], streams: Streams) -> dict[str, float]:
    """A standard normal or a uniform value of each."""
    values = {}
    for key, one in found.items():
        stream = streams(f"dispersion.{key}")
        values[key] = float(stream.standard_normal() if one.is_normal else stream.random())
    return values


def _of_point(found: Mapping[str, Distribution], point: "Point") -> dict[str, float]:
    """The same of a point of the unit cube."""
    from scipy.special import ndtri

    coordinates = [float(value) for value in point]
    if len(coordinates) != len(found) or not all(0.0 <= value <= 1.0 for value in coordinates):
        raise ValueError(f"point: must have {len(found)} coordinates from 0 to 1, one for each dispersion")
    inside = (min(max(value, EDGE), 1.0 - EDGE) for value in coordinates)
    return {
        key: float(ndtri(value)) if one.is_normal else value
        for (key, one), value in zip(found.items(), inside, strict=True)
    }


def _listed(values: Mapping[str, Chosen], concerned: tuple[str, ...]) -> str:
    """Write the drawn values that an error concerns; all of them if it does not say which."""
    near = {key: v for key, v in values.items() if any(_within(key, k) or _within(k, key) for k in concerned)}
    told = near or values
    return ", ".join(f"{key} = {f'{v:.6g}' if isinstance(v, float) else shown(v)}" for key, v in told.items())


def _within(key: str, group: str) -> bool:
    return f"{key}.".startswith((f"{group}.", f"{group}["))
