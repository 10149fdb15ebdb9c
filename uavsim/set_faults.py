"""What a scenario makes go wrong with a sensor or a port: which fault, where, from when until when."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sensors.settings import Fault, PortFault
    from uavsim.scenario import Scenario

NOUNS = {"blocked": "blockage", "stuck": "stuck value", "invalid": "invalid value"}
PARTICIPLES = {"leak": "leaking", "ice": "icing", "water": "wet", "spike": "spiked", "offset": "offset"}


@dataclass(frozen=True, slots=True)
class SetFault:
    """A fault that the scenario sets, as "total port blocked", a "blockage"; from `start` to `stop`, s."""

    name: str
    noun: str
    start: float
    stop: float


def set_faults(scenario: "Scenario") -> list[SetFault]:
    """Return the faults of all sensors and ports in the order of their start."""
    from sensors.settings import FOREVER  # late: a score that is read needs no sensors

    found = []
    air = scenario.air_data
    faults: dict[str, Sequence[Fault | PortFault]] = {
        "total port": air.total_port.faults,
        "static port": air.static_port.faults,
        "both ports": air.port_faults,
        "total sensor": air.total.faults,
        "differential sensor": air.differential.faults,
        "static sensor": air.static.faults,
        "thermometer": air.thermometer_faults,
        "accelerometer": scenario.accelerometer.faults,
    }
    if air.cover_left_on:
        found.append(SetFault("cover left on", "cover", 0.0, FOREVER))
    reversed_ = air.kind == "differential" and air.differential.polarity == "reversed"
    if air.swapped_tubes or reversed_:
        found.append(SetFault("tubes swapped", "swap", 0.0, FOREVER))
    for place, of_place in faults.items():
        for fault in of_place:
            name, noun = f"{place} {PARTICIPLES.get(fault.kind, fault.kind)}", NOUNS.get(fault.kind, fault.kind)
            found.append(SetFault(name, noun, fault.start, fault.stop))
    return sorted(found, key=lambda fault: fault.start)
