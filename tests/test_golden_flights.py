"""Short flights with keys away from their defaults give the figures that are kept of them.

A failure says that a number has changed, not that it has become wrong. If it was meant to, `python
tests/golden_flights.py` writes the figures anew; the commit that does so says what changed and why. If it was not, the
lines of the failure say where it begins: truth before accelerometer and air_data is the plant, those without truth are
the sensors, estimate and events alone are on board, the score alone is the judging.
"""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from golden_flights import FLIGHTS, differences, figures, fly, read, sums

from uavsim.scenario import Scenario, keys, load_scenario

ORDER = ("truth", "accelerometer", "air_data", "detector", "estimate", "events", "score")  # along the signal


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_gives_the_figures_that_are_kept(name: str) -> None:
    found = json.loads(json.dumps(figures(fly(name))))
    lines = sorted(differences(read()[name], found), key=lambda line: ORDER.index(line.partition(" ")[0]))
    assert not lines, f"{len(lines)} figures of {name} differ, the first of them:\n" + "\n".join(lines[:8])


def test_no_flight_is_kept_that_is_not_flown() -> None:
    assert list(read()) == list(FLIGHTS)


ELSEWHERE = {
    **dict.fromkeys(
        ("plugins", "plant.options", "estimator.options"), "they are of parts of one's own, test_plugins.py"
    ),
    "detector.": "the rules' own settings are varied in test_launch_*.py and test_detections.py",
    "aircraft.model": "there is one aircraft; test_aircraft.py flies others",
}
"""Keys, or what they begin with, that no kept flight moves, and where they are moved."""


def leaves(group: dict[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in group.items():
        if isinstance(value, dict) and value:
            yield from leaves(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def test_every_key_is_away_from_its_default_in_one_of_them() -> None:
    """A key that is only flown at its default hides its factor of 1 or its term of 0; a new one joins a flight here."""
    default = dict(leaves(Scenario().to_dict()))
    moved: set[str] = set()
    for name, seed, overrides in FLIGHTS.values():
        flown = dict(leaves(load_scenario(name, overrides=overrides, seed=seed).to_dict()))
        moved |= {key for key, value in flown.items() if default.get(key) != value}
    moved |= {key.partition(".properties.")[0] + ".properties" for key in moved if ".properties." in key}
    still = [key for key in keys() if key not in moved and not key.startswith(tuple(ELSEWHERE))]
    assert still == []


def test_the_sums_see_a_shift_an_exchange_and_a_millionth() -> None:
    x = np.sin(0.1 * np.arange(500.0)) + 3.0
    exchanged = x.copy()
    exchanged[[10, 11]] = exchanged[[11, 10]]
    kept = {"table": {"x": sums(x)}}
    assert differences(kept, {"table": {"x": sums(x.copy())}}) == []
    for other in (np.roll(x, 1), exchanged, x * (1.0 + 1e-6), np.where(x > 3.9, np.nan, x)):
        assert len(differences(kept, {"table": {"x": sums(other)}})) == 1
