"""The air-data head: a total and a static pressure sensor, polled by one bus.

        cover  port              tube    membrane    sensor, own clock        bus, every 1/rate
    p_t ──╂─── probe ─────────── line ── + n·f ───── total ── conversion ──┐
    p_s ──╂─┬─ position error ── line ── + n·f ───── static ─ conversion ──┴── (t, p_total, p_static, T, t_total,
            └─ bay                                   thermometer                t_static)

A head of kind "differential" has a differential sensor between the two lines in the place of the total sensor; what it
makes of p_t − p_s is in `sensors.differential`. Its row has the same columns: p_total is the static reading plus the
difference's, and t_total the end of the difference's conversion. So whoever takes two pressures can take it, and
p_total − p_static is the difference as it was read. While the static sensor gives NaN, the difference stands on what it
gave last.

The sensors run freely, so the two values of a row are of different instants and as old as their clocks make them:
t_total and t_static are the ends of the conversions carried, and a value that is polled again has the same. Under the
cover both ports feel the static pressure, wind or not, for the whole flight if it is left on. Swapped tubes bring each
port's pressure to the other's sensor.

With no tube between the air and two sensors that do not feel acceleration, a conversion takes the truth, and what the
ports make of it, at the middle of its window, and only conversions that are polled ask for it (`full` is false; of a
plant that tells no `flow_at` any time, with ports that tell the truth alone). Otherwise the head must feel each
plant step (`feel`): ports, tubes and membranes are followed, and a conversion is the mean over its window of what is
felt, linear between plant steps and integrated exactly,

    z = 1/T ∫ p dt = 1/(x₁ - x₀) [Σ' p_i + F(x₁) - F(x₀)],   F(i + w) = w p_i + w²/2 (p_{i+1} - p_i)

with x in steps and Σ' the trapezoidal sum between whole steps: vibration on the membrane averages as it does in the
part, and a pressure that is no number spoils the windows it is in and no others.
"""

from math import inf, nan

from sensors.clock import Clock
from sensors.differential import Response, passing
from sensors.faults import value_faults
from sensors.pneumatics import Line
from sensors.pressure import PressureSensor
from sensors.probe import static_port, total_port
from sensors.settings import (
    AirDataSettings,
    DifferentialSettings,
    PortFault,
    PressureSettings,
    ThermalSettings,
    TubeSettings,
)
from sensors.streams import Streams
from sensors.surroundings import Air, Flow, Surroundings
from sensors.unit import Batch, Triple, Unit

Row = tuple[float, float, float, float, float, float]

NO_FLOW: Flow = (nan,) * 7  # until somebody says
NO_AIR: Air = (nan,) * 3
MOST_REMEMBERED = 4096  # steps: conversions are made at the latest when so many wait for a poll


class AirDataHead:
    """Two drawn units and the bus, stepped with the plant.

    Parameters
    ----------
    settings : AirDataSettings
    streams : Streams
        Streams "{name}.total. …" or "{name}.differential. …", "{name}.static. …" and "{name}.poll" are used.
    surroundings : Surroundings, optional
        The air; without it there is no number to read.
    dt : float
        Step of the plant, s; meets `feel` only.
    covered_until : float
        When the cover is taken off, s; -inf if it never was on.
    unit : {"random", "typical", "ideal"}, optional
        Turn-on errors of both sensors, as of `PressureSensor`, in place of their own settings'.
    name : str
        Prefix of its streams, for a second one.

    Attributes
    ----------
    full : bool
        Whether `feel` must be called each plant step.
    due : float
        Time of the next poll, s.
    total, static : PressureSensor
        The first is the differential one where the head is of that kind.
    covered_until : float
    surroundings : Surroundings or None
        Both may be set during a flight.

    Raises
    ------
    ValueError
        If a membrane's normal or a tube's direction has no length.
    """

    __slots__ = (
        "_dt", "_last_static", "_lines", "_membranes", "_next_poll", "_open", "_ports", "_recovery", "_response",
        "_settings", "_static_error", "_static_felt", "_static_truth", "_steps_per_second", "_t", "_temperature",
        "_thermometer", "_told_temperature", "_total_error", "_total_felt", "_total_truth", "covered_until", "due",
        "full", "static", "surroundings", "total",
    )  # fmt: skip

    def __init__(
        self,
        settings: AirDataSettings,
        streams: Streams,
        surroundings: Surroundings | None = None,
        *,
        dt: float = 1e-3,
        covered_until: float = -inf,
        unit: Unit | None = None,
        name: str = "air_data",
    ) -> None:
        self._settings = settings
        forward, down = settings.normals()
        alike = Batch.drawn(settings.batch, streams, f"{name}.batch")
        first, second = settings.sensors()
        self._response: Response | None = None
        if isinstance(first, DifferentialSettings):
            both = (tube for tube, _ in settings.tubes())
            self._response = Response(first.description(), both, reversed=first.polarity == "reversed")
        self._last_static = nan
        channel = "total" if self._response is None else "differential"
        self.total = _sensor(first, forward, settings.thermal, streams, unit, f"{name}.{channel}", alike)
        self.static = _sensor(second, down, settings.thermal, streams, unit, f"{name}.static", alike)
        self._thermometer = value_faults(settings.thermometer_faults, streams, f"{name}.thermometer")
        self._told_temperature = nan
        self.covered_until = inf if settings.cover_left_on else covered_until
        poll = Clock.drawn(settings.rate, streams(f"{name}.poll"))
        self.due, self._next_poll = poll.due, poll.later

        self.surroundings = surroundings
        self._dt, self._steps_per_second = dt, 1.0 / dt
        self._recovery = settings.thermometer_recovery
        self._total_error, self._static_error = total_port(settings.total_port), static_port(settings.static_port)
        self._total_felt: list[float] = []
        self._static_felt: list[float] = []
        self._t = self._temperature = nan
        self._lines: tuple[Line | None, Line | None] | None = self._connect(nan, nan)  # checks the directions, too
        self._open = (self._total_error, self._static_error, *self._lines) == (None,) * 4 and not settings.swapped_tubes
        felt = settings.acceleration_sensitivity
        self._membranes = (*self.total.acceleration, *self.static.acceleration) if felt else (0.0,) * 6
        ports = not (self._total_error is None and self._static_error is None)
        behind = self._lines != (None, None) or any(self._membranes) or settings.swapped_tubes
        self.full = behind or (ports and not hasattr(surroundings, "flow_at"))
        of_total, of_static = (self._total_read, self._static_read) if ports else (self._total_port, self._static_port)
        self._ports = of_total, of_static
        self._total_truth = (
            self._mean_of_total if self.full else of_total if self._response is None else self._difference
        )
        self._static_truth = self._mean_of_static if self.full else of_static
        self._lines = None

    def feel(self, t: float, force: Triple) -> None:
        """Take in the air and the specific force at plant time `t`, s: each step, and before `step`.

        What comes first is taken to have been there before, and tubes are made for its air.

        Parameters
        ----------
        t : float
            Plant time, s.
        force : (x, y, z)
            Specific force at the head, vibration included, body axes, m/s².
        """
        flow = NO_FLOW if self.surroundings is None else self.surroundings.flow()
        total, static, temperature, _, _, _, _ = flow
        self._temperature = self._warmed(total, static, temperature)
        self._t = t
        fx, fy, fz = force
        if not self._open or t < self.covered_until:
            total, static = self._behind(t, flow, force)
        if self._response is not None:
            total = self._response(total - static, static, self._temperature)
        tx, ty, tz, sx, sy, sz = self._membranes
        felt = self._total_felt
        felt.append(total + tx * fx + ty * fy + tz * fz)
        self._static_felt.append(static + sx * fx + sy * fy + sz * fz)
        if len(felt) > MOST_REMEMBERED and t < self.due:
            self.total.read(t, self._total_truth)
            self.static.read(t, self._static_truth)

    def step(self, until: float) -> list[Row]:
        """Return the rows polled up to plant time `until`.

        Parameters
        ----------
        until : float
            The present plant time, s.

        Returns
        -------
        list of tuple
            (t, p_total, p_static, temperature, t_total, t_static): s, Pa, Pa, K, s, s. NaN before a sensor's first
            finished conversion. The temperature is the static sensor's.
        """
        rows: list[Row] = []
        t = self.due
        while t <= until:
            p_total, _, t_total = self.total.read(t, self._total_truth)
            p_static, temperature, t_static = self.static.read(t, self._static_truth)
            if self._response is not None:
                if p_static == p_static:
                    self._last_static = p_static
                p_total += self._last_static
            if self._thermometer is not None:
                temperature = self._told(t, temperature)
            rows.append((t, p_total, p_static, temperature, t_total, t_static))
            t = self.due = self._next_poll()
        return rows

    def _told(self, t: float, temperature: float) -> float:
        """Return what a thermometer that breaks makes of a temperature, K; where nothing comes the last one stands."""
        arrived = None if self._thermometer is None else self._thermometer(t, temperature)
        if arrived is not None:
            self._told_temperature = arrived
        return self._told_temperature

    # -- the truth of a conversion -----------------------------------------------------------------------------------

    def _total_port(self, t: float) -> tuple[float, float]:
        p_total, p_static, temperature = NO_AIR if self.surroundings is None else self.surroundings.air(t)
        return (p_static if t < self.covered_until else p_total), temperature

    def _difference(self, t: float) -> tuple[float, float]:
        of_total, of_static = self._ports
        (total, temperature), (static, _) = of_total(t), of_static(t)
        assert self._response is not None
        return self._response(total - static, static, temperature), temperature

    def _static_port(self, t: float) -> tuple[float, float]:
        p_total, p_static, temperature = NO_AIR if self.surroundings is None else self.surroundings.air(t)
        return p_static, self._warmed(p_total, p_static, temperature)

    def _flow_at(self, t: float) -> Flow:
        flow: Flow = getattr(self.surroundings, "flow_at", no_flow)(t)  # not kept: it would hold the plant
        return flow

    def _total_read(self, t: float) -> tuple[float, float]:
        total, static, temperature, mach, alpha, beta, throttle = self._flow_at(t)
        if t < self.covered_until:
            return static, temperature
        port = self._total_error
        return (total if port is None else port(total, static, mach, alpha, beta, throttle)), temperature

    def _static_read(self, t: float) -> tuple[float, float]:
        total, static, temperature, mach, alpha, beta, throttle = self._flow_at(t)
        port = self._static_error
        felt = static if port is None or t < self.covered_until else port(total, static, mach, alpha, beta, throttle)
        return felt, self._warmed(total, static, temperature)

    def _warmed(self, total: float, static: float, temperature: float) -> float:
        """Temperature at the thermometer, K: the flow warms it by a share of 0.2 M²."""
        if self._recovery == 0.0:
            return temperature
        stagnation: float = (total / static) ** (2.0 / 7.0)
        return temperature * (1.0 + self._recovery * (stagnation - 1.0))

    def _mean_of_total(self, middle: float) -> tuple[float, float]:
        return self._mean(self._total_felt, middle, self.total.half_window), self._temperature

    def _mean_of_static(self, middle: float) -> tuple[float, float]:
        return self._mean(self._static_felt, middle, self.static.half_window), self._temperature

    def _mean(self, felt: list[float], middle: float, half: float) -> float:
        """Return the mean of what was felt from `middle` - `half` to `middle` + `half`; forget what was before."""
        if not felt:
            return nan
        newest = len(felt) - 1
        end = newest + (middle + half - self._t) * self._steps_per_second
        start = end - 2.0 * half * self._steps_per_second
        if start < 0.0:  # at the beginning of a record
            felt[:0] = [felt[0]] * (1 + int(-start))
            return self._mean(felt, middle, half)
        i, j = int(start), min(int(end), newest - 1)
        v, w = start - i, end - j
        whole = sum(felt[i : j + 1]) - 0.5 * (felt[i] + felt[j])
        last = w * (felt[j] + 0.5 * w * (felt[j + 1] - felt[j]))
        first = v * (felt[i] + 0.5 * v * (felt[i + 1] - felt[i]))
        del felt[:i]
        return (whole + last - first) / (end - start)

    # -- between the air and the sensors -----------------------------------------------------------------------------

    def _behind(self, t: float, flow: Flow, force: Triple) -> tuple[float, float]:
        """Return the pressures at the two sensors."""
        p_total, p_static, temperature, mach, alpha, beta, throttle = flow
        total, static = p_total, p_static
        if t < self.covered_until:
            total = p_static
        else:
            if self._total_error is not None:
                total = self._total_error(p_total, p_static, mach, alpha, beta, throttle)
            if self._static_error is not None:
                static = self._static_error(p_total, p_static, mach, alpha, beta, throttle)
        if self._lines is None:
            self._lines = self._connect(p_static, temperature)
        total_line, static_line = self._lines
        if total_line is not None:
            total = total_line.step(t, total, p_static, temperature, force)
        if static_line is not None:
            bay = p_static if self._response is None or not self._response.passes else total
            static = static_line.step(t, static, bay, temperature, force)
        return (static, total) if self._settings.swapped_tubes else (total, static)

    def _connect(self, pressure: float, temperature: float) -> tuple[Line | None, Line | None]:
        s = self._settings

        def line(tube: TubeSettings, direction: Triple, faults: tuple[PortFault, ...]) -> Line | None:
            if tube.length == 0.0 and not faults:
                return None
            return Line(tube, direction, faults, self._dt, pressure=pressure, temperature=temperature)

        total, static = s.tubes()
        of_total, of_static = s.total_port.faults + s.port_faults, s.static_port.faults + s.port_faults
        if self._response is not None and self._response.passes:
            of_total, of_static = passing(of_total), passing(of_static)
        return line(*total, of_total), line(*static, of_static)


def no_flow(_t: float) -> Flow:
    """Return what is known of the air where nobody says anything."""
    return NO_FLOW


def _sensor(
    settings: PressureSettings | DifferentialSettings,
    normal: Triple,
    thermal: ThermalSettings,
    streams: Streams,
    unit: Unit | None,
    name: str,
    batch: Batch,
) -> PressureSensor:
    return PressureSensor(
        settings.description(),
        streams,
        name=name,
        offset_pa=settings.offset_pa,
        unit=settings.unit if unit is None else unit,
        normal=normal,
        rate_error_percent=settings.rate_error_percent,
        thermal=thermal,
        faults=settings.faults,
        batch=batch,
    )


def membranes(settings: AirDataSettings, streams: Streams, name: str = "air_data") -> tuple[Triple, Triple]:
    """Return what the drawn units' membranes make of specific force, body axes, Pa/(m/s²): total, static.

    For those who calibrate the units that fly; the parameters are those of `AirDataHead`.
    """
    head = AirDataHead(settings, streams, name=name)
    return head.total.acceleration, head.static.acceleration
