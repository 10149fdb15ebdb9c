"""What a scenario may choose about the sensors.

Parts, rates, assumptions about their noise and offsets, vibration, and how the air-data head is tared: plain frozen
dataclasses with bounds; whoever reads a file checks it against them.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Interval

from sensors import catalogue
from sensors.description import AccelerometerDescription, PressureDescription

Tare = Literal["covered", "open", "none"]
Band = Annotated[float, Interval(gt=0.0, lt=500.0)]  # Hz, below half of the plant's 1 kHz


@dataclass(frozen=True, slots=True)
class VibrationSettings:
    """What the airframe shakes with, at the accelerometer.

    Attributes
    ----------
    waiting_rms_g : float
        Rms on each axis until release, g.
    stroke_rms_g : float
        Rms on each axis from there to the end of the rail, g.
    flight_rms_g : float
        Rms on each axis in flight, g.
    band_hz : (float, float)
        Band that the noise lies in, Hz.
    ring_hz : float
        Frequency at which the push makes the airframe ring along body x, Hz.
    ring_fraction : float
        Amplitude that the ring grows to while the push rises, as a fraction of the push's plateau.
    ring_decay : float
        Time in which it decays to 1/e from there, s.
    """

    waiting_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.05
    stroke_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.3
    flight_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.05
    band_hz: tuple[Band, Band] = (5.0, 200.0)
    ring_hz: Annotated[float, Interval(gt=0.0, le=10000.0)] = 120.0
    ring_fraction: Annotated[float, Interval(ge=0.0, le=5.0)] = 0.3
    ring_decay: Annotated[float, Interval(gt=0.0, le=10.0)] = 0.05


@dataclass(frozen=True, slots=True)
class AccelerometerSettings:
    """The accelerometer that flies.

    Attributes
    ----------
    preset : str
        A shipped part.
    range_g : float or None
        Range, ±g; None is the part's default.
    rate : float or None
        Output rate, Hz; None is the part's default.
    noise_scale : float
        Factor on the part's white noise, an assumption about the part: it holds for the unit and for the filter.
    bias : float or (x, y, z)
        Offset beside that of the drawn unit, m/s²; one number is for each axis.
    vibration_scale : float
        Factor on all vibration.
    """

    preset: str = "lsm6dso32"
    range_g: Annotated[float, Gt(0.0)] | None = None
    rate: Annotated[float, Gt(0.0)] | None = None
    noise_scale: Annotated[float, Interval(ge=0.0, le=1000.0)] = 1.0
    bias: float | tuple[float, float, float] = 0.0
    vibration_scale: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.0

    def description(self) -> AccelerometerDescription:
        """Return the part as chosen, for the unit and for the filter; ValueError if there is none such."""
        part = catalogue.accelerometer(self.preset).select(range_g=self.range_g, rate=self.rate)
        return part.scaled(self.noise_scale)


@dataclass(frozen=True, slots=True)
class PressureSettings:
    """One pressure sensor of the head.

    Attributes
    ----------
    preset : str
        A shipped part.
    mode : str or None
        Oversampling of pressure/temperature, "x1/x1"; None is the part's default.
    iir : int
        Coefficient of the part's digital filter, as its datasheet prints it; 0 is off.
    noise_scale : float
        Factor on the part's white noise, an assumption about the part: it holds for the unit and for the filter.
    offset_pa : float
        Offset beside that of the drawn unit, Pa.
    """

    preset: str = "bmp390"
    mode: str | None = None
    iir: Annotated[int, Ge(0)] = 0
    noise_scale: Annotated[float, Interval(ge=0.0, le=1000.0)] = 1.0
    offset_pa: Annotated[float, Interval(ge=-100000.0, le=100000.0)] = 0.0

    def description(self) -> PressureDescription:
        """Return the part as chosen, for the unit and for the filter; ValueError if there is none such."""
        part = catalogue.pressure_sensor(self.preset).select(mode=self.mode, iir=self.iir)
        return part.scaled(self.noise_scale)


@dataclass(frozen=True, slots=True)
class AirDataSettings:
    """The air-data head: a total and a static pressure sensor on one bus.

    Attributes
    ----------
    total, static : PressureSettings
    rate : float
        Polls a second, Hz.
    tare : {"covered", "open", "none"}
        Whether the difference of the pair at rest is measured with the head covered, in the open wind, or not at all.
    tare_duration : float
        Length of the mean that the tare is, s.
    cover_off : float
        Time before release at which the tare ends and the cover, if there is one, is taken off, s.
    """

    total: PressureSettings = field(default_factory=PressureSettings)
    static: PressureSettings = field(default_factory=PressureSettings)
    rate: Annotated[float, Interval(gt=0.0, le=1000.0)] = 100.0
    tare: Tare = "covered"
    tare_duration: Annotated[float, Interval(gt=0.0, le=60.0)] = 1.0
    cover_off: Annotated[float, Interval(ge=0.0, le=60.0)] = 0.5
