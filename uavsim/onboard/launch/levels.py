"""What rules with the threshold G2, a trigger G1 and a window say of their settings."""

from typing import TYPE_CHECKING

from uavsim.onboard.launch.kinds import Need

if TYPE_CHECKING:
    from uavsim.onboard.launch.settings import DetectorSettings


def above(settings: "DetectorSettings", _: float) -> Need:
    """What exceeds the threshold for the window's length."""
    return Need("threshold", settings.threshold, "window", settings.window)


def above_trigger(settings: "DetectorSettings", push: float) -> Need:
    """What exceeds the trigger first, if there is one of its own."""
    if settings.trigger is None:
        return above(settings, push)
    return Need("trigger", settings.trigger, "window", settings.window)


def line(settings: "DetectorSettings") -> dict[str, float]:
    """The threshold, m/s²."""
    return {"level": settings.threshold}


def lines_of(settings: "DetectorSettings") -> dict[str, float]:
    """Trigger and threshold, m/s²."""
    trigger = settings.threshold if settings.trigger is None else settings.trigger
    if trigger == settings.threshold:
        return {"$G_1$ = $G_2$": trigger}
    return {"$G_1$": trigger, "$G_2$": settings.threshold}
