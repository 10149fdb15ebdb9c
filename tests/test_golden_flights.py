"""Short flights with keys away from their defaults give the figures that are kept of them.

A failure says that a number has changed, not that it has become wrong. If it was meant to, `python
tests/golden_flights.py` writes the figures anew; the commit that does so says what changed and why. If it was not, the
lines of the failure say where it begins: truth before accelerometer and air_data is the plant, those without truth are
the sensors, estimate and events alone are on board, the score alone is the judging.
"""

import json

import numpy as np
import pytest
from golden_flights import FLIGHTS, differences, figures, fly, read, sums

ORDER = ("truth", "accelerometer", "air_data", "detector", "estimate", "events", "score")  # along the signal


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_flight_gives_the_figures_that_are_kept(name: str) -> None:
    found = json.loads(json.dumps(figures(fly(name))))
    lines = sorted(differences(read()[name], found), key=lambda line: ORDER.index(line.partition(" ")[0]))
    assert not lines, f"{len(lines)} figures of {name} differ, the first of them:\n" + "\n".join(lines[:8])


def test_no_flight_is_kept_that_is_not_flown() -> None:
    assert list(read()) == list(FLIGHTS)


def test_the_sums_see_a_shift_an_exchange_and_a_millionth() -> None:
    x = np.sin(0.1 * np.arange(500.0)) + 3.0
    exchanged = x.copy()
    exchanged[[10, 11]] = exchanged[[11, 10]]
    kept = {"table": {"x": sums(x)}}
    assert differences(kept, {"table": {"x": sums(x.copy())}}) == []
    for other in (np.roll(x, 1), exchanged, x * (1.0 + 1e-6), np.where(x > 3.9, np.nan, x)):
        assert len(differences(kept, {"table": {"x": sums(other)}})) == 1
