"""What an airspeed estimator may believe of its sensors; what it takes and gives is in `uavsim.onboard.interface`.

Whatever the readings, a step of ours returns. A value outside the bounds of `uavsim.onboard.plausible` is a missing
one, and no estimate outside them is valid; which readings are left out for their time stamps is said in
`uavsim.onboard.stamps`.
"""

from dataclasses import dataclass
from math import inf
from typing import Annotated

from annotated_types import Ge, Interval

from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.plausible import LEAST_TEMPERATURE, MOST_TEMPERATURE

ANY = (-inf, inf)  # a range without ends
MODEL = 0.1  # Pa, the least standard deviation of a reading: what the model is off by, 0.1 ms of the stroke's rise
NO_ERRORS = HeadErrors()  # both ports read their own pressures


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """What the estimator believes of its sensors: standard deviations of one reading, and what is known of their lag.

    The first five are all that the filters of the pressures alone need; the aided filter uses the others.

    Attributes
    ----------
    total_sd, static_sd : float
        Of the two pressures, Pa.
    temperature_sd : float
        Of the temperature, K; its turn-on error included.
    total_tuned_sd, static_tuned_sd : float or None
        Those that the filters' gains were chosen for, Pa; None: the same as are believed.
    total_window, static_window : float
        Length of a conversion, s: the reading is the mean over it.
    total_lag, static_lag : float
        Age of the pressure at the sensor, s: that of port and tube.
    acceleration : float
        Pressure error of p_t − p_s for specific force along body x, as far as it is known, Pa/(m/s²).
    acceleration_sd : float
        Standard deviation of what is not known of it, Pa/(m/s²).
    walk : float
        Random walk of the pair's difference since the tare, Pa/√s.
    accelerometer_sd : float
        White noise of one reading of f_x, vibration included, m/s².
    accelerometer_scale_sd : float
        Scale error of the accelerometer.
    accelerometer_offset_sd : float
        Offset of f_x, constant in a flight, m/s².
    lift_offset_sd : float
        The same of f_z, m/s².
    accelerometer_rate : float
        Its output rate, Hz.
    accelerometer_lag : float
        Age of a reading of specific force at its time stamp, s.
    head_rate : float
        Readings of the head a second, Hz: which of their time stamps are believed.
    total_range, static_range : tuple of float
        Pa: a pressure at or beyond an end is no measurement.
    total_step, static_step : float
        By which they are rounded, Pa.
    temperature_range : tuple of float
        K: a temperature beyond it is no measurement.
    temperature_white_sd, temperature_step, temperature_lag : float
        Noise of one reading of the thermometer, rounding included, K; by which it is rounded, K; the time constant of
        its digital filter, s.
    accelerometer_range : tuple of float
        m/s²: a specific force at or beyond an end has been clipped.
    accelerometer_step : float
        By which it is rounded, m/s².
    accelerometer_white_sd : float
        White noise of one reading of f_x by the part alone, without vibration, m/s²: a live part has at least that.
    side_offset_sd : float
        Offset of f_y, m/s².
    own_offset_sd, own_side_offset_sd, own_lift_offset_sd : float
        Offsets that the part's description allows, m/s²; one that is four times as large is told.
    accelerometer_wander_sd : float
        By how much an offset that was found on the rail may have moved since, m/s².
    rail_elevation : float or None
        Of the rail as the crew believes it, rad; None: not known, or there is no rail.
    rail_elevation_sd : float
        How well it is known, rad; so is the roll.
    rail_roll : float
        Roll of the aircraft on it, rad.
    difference_sd : float
        What the pair's difference may be at rest where no tare has found it, Pa.
    static_offset_sd : float
        What both pressures are off by together, Pa: the tare does not find it, and the density has it.
    covered : bool
        Whether the head is under its cover in the tare's window; else the tare is taken in the wind.
    head : HeadErrors
        What the ports are off by, as a calibration knows it.
    thermometer_recovery, thermometer_recovery_sd : float
        Share r of the flow's warming that the thermometer reads, T (1 + 0.2 r M²), and its standard deviation.
    die_lag : float
        With which the thermometer follows the air, s.
    differential : bool
        Whether the total pressure is the sum of the static one and of a difference that one sensor reads. Then
        `total_sd`, `total_range` and `total_step` are those of the difference.
    difference_scale_sd : float
        Scale error of what flight adds to the difference of both pressures, a fraction.
    """

    total_sd: Annotated[float, Ge(0.0)]
    static_sd: Annotated[float, Ge(0.0)]
    temperature_sd: Annotated[float, Ge(0.0)]
    total_tuned_sd: Annotated[float, Ge(0.0)] | None = None
    static_tuned_sd: Annotated[float, Ge(0.0)] | None = None
    total_window: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    static_window: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    total_lag: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    static_lag: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    acceleration: Annotated[float, Interval(ge=-100.0, le=100.0)] = 0.0
    acceleration_sd: Annotated[float, Interval(ge=0.0, le=100.0)] = 0.0
    walk: Annotated[float, Interval(ge=0.0, le=100.0)] = 0.007
    accelerometer_sd: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.0
    accelerometer_scale_sd: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.005
    accelerometer_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    lift_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    accelerometer_rate: Annotated[float, Interval(gt=0.0, le=100_000.0)] = 1000.0
    accelerometer_lag: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    head_rate: Annotated[float, Interval(gt=0.0, le=100_000.0)] = 100.0
    total_range: tuple[float, float] = ANY
    static_range: tuple[float, float] = ANY
    total_step: Annotated[float, Ge(0.0)] = 0.0
    static_step: Annotated[float, Ge(0.0)] = 0.0
    temperature_range: tuple[float, float] = (LEAST_TEMPERATURE, MOST_TEMPERATURE)
    temperature_white_sd: Annotated[float, Ge(0.0)] = 0.0
    temperature_step: Annotated[float, Ge(0.0)] = 0.0
    temperature_lag: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    accelerometer_range: tuple[float, float] = ANY
    accelerometer_step: Annotated[float, Ge(0.0)] = 0.0
    accelerometer_white_sd: Annotated[float, Ge(0.0)] = 0.0
    side_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    own_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    own_side_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    own_lift_offset_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    accelerometer_wander_sd: Annotated[float, Interval(ge=0.0, le=100_000.0)] = 0.0
    rail_elevation: Annotated[float, Interval(ge=-1.6, le=1.6)] | None = None
    rail_elevation_sd: Annotated[float, Interval(ge=0.0, le=1.6)] = 0.0087
    rail_roll: Annotated[float, Interval(ge=-3.2, le=3.2)] = 0.0
    difference_sd: Annotated[float, Ge(0.0)] = 0.0
    static_offset_sd: Annotated[float, Ge(0.0)] = 0.0
    covered: bool = True
    head: HeadErrors = NO_ERRORS
    thermometer_recovery: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    thermometer_recovery_sd: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    die_lag: Annotated[float, Interval(ge=0.0, le=3600.0)] = 0.0
    differential: bool = False
    difference_scale_sd: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0

    @property
    def total_age(self) -> float:
        """From the instant of which a reading of the total channel is to the end of its conversion, s."""
        return 0.5 * self.total_window + self.total_lag

    @property
    def static_age(self) -> float:
        """The same of the static pressure, s."""
        return 0.5 * self.static_window + self.static_lag


def reading_variances(noise: NoiseModel) -> tuple[float, float]:
    """Return those of a reading of the total channel and of the static pressure, Pa², as the aided filter has them."""
    return max(noise.total_sd, MODEL) ** 2, max(noise.static_sd, MODEL) ** 2


def pair_variance(noise: NoiseModel) -> float:
    """Return the variance of one reading's pressure difference, Pa²; a differential sensor reads it itself."""
    total, static = reading_variances(noise)
    return total + (0.0 if noise.differential else static)
