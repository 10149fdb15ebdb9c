"""In words: what a scenario makes go wrong with a sensor, and what was found of it on board."""

from typing import TYPE_CHECKING, Any

from uavsim.set_faults import set_faults

if TYPE_CHECKING:
    from uavsim.scenario import Scenario


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
