"""Tables and functions that JSBSim's engines and thrusters take for there, without a look: what they are called."""

from uavsim.plants.airframe.markup import Element, MarkupError
from uavsim.plants.airframe.tables import number

_NEEDED = {
    "propeller": ("C_THRUST", "C_POWER"),
    "turbine_engine": ("IdleThrust", "MilThrust"),
    "turboprop_engine": ("EnginePowerVC", "EnginePowerRPM_N1", "ITT_N1"),
}
_ALSO = {("turbine_engine", "augmented"): "AugThrust", ("turbine_engine", "injected"): "Injection"}
"""What is needed besides where a switch is on."""


def check_feeds(propulsion: Element) -> None:
    """Refuse an engine that is fed by a tank that is not there."""
    tanks = sum(child.tag == "tank" for child in propulsion.children)
    for engine in propulsion.children:
        for feed in engine.children:
            if feed.tag == "feed" and int(feed.text) >= tanks:
                raise MarkupError(
                    f"<feed>: there is no tank {feed.text}; there are {tanks}, numbered from 0", feed.line
                )


def check_engine(root: Element) -> None:
    """Refuse an engine or a thruster that lacks one."""
    held = {child.attributes.get("name") for child in root.children if child.tag in {"table", "function"}}
    needed = list(_NEEDED.get(root.tag, ()))
    for (tag, switch), name in _ALSO.items():
        if tag == root.tag and (element := root.find(switch)) is not None and number(element.text) != 0.0:
            needed.append(name)
    for name in needed:
        if name not in held:
            raise MarkupError(f"<{root.tag}>: needs the table or function {name!r}", root.line)
