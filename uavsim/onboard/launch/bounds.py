"""Bounds that settings of several detectors share."""

from typing import Annotated

from annotated_types import Interval

Force = Annotated[float, Interval(gt=0.0, le=2000.0)]
"""A specific force, m/s²."""
Time = Annotated[float, Interval(gt=0.0, le=1.0)]
"""A time, s."""
Frequency = Annotated[float, Interval(gt=0.0, le=100_000.0)]
"""Hz."""
