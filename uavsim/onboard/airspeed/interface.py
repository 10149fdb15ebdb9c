"""What every airspeed estimator takes, gives and believes of its sensors.

A reading of the head is (t, p_total, p_static, temperature, t_total, t_static): Pa and K, the time of the reading and
the ends of the two conversions that it carries, s. A reading of specific force is (t, f_x, f_y, f_z), m/s², body axes.
An estimator that goes by the pressures alone takes readings of specific force, too, and leaves them aside, so that one
flight computer serves all kinds.

Whatever the readings, a step returns. A value outside the bounds of `uavsim.onboard.plausible` is a missing one, and no
estimate outside them is valid; which readings are left out for their time stamps is said in `uavsim.onboard.stamps`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Protocol

from annotated_types import Ge, Interval

Estimate = tuple[float, float, float, float, float, float, bool, float, float]
"""t s, airspeed, airspeed_sd, airspeed_raw m/s, p_total (tared), p_static Pa, valid, nis_total, nis_static."""
Feel = Callable[[float, float, float, float], None]
"""Takes a reading of specific force: t, f_x, f_y, f_z."""
TareWindow = tuple[float, float]
"""Readings with start < t ≤ end, s, are under the cover."""


class Estimator(Protocol):
    """What the flight computer asks of an airspeed estimator."""

    @property
    def aided(self) -> bool:
        """Whether it wants the readings of specific force."""

    def step(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head and say what is known after it; None if it is left out for its stamp."""

    @property
    def accelerometer(self) -> Feel:
        """What takes a reading of specific force at present, in the order of the time stamps with those of the head.

        A method does. What it was before a launch was recognised serves afterwards, too, if more slowly.
        """

    def tidy(self) -> None:
        """Do what can wait until the estimate has been told; without it, it is done at the next reading of the head."""

    def launched(self, t: float) -> None:
        """Be told that a launch has been recognised at `t`, s, with the reading of specific force taken last."""

    def rearmed(self, t: float) -> None:
        """Be told that it was none and that the aircraft sits on its rail again."""

    def unfolding(self, t: float) -> None:
        """Be told that the wings have been commanded out at `t`, s: masses that move push the accelerometer about."""


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
