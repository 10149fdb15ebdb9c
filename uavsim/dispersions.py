"""What a scenario's flights draw besides noise and sensor units; so far nothing."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.scenario import Scenario


def keys(scenario: Scenario) -> tuple[str, ...]:
    """Keys that are drawn."""
    del scenario
    return ()


def drawn(scenario: Scenario, index: int, point: NDArray[np.float64] | None = None) -> dict[str, Any]:
    """Values that flight `index` draws."""
    del scenario, index, point
    return {}


def resolved(scenario: Scenario, index: int, point: NDArray[np.float64] | None = None) -> Scenario:
    """What flies."""
    del point
    return replace(scenario, index=index)
