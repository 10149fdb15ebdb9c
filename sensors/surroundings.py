"""What sensors may ask of the truth around them. They are given it once, and it is worked out when it is asked for.

Specific force is not in it: that comes step by step, with the vibration in it that everything feels.
"""

from typing import Protocol

Air = tuple[float, float, float]
"""True total and static pressure, Pa, and temperature, K."""
Flow = tuple[float, float, float, float, float, float, float]
"""True total and static pressure, Pa, temperature, K, Mach number, alpha, beta, rad, throttle 0 … 1."""


class Surroundings(Protocol):
    """The air around the sensors; a plant is one."""

    def flow(self) -> Flow:
        """Everything about the air after this step of the plant."""

    def air(self, time: float, /) -> Air:
        """Pressures and temperature at any `time`, s, up to this step, linear within a step."""
