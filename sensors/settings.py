"""What a scenario may choose about the sensors.

Parts, rates, assumptions about each of their errors, where they sit, vibration, the ports and tubes before the pressure
sensors, and what breaks when: plain frozen dataclasses with bounds; whoever reads a file checks it against them.
"""

from dataclasses import dataclass, field, replace
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Interval

from sensors import catalogue
from sensors.accelerometer_description import AccelerometerDescription, AccelerometerErrors
from sensors.differential_description import DifferentialDescription
from sensors.pressure_description import PressureDescription, PressureErrors
from sensors.unit import Unit

Tare = Literal["covered", "open", "none"]
Phase = Literal["always", "waiting", "stroke", "flight"]
Band = Annotated[float, Interval(gt=0.0, lt=500.0)]  # Hz, below half of the plant's 1 kHz
Angle = Annotated[float, Interval(ge=-360.0, le=360.0)]  # degrees
Time = Annotated[float, Interval(ge=0.0, le=3600.0)]  # s
Height = Annotated[float, Interval(ge=-5000.0, le=11000.0)]  # m, pressure height below the tropopause
Arm = Annotated[float, Interval(ge=-10.0, le=10.0)]  # m
Vector = tuple[float, float, float]
Amplitude = Annotated[float, Interval(ge=-1000.0, le=1000.0)]  # g; nothing that flies shakes more
Density = Annotated[float, Interval(gt=0.0, le=1000.0)]  # g²/Hz, 700 g rms over the plant's 500 Hz
Offset = Annotated[float, Interval(ge=-10_000.0, le=10_000.0)]  # m/s², 1000 g
FOREVER = 3600.0  # s, the longest flight

AFT, DOWN = (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)  # tubes from the total and the static port to their sensors
FORWARD = (1.0, 0.0, 0.0)  # normal of the total sensor's membrane; DOWN is the static sensor's (the published head)


@dataclass(frozen=True, slots=True)
class Tone:
    """A sinusoidal vibration, of the motor, the carriage or the structure.

    Attributes
    ----------
    frequency_hz : float
        Hz.
    amplitude_g : (x, y, z)
        Peak on each body axis, g.
    phase_deg : float
        Phase at time 0, degrees; the three axes are in step.
    when : str
        In which phase of the flight it is there: "waiting", "stroke", "flight" or "always".
    """

    frequency_hz: Band
    amplitude_g: tuple[Amplitude, Amplitude, Amplitude]
    phase_deg: Angle = 0.0
    when: Phase = "always"


@dataclass(frozen=True, slots=True)
class Spectrum:
    """A random vibration of a given power spectral density, alike and independent on each axis.

    Attributes
    ----------
    psd : list of (frequency, density)
        One-sided density, g²/Hz, at rising frequencies, Hz; straight lines in log-log between them, nothing outside.
    when : str
        In which phase of the flight it is there: "waiting", "stroke", "flight" or "always".
    """

    psd: tuple[tuple[Band, Density], ...]
    when: Phase = "always"


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
    tones : list of groups
        Sinusoids beside that.
    spectra : list of groups
        Random vibration of a given power spectral density beside that.
    """

    waiting_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.05
    stroke_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.3
    flight_rms_g: Annotated[float, Interval(ge=0.0, le=50.0)] = 0.05
    band_hz: tuple[Band, Band] = (5.0, 200.0)
    ring_hz: Annotated[float, Interval(gt=0.0, le=10000.0)] = 120.0
    ring_fraction: Annotated[float, Interval(ge=0.0, le=5.0)] = 0.3
    ring_decay: Annotated[float, Interval(gt=0.0, le=10.0)] = 0.05
    tones: tuple[Tone, ...] = ()
    spectra: tuple[Spectrum, ...] = ()


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that goes wrong with a sensor between two times.

    Attributes
    ----------
    kind : str
        "dropout": no reading comes; "invalid": a reading comes and is NaN; "stuck": the last value before it is
        repeated; "dead": every reading is `size`; "spike": `size` of either sign is added; "offset": `size` is added.
    start, stop : float
        Readings with start ≤ t < stop are concerned, s.
    probability : float
        Share of those readings that is hit, each by itself; a stuck or dead value and an offset are there throughout.
    size : float
        Of a spike or an offset, or what a dead sensor says, in the sensor's unit (m/s², Pa, K).
    axis : str
        Which axis of an accelerometer: "x", "y", "z" or "all"; without meaning for a pressure sensor.
    """

    kind: Literal["dropout", "invalid", "stuck", "dead", "spike", "offset"]
    start: Time = 0.0
    stop: Time = FOREVER
    probability: Annotated[float, Interval(ge=0.0, le=1.0)] = 1.0
    size: Annotated[float, Interval(ge=-1e6, le=1e6)] = 0.0
    axis: Literal["x", "y", "z", "all"] = "all"


@dataclass(frozen=True, slots=True)
class ThermalSettings:
    """How warm a die is: it follows the air with a lag and heats itself.

    Attributes
    ----------
    self_heating : float
        How far it settles above the air, K. No datasheet gives it; a few kelvin are usual on a board.
    lag : float
        Time constant, s.
    powered_for : float
        How long it has been switched on at time 0, s; before that it had the temperature of the air.
    """

    self_heating: Annotated[float, Interval(ge=0.0, le=60.0)] = 0.0
    lag: Annotated[float, Interval(gt=0.0, le=3600.0)] = 30.0
    powered_for: Annotated[float, Interval(ge=0.0, le=1e6)] = 600.0


@dataclass(frozen=True, slots=True)
class AccelerometerSettings:
    """The accelerometer that flies.

    Attributes
    ----------
    preset : str
        A shipped part, or the path of a TOML file of one's own.
    range_g : float or None
        Range, ±g; None is the part's default.
    rate : float or None
        Output rate, Hz; None is the part's default.
    filter : str or None
        The part's low-pass setting, by its name in the preset; None is the part's default.
    noise_scale : float
        Factor on the part's white noise, an assumption about the part: it holds for the unit and for the filter.
    bias : float or (x, y, z)
        Offset beside that of the drawn unit, m/s²; one number is for each axis.
    vibration_scale : float
        Factor on all vibration.
    unit : str
        Which unit flies: "random", drawn within the datasheet; "typical", off by one standard deviation; "ideal".
    errors : group
        Factors on the datasheet's other errors.
    mounting_deg : (roll, pitch, yaw)
        Attitude of the case in the airframe, degrees; known on board, where it is undone.
    mounting_error_deg : (roll, pitch, yaw)
        Attitude of the case beside that, degrees; not known on board.
    position : (x, y, z)
        Of the sensor from the aircraft's own place for it (its EYEPOINT), body axes, m.
    rate_error_percent : float
        Error of the output rate beside that of the drawn unit, %.
    jitter : float
        Standard deviation of the sampling instants about the clock's, s; time stamps carry it.
    delay : float
        Age of the signal at its time stamp, beside the lag of the low-pass, s.
    delay_jitter : float
        Standard deviation of that age from reading to reading, s; time stamps do not carry it.
    thermal : group
        Temperature of the die.
    faults : list of groups
        What breaks.
    """

    preset: str = "lsm6dso32"
    range_g: Annotated[float, Gt(0.0)] | None = None
    rate: Annotated[float, Gt(0.0)] | None = None
    noise_scale: Annotated[float, Interval(ge=0.0, le=1000.0)] = 1.0
    bias: Offset | tuple[Offset, Offset, Offset] = 0.0
    vibration_scale: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.0
    unit: Unit = "random"
    filter: str | None = None
    errors: AccelerometerErrors = field(default_factory=AccelerometerErrors)
    mounting_deg: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)
    mounting_error_deg: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)
    position: tuple[Arm, Arm, Arm] = (0.0, 0.0, 0.0)
    rate_error_percent: Annotated[float, Interval(ge=-20.0, le=20.0)] = 0.0
    jitter: Annotated[float, Interval(ge=0.0, le=0.1)] = 0.0
    delay: Annotated[float, Interval(ge=0.0, le=0.5)] = 0.0
    delay_jitter: Annotated[float, Interval(ge=0.0, le=0.1)] = 0.0
    thermal: ThermalSettings = field(default_factory=ThermalSettings)
    faults: tuple[Fault, ...] = ()

    def description(self) -> AccelerometerDescription:
        """Return the part as chosen, for the unit and for the filter; ValueError if there is none such."""
        part = catalogue.accelerometer(self.preset).select(range_g=self.range_g, rate=self.rate, filter=self.filter)
        return part.scaled(self.noise_scale, self.errors)


@dataclass(frozen=True, slots=True)
class PressureSettings:
    """One pressure sensor of the head.

    Attributes
    ----------
    preset : str
        A shipped part, or the path of a TOML file of one's own.
    mode : str or None
        Oversampling of pressure/temperature, "x1/x1"; None is the part's default.
    iir : int
        Coefficient of the part's digital filter, as its datasheet prints it; 0 is off.
    noise_scale : float
        Factor on the part's white noise, an assumption about the part: it holds for the unit and for the filter.
    offset_pa : float
        Offset beside that of the drawn unit, Pa.
    unit : str
        Which unit flies: "random", drawn within the datasheet; "typical", off by one standard deviation; "ideal".
    errors : group
        Factors on the datasheet's other errors.
    normal : (x, y, z) or None
        Normal of the membrane, body axes, along which it feels acceleration; None is (1, 0, 0) for the total and
        (0, 0, 1) for the static sensor, at right angles as on the published head.
    rate_error_percent : float
        Error of the oscillator beside that of the drawn unit, %.
    faults : list of groups
        What breaks.
    """

    preset: str = "bmp390"
    mode: str | None = None
    iir: Annotated[int, Ge(0)] = 0
    noise_scale: Annotated[float, Interval(ge=0.0, le=1000.0)] = 1.0
    offset_pa: Annotated[float, Interval(ge=-100000.0, le=100000.0)] = 0.0
    unit: Unit = "random"
    errors: PressureErrors = field(default_factory=PressureErrors)
    normal: Vector | None = None
    rate_error_percent: Annotated[float, Interval(ge=-20.0, le=20.0)] = 0.0
    faults: tuple[Fault, ...] = ()

    def description(self) -> PressureDescription:
        """Return the part as chosen, for the unit and for the filter; ValueError if there is none such."""
        part = catalogue.pressure_sensor(self.preset).select(mode=self.mode, iir=self.iir)
        return part.scaled(self.noise_scale, self.errors)


@dataclass(frozen=True, slots=True)
class DifferentialSettings:
    """The differential pressure sensor between the two ports of a head of that kind.

    Attributes
    ----------
    preset : str
        A shipped part, or the path of a TOML file of one's own.
    mode : str or None
        One of the part's modes; None is its default.
    polarity : {"normal", "reversed"}
        Which tube is on which port; reversed, the sensor reads p_s − p_t. Nothing on board knows it.
    noise_scale : float
        Factor on the part's white noise, an assumption about the part: it holds for the unit and for the filter.
    offset_pa : float
        Offset beside that of the drawn unit, Pa.
    unit : str
        Which unit flies: "random", drawn within the datasheet; "typical", off by one standard deviation; "ideal".
    errors : group
        Factors on the datasheet's other errors.
    normal : (x, y, z) or None
        Normal of the membrane, body axes, along which it feels acceleration; None is (1, 0, 0).
    rate_error_percent : float
        Error of the oscillator beside that of the drawn unit, %.
    faults : list of groups
        What breaks.
    """

    preset: str = "ms4525do"
    mode: str | None = None
    polarity: Literal["normal", "reversed"] = "normal"
    noise_scale: Annotated[float, Interval(ge=0.0, le=1000.0)] = 1.0
    offset_pa: Annotated[float, Interval(ge=-100000.0, le=100000.0)] = 0.0
    unit: Unit = "random"
    errors: PressureErrors = field(default_factory=PressureErrors)
    normal: Vector | None = None
    rate_error_percent: Annotated[float, Interval(ge=-20.0, le=20.0)] = 0.0
    faults: tuple[Fault, ...] = ()

    def description(self) -> DifferentialDescription:
        """Return the part as chosen, for the unit and for the filter; ValueError if there is none such."""
        part = catalogue.differential_sensor(self.preset).select(mode=self.mode)
        return part.scaled(self.noise_scale, self.errors)


@dataclass(frozen=True, slots=True)
class PortFault:
    """Something that goes wrong with a port between two times.

    Attributes
    ----------
    kind : str
        "blocked": closed, what is behind it keeps its pressure; "leak": air comes in from the bay through a hole, as in
        a torn tube; "ice": closes gradually over `duration` and stays shut until `stop`; "water": a plug of water in
        the tube.
    start, stop : float
        s.
    duration : float
        Time in which ice closes the port, s.
    time_constant : float
        With which the pressure behind the leak goes to that of the bay when the port is blocked, s.
    area : float
        Of the leak's hole over the tube's section: with the port open it says how much of the port's pressure is left
        at the sensor. 1 is a tube torn off; a slow leak is a pinhole, 0.
    water_length : float
        Length of the plug, m.
    below_temperature : float or None
        Temperature of the air below which ice grows, K; None is any. What has grown stays.
    between_heights : (low, high) or None
        Pressure heights of the standard atmosphere between which ice grows, m: a cloud; None is any.
    """

    kind: Literal["blocked", "leak", "ice", "water"]
    start: Time = 0.0
    stop: Time = FOREVER
    duration: Annotated[float, Interval(ge=1e-6, le=3600.0)] = 5.0
    time_constant: Annotated[float, Interval(ge=1e-6, le=3600.0)] = 1.0
    area: Annotated[float, Interval(ge=0.0, le=100.0)] = 1.0
    water_length: Annotated[float, Interval(ge=1e-6, le=1.0)] = 0.005
    below_temperature: Annotated[float, Interval(ge=150.0, le=400.0)] | None = None
    between_heights: tuple[Height, Height] | None = None

    @property
    def conditional(self) -> bool:
        """Whether it is ice that grows only in some air."""
        return self.kind == "ice" and not (self.below_temperature is None and self.between_heights is None)


@dataclass(frozen=True, slots=True)
class TubeSettings:
    """The tube from a port to its sensor.

    Attributes
    ----------
    length : float
        m; 0 is none, and then neither volume nor diameter matter.
    diameter : float
        Inner diameter, m.
    volume : float
        Of the cavity at the sensor, m³.
    direction : (x, y, z) or None
        From the port to the sensor, body axes, of any length; None is (-1, 0, 0), straight aft, for the total and
        (0, 0, 1), straight down, for the static port.
    """

    length: Annotated[float, Interval(ge=0.0, le=10.0)] = 0.0
    diameter: Annotated[float, Interval(ge=1e-4, le=0.05)] = 2e-3
    volume: Annotated[float, Interval(ge=1e-10, le=1e-3)] = 5e-8
    direction: Vector | None = None


@dataclass(frozen=True, slots=True)
class TotalPortSettings:
    """The total-pressure port.

    Attributes
    ----------
    probe : str
        "ideal": reads p_total at any angle; "plain", "bevelled" or "kiel": loses total pressure beyond its angle.
    slipstream : float
        Dynamic pressure at full throttle over the free one, less one: the part of the propeller's wake it stands in.
    tube : group
        From the port to its sensor.
    faults : list of groups
        What becomes of the port.
    """

    probe: Literal["ideal", "plain", "bevelled", "kiel"] = "plain"
    slipstream: Annotated[float, Interval(ge=-0.9, le=5.0)] = 0.0
    tube: TubeSettings = field(default_factory=TubeSettings)
    faults: tuple[PortFault, ...] = ()


@dataclass(frozen=True, slots=True)
class StaticPortSettings:
    """The static port and its position error, (p_read - p_s)/q_c = c0 + cα z + cαα z² + cββ y² + cM M².

    z = sin α cos β and y = sin β, at small angles α and β.

    Attributes
    ----------
    error : float
        c0. The default is a boom on the nose, one and a half diameters of the fuselage ahead of it: +0.02.
    error_alpha : float
        cα, 1/rad.
    error_alpha2 : float
        cαα, 1/rad². The default is of holes around a tube in cross-flow: 0.5 … 0.7 of the −1 of potential flow.
    error_beta2 : float
        cββ, 1/rad², as that.
    error_mach2 : float
        cM.
    slipstream : float
        Dynamic pressure at full throttle over the free one, less one: the part of the propeller's wake it stands in.
    tube : group
        From the port to its sensor.
    faults : list of groups
        What becomes of the port.
    """

    error: Annotated[float, Interval(ge=-1.0, le=1.0)] = 0.02
    error_alpha: Annotated[float, Interval(ge=-10.0, le=10.0)] = 0.0
    error_alpha2: Annotated[float, Interval(ge=-100.0, le=100.0)] = -0.55
    error_beta2: Annotated[float, Interval(ge=-100.0, le=100.0)] = -0.55
    error_mach2: Annotated[float, Interval(ge=-10.0, le=10.0)] = 0.0
    slipstream: Annotated[float, Interval(ge=-0.9, le=5.0)] = 0.0
    tube: TubeSettings = field(default_factory=TubeSettings)
    faults: tuple[PortFault, ...] = ()


@dataclass(frozen=True, slots=True)
class AirDataSettings:
    """The air-data head: two pressure sensors on one bus.

    Attributes
    ----------
    kind : {"absolute", "differential"}
        Two absolute sensors, total and static; or a differential one between the two ports and the static one. A row
        of the second kind has the same columns: its p_total is the static reading and the difference together.
    total, static : PressureSettings
        The first is not there in a head of kind "differential".
    differential : group
        The differential sensor; it is not there in a head of kind "absolute".
    total_port, static_port : group
        What is between the air and the two sensors.
    pipe : float
        Length of the metal pipes before both sensors, m, in place of the ports' own tubes; the published head has 0.05.
    port_faults : list of groups
        What becomes of both ports at once, beside the faults of each.
    swapped_tubes : bool
        Whether each port is connected to the other's sensor.
    cover_left_on : bool
        Whether a cover, tared under it or not, stays on the head for the whole flight.
    thermometer_faults : list of groups
        What breaks in the thermometer that is read; a dropout leaves its last value on the bus.
    batch : float
        Share of the variance of the offsets' temperature coefficients that both sensors have in common, being of one
        batch: 0 is none, and with 1 two equal parts drift alike.
    acceleration_sensitivity : bool
        Whether the membranes feel acceleration, as the presets say: an assumption, as no datasheet does.
    thermal : group
        Temperature of the dies, which the thermometer reads.
    rate : float
        Polls a second, Hz.
    tare : {"covered", "open", "none"}
        Whether the difference of the pair at rest is measured with the head covered, in the open wind, or not at all.
    tare_duration : float
        Length of the mean that the tare is, s.
    cover_off : float
        Time before release at which the tare ends and the cover, if there is one, is taken off, s.
    calibration : str
        What is known of both ports' errors. "unit": a calibration of this head found them, with an error of its own (a
        thousandth of the impact pressure, and a tenth of what each angle and the propeller make); what the filter knows
        is taken off. "none": nothing but their size is known. Or the path of a calibration's file, coefficients in
        TOML or a table in CSV: what it says is known, whatever the simulated ports do.
    thermometer_recovery : float
        Share r of the flow's warming that the thermometer feels, T (1 + 0.2 r M²): 0 inside a fuselage, 0.8 … 0.9 in
        the stream.
    position : (x, y, z)
        Of the head from the aircraft's EYEPOINT, body axes, m; its pressures come from the flow there. This is the tube
        on the nose of fw8. A rig has its head where the stream is.
    """

    kind: Literal["absolute", "differential"] = "absolute"
    total: PressureSettings = field(default_factory=PressureSettings)
    static: PressureSettings = field(default_factory=PressureSettings)
    differential: DifferentialSettings = field(default_factory=DifferentialSettings)
    rate: Annotated[float, Interval(gt=0.0, le=1000.0)] = 100.0
    tare: Tare = "covered"
    tare_duration: Annotated[float, Interval(gt=0.0, le=60.0)] = 1.0
    cover_off: Annotated[float, Interval(ge=0.0, le=60.0)] = 0.5
    total_port: TotalPortSettings = field(default_factory=TotalPortSettings)
    static_port: StaticPortSettings = field(default_factory=StaticPortSettings)
    pipe: Annotated[float, Interval(ge=0.0, le=10.0)] = 0.0
    port_faults: tuple[PortFault, ...] = ()
    swapped_tubes: bool = False
    cover_left_on: bool = False
    thermometer_faults: tuple[Fault, ...] = ()
    batch: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    position: tuple[Arm, Arm, Arm] = (0.65, 0.0, 0.0)
    calibration: str = "unit"
    thermometer_recovery: Annotated[float, Interval(ge=0.0, le=1.0)] = 0.0
    acceleration_sensitivity: bool = False
    thermal: ThermalSettings = field(default_factory=ThermalSettings)

    def sensors(self) -> tuple[PressureSettings | DifferentialSettings, PressureSettings]:
        """Return what reads the total channel, the total or the differential sensor, and the static sensor."""
        return (self.differential if self.kind == "differential" else self.total), self.static

    def tubes(self) -> tuple[tuple[TubeSettings, Vector], tuple[TubeSettings, Vector]]:
        """Return the tubes of the total and the static port as they are built, each with its direction."""

        def built(tube: TubeSettings, usual: Vector) -> tuple[TubeSettings, Vector]:
            tube = replace(tube, length=self.pipe) if self.pipe > 0.0 else tube
            return tube, usual if tube.direction is None else tube.direction

        return built(self.total_port.tube, AFT), built(self.static_port.tube, DOWN)

    def normals(self) -> tuple[Vector, Vector]:
        """Return the normals of both sensors' membranes, as of `sensors`, body axes, of any length."""
        total, static = (sensor.normal for sensor in self.sensors())
        return FORWARD if total is None else total, DOWN if static is None else static
