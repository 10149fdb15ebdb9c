"""What a campaign will take, before it flies."""

from uavsim.scenario import Scenario

STEP_BYTES = 215.0  # of a kept flight a step of the plant, its truth compressed; measured on `catapult`, see below
READING_BYTES = 25.0  # and a reading of the accelerometer


def flight_bytes(scenario: Scenario) -> float:
    """Return about how many bytes a kept flight takes on the disk.

    A whole `catapult` (35 s at 1 kHz) takes 8.3 MB without its plots: `du -sb` of its folder over its steps.
    """
    rate = scenario.accelerometer.description().rate
    return scenario.duration * (STEP_BYTES * scenario.plant.step_rate + READING_BYTES * rate)
