"""Which keys nothing reads, as the chosen kinds of plant, detector and estimator say it."""

from typing import Any

from uavsim.onboard.airspeed.kinds import KINDS as ESTIMATORS
from uavsim.onboard.airspeed.kinds import is_aided
from uavsim.onboard.launch.settings import if_known

OF_EVERY_RUN = ("launcher.wait_min", "launcher.wait_max", "launcher.height")
IN_THE_AIR = ("wind", "turbulence", "gust", "roughness")  # what keys of the environment begin with that moves the air


def unread(scenario: Any, key: str) -> str:
    """Say why nothing reads a key of a scenario; nothing if something does."""
    group, _, rest = key.partition(".")
    name = rest.partition(".")[0].partition("[")[0]
    why = {"plant": _plant, "aircraft": _flown, "launcher": _flown, "environment": _flown,
           "detector": _detector, "estimator": _estimator}.get(group)  # fmt: skip
    return why(scenario, key, name) if why else ""


def _plant(scenario: Any, _: str, name: str) -> str:
    chosen = scenario.plant.chosen
    if name in ("kind", "step_rate", chosen.group):
        return ""
    return f"is not read by plant.kind = {chosen.name!r}"


def _flown(scenario: Any, key: str, name: str) -> str:
    chosen = scenario.plant.chosen
    if chosen.flies or not chosen.ours or key in OF_EVERY_RUN:
        return ""
    if key.startswith("environment.") and (chosen.air or not name.startswith(IN_THE_AIR)):
        return ""
    if key.startswith("launcher.") and name in chosen.launcher:
        return ""
    return f"is not read by plant.kind = {chosen.name!r}, a rig"


def _detector(scenario: Any, _: str, name: str) -> str:
    kind = if_known(scenario.detector)
    if name in ("kind", "axes", *kind.reads):
        return ""
    return f"is not read by detector.kind = {kind.name!r}, which reads {', '.join((*kind.reads, 'axes'))}"


def _estimator(scenario: Any, _: str, name: str) -> str:
    kind = scenario.estimator.kind
    known = ESTIMATORS.get(kind)
    if name == "kind" or known is None:
        return ""
    if not known.ours and name != "options":
        return f"is not read by estimator.kind = {kind!r}, which is not ours and reads its options"
    if name == "aided" and not is_aided(kind):
        return f"is not read by estimator.kind = {kind!r}"
    return ""
