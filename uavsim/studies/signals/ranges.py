"""Bounds of uniform distributions, and the kinds of numbers that signals are made of."""

from typing import Annotated

import numpy as np
from annotated_types import Ge
from numpy.typing import NDArray

Array = NDArray[np.float64]
Single = NDArray[np.float32]
NonNegative = Annotated[float, Ge(0)]
Range = tuple[NonNegative, NonNegative]
"""Bounds of a uniform distribution; equal ones give that value."""


def check(name: str, bounds: Range, least: float = 0.0, most: float = 1e6) -> None:
    """Refuse bounds that are not in order or leave `least` … `most`."""
    if not least <= bounds[0] <= bounds[1] <= most:
        raise ValueError(f"{name} must be two numbers in {least:g} … {most:g}, the smaller first, not {bounds}")
