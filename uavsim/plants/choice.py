"""Which plant a scenario chooses, and what each is told before it starts.

A new kind is a file of its own, with its settings and its `KIND`, and is named here: where kinds are registered, and
with the group that its settings stand in.
"""

from dataclasses import dataclass, field
from typing import Any

from uavsim.plants import centrifuge, in_jsbsim, launch_curve, wind_tunnel
from uavsim.plants.centrifuge import CentrifugeSettings
from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.launch_curve import LaunchCurveSettings
from uavsim.plants.wind_tunnel import WindTunnelSettings

for _shipped in (
    in_jsbsim.KIND,
    launch_curve.KIND,
    centrifuge.KIND,
    wind_tunnel.KIND,
):
    KINDS.add(_shipped)


@dataclass(frozen=True, slots=True)
class PlantSettings:
    """Where the truth comes from.

    Attributes
    ----------
    kind
        "jsbsim" flies the aircraft off its catapult; the others are rigs that hold the sensors and the detector. Others
        come from packages, from `--plugin` or from Python.
    options
        Settings of a plant that is not one of ours, as that has them.
    """

    kind: str = in_jsbsim.KIND.name
    launch_curve: LaunchCurveSettings = field(default_factory=LaunchCurveSettings)
    centrifuge: CentrifugeSettings = field(default_factory=CentrifugeSettings)
    wind_tunnel: WindTunnelSettings = field(default_factory=WindTunnelSettings)
    options: dict[str, Any] | None = field(default=None, hash=False)

    @property
    def chosen(self) -> Kind:
        """What the chosen kind says of itself."""
        return KINDS[self.kind]

    @property
    def own(self) -> Any:
        """Settings of the chosen kind, None if it has none."""
        group = self.chosen.group
        return getattr(self, group) if group else self.options

    @property
    def length(self) -> float:
        """How long the run takes after the wait, s; 0 for what has no set length."""
        return float(getattr(self.own, "length", 0.0))
