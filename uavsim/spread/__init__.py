"""What a scenario says of values that differ from flight to flight: distributions, their keys and how they go together.

The draws themselves are in `uavsim.dispersions`.
"""

from uavsim.spread.settings import Correlation, Dispersion

__all__ = ["Correlation", "Dispersion"]
