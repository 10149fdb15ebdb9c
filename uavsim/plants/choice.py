"""Which plant a scenario chooses, and what each of ours is told before it starts.

A new rig is a file in `rigs`. The settings of those below have groups of their own in [plant].
"""

from dataclasses import dataclass, field
from typing import Any

from uavsim.plants.in_jsbsim import NAME
from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import STEP_RATES, Plant
from uavsim.plants.rigs.centrifuge import CentrifugeSettings
from uavsim.plants.rigs.flight_path import FlightPathSettings
from uavsim.plants.rigs.launch_curve import LaunchCurveSettings
from uavsim.plants.rigs.wind_tunnel import WindTunnelSettings


def _nobody(*_: object) -> Plant:
    raise ValueError("this plant is not registered here")


@dataclass(frozen=True, slots=True)
class PlantSettings:
    """Where the truth comes from.

    Attributes
    ----------
    kind
        "jsbsim" flies the aircraft off its catapult; the others are rigs that hold the sensors and the detector. Others
        come from packages, from `--plugin` or from Python.
    step_rate
        Steps a second, 1000, 2000, 4000 or 8000 Hz, and as many rows of truth.
    options
        Settings of a plant that is not one of ours, as that has them.
    """

    kind: str = NAME
    step_rate: int = STEP_RATES[0]
    launch_curve: LaunchCurveSettings = field(default_factory=LaunchCurveSettings)
    centrifuge: CentrifugeSettings = field(default_factory=CentrifugeSettings)
    wind_tunnel: WindTunnelSettings = field(default_factory=WindTunnelSettings)
    flight_path: FlightPathSettings = field(default_factory=FlightPathSettings)
    options: dict[str, Any] | None = field(default=None, hash=False)

    @property
    def chosen(self) -> Kind:
        """What the chosen kind says of itself."""
        return KINDS[self.kind] if self.kind in KINDS else Kind(self.kind, _nobody)

    @property
    def own(self) -> Any:
        """Settings of the chosen kind, None if it has none."""
        group = self.chosen.group
        return getattr(self, group) if group else None

    @property
    def length(self) -> float:
        """How long the run takes after the wait, s; 0 for what has no set length."""
        return float(getattr(self.own, "length", 0.0))
