"""What a scenario makes go wrong with a sensor, and what was found of it on board: a fault's kind, place and times."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

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
    found = []
    air = scenario.air_data
    faults: dict[str, Sequence[Fault | PortFault]] = {
        "total port": air.total_port.faults,
        "static port": air.static_port.faults,
        "total sensor": air.total.faults,
        "differential sensor": air.differential.faults,
        "static sensor": air.static.faults,
        "accelerometer": scenario.accelerometer.faults,
    }
    for place, of_place in faults.items():
        for fault in of_place:
            name, noun = f"{place} {PARTICIPLES.get(fault.kind, fault.kind)}", NOUNS.get(fault.kind, fault.kind)
            found.append(SetFault(name, noun, fault.start, fault.stop))
    return sorted(found, key=lambda fault: fault.start)


def told(scenario: "Scenario", end: float) -> str:
    """Return the faults in words, as "total port blocked from 12 s to 20 s"; `end` of the flight, s."""
    words = []
    for fault in set_faults(scenario):
        until = f" to {fault.stop:g} s" if fault.stop < end else ""
        beyond = f", after the end at {end:g} s" if fault.start >= end else ""
        words.append(f"{fault.name} from {fault.start:g} s{until}{beyond}")
    return ", ".join(words)


def noticed(event: dict[str, Any]) -> str:
    """Return an event of the airspeed's watch in words, as "total flagged"; nothing of any other event."""
    channel = event.get("channel", "")
    return {
        "airspeed_fault": f"{channel} flagged",
        "airspeed_recovered": f"{channel} trusted again",
        "airspeed_lost": "airspeed given up",
        "airspeed_back": "airspeed back",
    }.get(event["event"], "")
