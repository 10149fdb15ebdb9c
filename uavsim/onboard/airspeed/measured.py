"""Between which values a reading of the head is a measurement, by its parts' descriptions and by what is plausible.

A pressure at an end of its sensor's range, or less than half a step from it, has been clipped: the true one may be
anything beyond. A temperature beyond its range is none.
"""

from uavsim.onboard.airspeed.difference import channel_range
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.plausible import LEAST_PRESSURE, LEAST_TEMPERATURE, MOST_PRESSURE, MOST_TEMPERATURE

Ends = tuple[float, float]


def limits(noise: NoiseModel) -> tuple[Ends, Ends, Ends]:
    """Return the ends of the total channel and the static pressure, Pa, and of the temperature, K.

    A pressure at an end is no measurement; a temperature there is one.
    """
    return (
        _within(channel_range(noise), noise.total_step, LEAST_PRESSURE, MOST_PRESSURE),
        _within(noise.static_range, noise.static_step, LEAST_PRESSURE, MOST_PRESSURE),
        _within(noise.temperature_range, 0.0, LEAST_TEMPERATURE, MOST_TEMPERATURE),
    )


def _within(ends: Ends, step: float, least: float, most: float) -> Ends:
    return max(least, ends[0] + 0.5 * step), min(most, ends[1] - 0.5 * step)
