"""Names of the outcomes and of the numbers that a score holds, group by group, in its order."""

from typing import Literal

Outcome = Literal[
    "cruise", "missed_launch", "false_launch", "crashed", "landed", "diverged", "onboard_failed", "timeout",
    "completed",
]  # fmt: skip

PHASES = ("stroke", "transition", "cruise")
LAUNCH = (
    *("release_time", "true_time", "crossing_time", "detected_time", "latency", "latency_from_crossing"),
    *("detections", "false_detections"),
)
AIRSPEED = (
    *("rmse", "rmse_raw", "reduction_percent", "bias", "max_error", "nees_mean"),
    *("coverage_95", "coverage_1_sigma", "coverage_2_sigma", "coverage_3_sigma", "valid_fraction", "samples"),
    *("nis_mean", "whiteness"),
)
SPEEDS = ("calibrated", "equivalent")
OF_SPEED = ("rmse", "bias", "max_error")
INTEGRITY = ("flags", "false_flags", "losses", "hazard", "hazard_time")
PRESSURE = ("rmse", "rmse_raw", "reduction_percent", "bias", "nis_mean")
PRESSURES = ("total", "static")
FLIGHT = (
    "ready",
    *("rail_exit_time", "rail_exit_speed", "wing_start_time", "wing_out_time"),
    *("cruise_airspeed", "cruise_airspeed_sd", "duration", "rail_exit_altitude", "lowest_altitude_after_exit"),
)
INSTALLATION = ("calibrated_airspeed", "error", "over_limit")

NUMBERS = (
    "seed",
    *(f"launch.{name}" for name in LAUNCH),
    *(f"airspeed.{name}" for name in (*AIRSPEED, *INTEGRITY)),
    *(f"airspeed.{speed}.{name}" for speed in SPEEDS for name in OF_SPEED),
    *(f"airspeed.{phase}.{name}" for phase in PHASES for name in AIRSPEED),
    *(f"airspeed.{phase}.{speed}.{name}" for phase in PHASES for speed in SPEEDS for name in OF_SPEED),
    *(f"pressure.{channel}.{name}" for channel in PRESSURES for name in PRESSURE),
    *(f"flight.{name}" for name in FLIGHT),
    *(f"installation.{name}" for name in INSTALLATION),
)
"""Each by its key, joined by dots."""


def no_airspeed() -> dict[str, object]:
    """Return the figures of an airspeed of which nothing is known, with their names."""
    return {**dict.fromkeys(AIRSPEED), **{speed: dict.fromkeys(OF_SPEED) for speed in SPEEDS}}
