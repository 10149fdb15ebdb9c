"""The tube from a port to its sensor, and what can go wrong with the port.

Dynamics. Air in a tube of length L and radius R that ends in a volume V (Bergh & Tijdeman, NLR-TR F.238, 1965):

    p_sensor/p_port = 1/D,   D(iω) = cosh Γ + (V/V_t)(n/k) Γ sinh Γ,   Γ = (iωL/c) √(a γ/n)

with V_t = πR²L, polytropic exponent k in the volume, and, from the Womersley number w = R√(ωρ/μ) and Prandtl's Pr, what
the wall does to the air's inertia, a(w), and to its stiffness, γ/n = γ - (γ-1)/a(w√Pr). Their a = -J₀/J₂(i^{3/2} w)
needs Bessel functions; closer to the wall's two limits than 3 % in between is (Pride, Morgan & Gangi 1993)

    a(w) = 1 + 8/(iw²) · [1/4 + 3/4 √(1 + iw²/9)]              8/(iw²) + 4/3 for w → 0,  1 + 2/(√i w) for w → ∞

What is simulated is a second-order system, D₂ = 1 + a₁s + a₂s², with D₂ = D at zero and at one frequency ω_m, that is
a₁ = Im D(iω_m)/ω_m and a₂ = (1 - Re D(iω_m))/ω_m². ω_m is the resonance, or 1/τ where that is lower:

    ω₀ = c/L · (4/π² + γV/(kV_t))^{-1/2}   lossless, 1 % (c/L at V = 0: quarter wave; at V ≫ V_t: Helmholtz)
    ω_r = ω₀/√(1 - Re D(iω₀))              shifted by the wall
    τ = 128μL (V/k + V_t/2)/(πd⁴p)         laminar (Poiseuille), to which a₁ goes in a narrow tube

It is discretised exactly for an input that is linear within a step. Below its resonance a closed tube is a standing
wave and delays nothing, so there is no delay L/c beside it. Against `bergh_tijdeman`, the equation above with its
Bessel functions, the gain of any tube is within 2, 5 and 10 % up to 0.2, 0.36 and 0.55 of the natural frequency 1/√a₂,
and a resonance above 1.5 within 5 % in height and 3 % in frequency; for example (sea level):

    L m, d mm, V mm³    natural frequency, damping    resonance, Bergh-Tijdeman    within 2 %, 5 %, 10 % up to
    0.15, 2, 50         482 Hz, 0.05                  9.46 at 481, 9.14 at 479 Hz  110, 191, 290 Hz
    0.30, 2, 100        235 Hz, 0.08                  6.58 at 234, 6.32 at 233     51, 89, 138
    0.60, 2, 50         123 Hz, 0.11                  4.55 at 121, 4.37 at 120     26, 45, 69
    0.60, 1, 50         102 Hz, 0.28                  1.87 at 94, 1.79 at 95       78, 111, 116
    1.0, 1.5, 1000      47 Hz, 0.27                   1.90 at 43, 1.87 at 43       22, 50, 54
    0.30, 0.5, 100      87 Hz, 0.92                   none                         60, 74, 92

Column. The gas in the tube feels the specific force f, and its weight acts like pressure at the port:

    u = p_port - ρ f·r,   r from port to sensor, ρ = p/(R_a T)        a tube straight aft adds ρ f_x L

Port. g is its opening (1 … 0), τ₀ the lag of tube and hole, y what the tube's end has without a leak, b the bay's
pressure. What a leak leaves of y - b is σ: air flows through port, tube and leak, one behind the other,

    p_∞ = b + σ (y - b) g T/(g T + τ₀),   |y - b| = R Q + K (1/g² + 1/a²) Q²,   σ |y - b| = K Q²/a²,   K = ρ/(2 C_d² A²)

with R = 128 μL/(πd⁴) of the tube (Poiseuille), sharp-edged holes of area g A and a A (A = πd²/4, Q = C_d A √(2Δp/ρ),
C_d = 0.61: Idelchik, Handbook of Hydraulic Resistance, diagram 4-18; ISO 5167-2). A tube torn off, a = 1, halves y - b
where it is short, and leaves less where it is long and narrow. Into the volume behind, with T of the leak,

    p' = (p_∞ - p)/T_p,   1/T_p = 1/T + g/(τ₀ (1 - g))

Blocked is g = 0: held, or with a leak gone to b with T. Open, g = 1: p_∞ at once. T and a are two numbers of one leak:
what takes a second behind a shut port is a pinhole of laminar flow, a = 0, which an open port all but hides, T ≫ τ₀;
a hole as wide as the tube empties that volume in milliseconds. Ice takes g from 1 to 0 as ½(1 + cos πs), s the share of
its duration that has passed, or of which the air was such that it grows. Water adds a plug of length l: its weight
ρ_w f·r l/|r| to the column, and its inertia and friction to those of the tube, a₂ += 4/3 ρ_w l C/A and
a₁ += 128 μ_w l C/(πd⁴), C = (V + V_t/2)/(γp).
"""

import cmath
from collections.abc import Iterable, Mapping
from math import cos, exp, inf, isfinite, nan, pi, sqrt
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sensors.settings import PortFault, TubeSettings
from sensors.unit import Triple, unit_vector

GAMMA = 1.4  # –, ratio of specific heats of air (ISO 2533)
GAS_CONSTANT = 287.05287  # J/(kg K), of dry air (ISO 2533)
PRANDTL = 0.71  # –, air at 15 °C
SUTHERLAND, SUTHERLAND_TEMPERATURE = 1.458e-6, 110.4  # kg/(m s √K) and K (ISO 2533)
WATER_DENSITY = 1000.0  # kg/m³
WATER_VISCOSITY = 1.0e-3  # Pa s, 20 °C
NOTHING_GROWN: Mapping[int, float] = MappingProxyType({})
STANDARD = {"pressure": 101325.0, "temperature": 288.15}  # Pa and K, sea level (ISO 2533)
SHORTEST = 1e-6  # m; what is shorter is no tube
TIGHT = 1e-9  # –, or Pa: a hole, or a difference, below which no air flows and squares are not taken
DISCHARGE = 0.61  # –, C_d of a sharp-edged hole
STANDARD_SCALE, STANDARD_POWER = 44330.77, 0.190263  # m and –: H = 44.33 km (1 - (p/p₀)^0.19), ISO 2533 below 11 km
HOLE = 1e-4  # s, lag of an open hole without a tube: stands against leak and ice where there is no tube


def viscosity(temperature: float) -> float:
    """Return the dynamic viscosity of air at `temperature` K, Pa s (Sutherland's law as in ISO 2533)."""
    return SUTHERLAND * temperature * sqrt(temperature) / (temperature + SUTHERLAND_TEMPERATURE)


def laminar_lag(
    *,
    length: float,
    diameter: float,
    volume: float,
    pressure: float,
    temperature: float,
    polytropic: float = 1.0,
) -> float:
    """Return the lag of a narrow tube, τ = 128μL (V/k + V_t/2)/(πd⁴p), s.

    Parameters
    ----------
    length, diameter, volume : float
        Of the tube, m, and of the cavity at its end, m³.
    pressure, temperature : float
        Of the air, Pa and K.
    polytropic : float
        k of the cavity; 1 is the isothermal cavity of the textbook form.
    """
    contents = volume / polytropic + 0.125 * pi * diameter**2 * length
    return 128.0 * viscosity(temperature) * length * contents / (pi * diameter**4 * pressure)


def bergh_tijdeman(
    frequency: ArrayLike,
    *,
    length: float,
    diameter: float,
    volume: float,
    pressure: float,
    temperature: float,
    polytropic: float = 1.4,
) -> NDArray[np.complex128]:
    """Return the complex gain of a tube that ends in a stiff cavity, with Bessel functions and all.

    Parameters
    ----------
    frequency : float or array
        Hz, above 0.
    length, diameter, volume : float
        Of the tube, m, and of the cavity at its end, m³; all above 0.
    pressure, temperature : float
        Of the air, Pa and K.
    polytropic : float
        k of the cavity.

    Returns
    -------
    numpy.ndarray
        p_sensor/p_port, of the shape of `frequency`.

    Notes
    -----
    Bergh & Tijdeman, "Theoretical and experimental results for the dynamic response of pressure measuring systems",
    NLR-TR F.238 (1965), one tube, without deflection of the membrane (σ = 0).
    """
    from scipy.special import jve  # late: it takes a quarter of a second

    omega = 2.0 * pi * np.asarray(frequency, dtype=float)
    density = pressure / (GAS_CONSTANT * temperature)
    argument = 1j**1.5 * 0.5 * diameter * np.sqrt(omega * density / viscosity(temperature))
    inertia = -jve(0, argument) / jve(2, argument)
    wall = -jve(2, argument * sqrt(PRANDTL)) / jve(0, argument * sqrt(PRANDTL))
    stiffness = GAMMA - (GAMMA - 1.0) * wall  # γ/n
    gamma = 1j * omega * length / sqrt(GAMMA * GAS_CONSTANT * temperature) * np.sqrt(inertia * stiffness)
    ratio = volume / (0.25 * pi * diameter**2 * length) * GAMMA / (polytropic * stiffness)
    gain: NDArray[np.complex128] = 1.0 / (np.cosh(gamma) + ratio * gamma * np.sinh(gamma))
    return gain


def second_order(
    *, length: float, diameter: float, volume: float, pressure: float, temperature: float, polytropic: float = 1.4
) -> tuple[float, float]:
    """Return a₁, s, and a₂, s², of the second-order equivalent 1/(1 + a₁s + a₂s²) of a tube.

    The natural frequency is 1/√a₂ rad/s and the damping ratio a₁/(2√a₂). Parameters as of `bergh_tijdeman`.
    """
    tube = (length, diameter, volume, pressure, temperature, polytropic)
    contents = 4.0 / pi**2 + GAMMA * volume / (polytropic * 0.25 * pi * diameter**2 * length)
    lossless = sqrt(GAMMA * GAS_CONSTANT * temperature / contents) / length
    slow = 1.0 / laminar_lag(
        length=length,
        diameter=diameter,
        volume=volume,
        pressure=pressure,
        temperature=temperature,
        polytropic=polytropic,
    )
    omega = min(lossless, slow)
    omega = min(omega / sqrt(1.0 - _line(omega, *tube).real), slow)
    line = _line(omega, *tube)
    return line.imag / omega, (1.0 - line.real) / omega**2


def _line(
    omega: float, length: float, diameter: float, volume: float, pressure: float, temperature: float, polytropic: float
) -> complex:
    """Return D(iω) with the elementary a(w)."""
    density = pressure / (GAS_CONSTANT * temperature)
    square = 0.25 * diameter**2 * omega * density / viscosity(temperature)
    stiffness = GAMMA - (GAMMA - 1.0) / _inertia(PRANDTL * square)
    gamma = 1j * omega * length / sqrt(GAMMA * GAS_CONSTANT * temperature) * cmath.sqrt(_inertia(square) * stiffness)
    ratio = volume / (0.25 * pi * diameter**2 * length) * GAMMA / (polytropic * stiffness)
    return cmath.cosh(gamma) + ratio * gamma * cmath.sinh(gamma)


def _inertia(square: float) -> complex:
    """Return a(w) of w²: what the wall makes of the air's inertia in a round tube."""
    return 1.0 + 8.0 / (1j * square) * (0.25 + 0.75 * cmath.sqrt(1.0 + 1j * square / 9.0))


class SecondOrder:
    """The system x + a₁x' + a₂x'' = u, stepped exactly for an input that is linear within a step.

    With the particular solution x_p = u - a₁u' of a straight line, what is left of x decays by the matrix e^{Ah}.
    It begins at rest with its first input, and again after an input that was not a number.

    Parameters
    ----------
    lag, inertia : float
        a₁, s, and a₂, s², above 0.
    dt : float
        Step h, s.
    """

    __slots__ = ("_a", "_b", "_c", "_d", "_k", "_u", "_v", "_x")

    def __init__(self, lag: float, inertia: float, dt: float) -> None:
        self._u = self._x = self._v = nan
        self.set(lag, inertia, dt)

    def set(self, lag: float, inertia: float, dt: float) -> None:
        """Change the system; its state stays."""
        self._a, self._b, self._c, self._d = _transition(lag, inertia, dt)
        self._k = lag / dt

    def settle(self, level: float) -> None:
        """Bring it to rest at `level`, from which the next input takes it on."""
        self._u = self._x = level
        self._v = 0.0

    def step(self, u: float) -> float:
        """Take in the input at the end of a step and return the output there."""
        rise = u - self._u
        lagging = self._k * rise
        e = self._x - self._u + lagging
        de = self._v - rise
        x = self._a * e + self._b * de + u - lagging
        self._u = u
        if x != x:  # the first input, or one that was no number
            self._v = 0.0
            self._x = u
            return u
        self._v = self._c * e + self._d * de + rise
        self._x = x
        return x


def _transition(lag: float, inertia: float, dt: float) -> tuple[float, float, float, float]:
    """Return e^{Ah} of (x, h x') by rows, for x + a₁x' + a₂x'' = 0."""
    middle = -0.5 * lag / inertia * dt
    half = cmath.sqrt(middle**2 - dt**2 / inertia)
    if abs(half) < 1.0:  # near the critical damping: no difference of nearly equal exponentials
        square = half * half
        sinch = cmath.sinh(half) / half if abs(half) > 1e-3 else 1.0 + square / 6.0 * (1.0 + square / 20.0)
        decay = cmath.exp(middle)
        even, odd = decay * cmath.cosh(half), decay * sinch
    else:  # the fast root by its sum, the slow one by their product: no difference of nearly equal roots
        fast = middle - half
        slow = dt**2 / (inertia * fast)
        even, odd = 0.5 * (cmath.exp(slow) + cmath.exp(fast)), 0.5 * (cmath.exp(slow) - cmath.exp(fast)) / half
    a, d = even - middle * odd, even + middle * odd
    return a.real, odd.real, (-(dt**2) / inertia * odd).real, d.real


class Line:
    """What is between one port and its sensor: a tube, its column of air, and the faults of the port.

    Parameters
    ----------
    tube : TubeSettings
        A length of 0 is no tube.
    direction : (x, y, z)
        From port to sensor where `tube.direction` is None, body axes.
    faults : iterable of PortFault
    dt : float
        Step of the plant, s.
    pressure, temperature : float
        Of the air that the tube is made for, Pa and K: the response is that at the start of a record, the column is of
        the air of each step.

    Raises
    ------
    ValueError
        If the direction has no length, or a figure is out of range.
    """

    __slots__ = (
        "_air", "_bay", "_condition", "_dt", "_end", "_faults", "_friction", "_grown", "_gx", "_gy", "_gz", "_hole",
        "_lag", "_last", "_loss", "_plug", "_shut", "_tube", "_unit", "_until", "diameter", "length", "volume",
    )  # fmt: skip

    def __init__(
        self,
        tube: TubeSettings,
        direction: Triple,
        faults: Iterable[PortFault],
        dt: float,
        *,
        pressure: float,
        temperature: float,
    ) -> None:
        self._unit = unit_vector(direction if tube.direction is None else tube.direction, "direction of a tube")
        self.length = tube.length if tube.length > SHORTEST else 0.0
        self.diameter, self.volume = tube.diameter, tube.volume
        # In the air of no flight yet a number must stand: NaN or nothing at all makes the tube for the standard one.
        known = isfinite(pressure) and isfinite(temperature) and pressure > 0.0 and temperature > 0.0
        self._air = {"pressure": pressure, "temperature": temperature} if known else STANDARD
        self._gx, self._gy, self._gz = (-axis * self.length / GAS_CONSTANT for axis in self._unit)
        self._faults = tuple(faults)
        self._dt = dt
        self._lag, self._hole = self._equivalent(), HOLE
        if self.length > 0.0:
            shape = {"length": self.length, "diameter": self.diameter, "volume": self.volume}
            self._hole += laminar_lag(**shape, **self._air, polytropic=GAMMA)
        self._tube = SecondOrder(*self._lag, dt) if self._lag[1] > 0.0 else None
        warm = self._air["temperature"]
        self._friction = 128.0 * viscosity(warm) * self.length / (pi * self.diameter**4)  # R, Pa s/m³
        section = 0.25 * pi * self.diameter**2
        density = self._air["pressure"] / (GAS_CONSTANT * warm)
        self._loss = 0.5 * density / (DISCHARGE * section) ** 2  # K, Pa s²/m⁶
        self._grown = {i: 0.0 for i, fault in enumerate(self._faults) if fault.conditional}
        self._condition = Condition(1.0, 0.0, 0.0, 0.0)
        self._until = -inf
        self._plug = 0.0
        self._shut = False
        self._last = self._end = self._bay = nan

    def step(self, t: float, port: float, bay: float, temperature: float, force: Triple) -> float:
        """Return the pressure at the sensor at the end of a step, Pa.

        Parameters
        ----------
        t : float
            Time, s.
        port, bay : float
            Pressure at the port and in the bay behind it, Pa.
        temperature : float
            Of the air in the tube, K.
        force : (x, y, z)
            Specific force, body axes, m/s².
        """
        fx, fy, fz = force
        weight = port * (self._gx * fx + self._gy * fy + self._gz * fz)
        inlet = port + (weight / temperature if temperature else nan)
        if self._faults:
            if self._grown:
                self._grow(t, bay, temperature)
            return self._faulty(t, inlet, bay, force)
        return self._tube.step(inlet) if self._tube is not None else inlet

    def _faulty(self, t: float, inlet: float, bay: float, force: Triple) -> float:
        if t >= self._until:
            self._condition = condition(self._faults, t, self._grown)
            self._until = steady_until(self._faults, t)
        opening, leak, area, plug = self._condition
        if plug != self._plug:
            self._flood(plug)
        if plug:
            x, y, z = self._unit
            inlet -= WATER_DENSITY * plug * (x * force[0] + y * force[1] + z * force[2])
        if self._shut and opening > 0.0 and self._tube is not None:
            self._tube.settle(self._last)  # it fills again from where it was shut off
        self._shut = opening == 0.0
        end = self._tube.step(inlet) if self._tube is not None else inlet
        if self._last != self._last:  # shut from the first step on: with what is there then
            self._last, self._end, self._bay = end, end, bay
        felt = self._mix(end, bay, opening, leak, area)
        self._end, self._bay = end, bay
        if felt == felt:
            self._last = felt
        elif end == end:  # what came before was no number
            self._last = felt = end
        return felt

    def _mix(self, end: float, bay: float, opening: float, leak: float, area: float) -> float:
        """Return the pressure of the volume between the tube's end and a leak of `leak` = 1/T and `area`."""
        if leak == 0.0:
            if opening == 1.0:
                return end
            if opening == 0.0:
                return self._last
        share = 1.0
        if leak:
            share = self.share(end - bay, opening, area) * opening / (opening + self._hole * leak)
        level, before = bay + share * (end - bay), self._bay + share * (self._end - self._bay)
        rate = leak + (opening / (self._hole * (1.0 - opening)) if opening < 1.0 else inf)
        lagging = (level - before) / (rate * self._dt)  # exact for a level that is linear within the step
        return level - lagging + (self._last - before + lagging) * exp(-rate * self._dt)

    def share(self, difference: float, opening: float, area: float) -> float:
        """Return σ, what a leak leaves of the difference between port and bay, Pa; both areas over the tube's own."""
        drop = abs(difference)
        if opening < TIGHT:
            return 0.0
        if area < TIGHT or drop < TIGHT:
            return 1.0
        holes = 1.0 / opening**2 + 1.0 / area**2
        root = sqrt(self._friction**2 + 4.0 * self._loss * holes * drop)
        flow = 2.0 * drop / (self._friction + root)  # m³/s
        return min(self._loss * flow * flow / (area**2 * drop), 1.0)

    def _grow(self, t: float, pressure: float, temperature: float) -> None:
        """Let ice grow for a step where the air is such; it is gone outside its times."""
        for i in self._grown:
            fault = self._faults[i]
            if not fault.start <= t < fault.stop:
                self._grown[i] = 0.0
            elif grows(fault, pressure, temperature):
                self._grown[i] += self._dt

    def _flood(self, plug: float) -> None:
        """Put a plug of water into the tube, or take it out."""
        self._plug = plug
        lag, inertia = self._lag
        if plug:
            area = 0.25 * pi * self.diameter**2
            capacity = (self.volume + 0.5 * area * self.length) / (GAMMA * self._air["pressure"])
            lag += 128.0 * WATER_VISCOSITY * plug * capacity / (pi * self.diameter**4)
            inertia += 4.0 / 3.0 * WATER_DENSITY * plug * capacity / area
        if self._tube is not None and inertia > 0.0:
            self._tube.set(lag, inertia, self._dt)
        else:
            self._tube = SecondOrder(lag, inertia, self._dt) if inertia > 0.0 else None
            if self._tube is not None and self._last == self._last:
                self._tube.settle(self._last)

    def _equivalent(self) -> tuple[float, float]:
        if self.length == 0.0:
            return 0.0, 0.0
        return second_order(length=self.length, diameter=self.diameter, volume=self.volume, **self._air)


class Condition(NamedTuple):
    """How a port is."""

    opening: float  # 1 … 0
    leak: float  # 1/s, the rate at which its leaks fill it when it is shut
    area: float  # of its leaks over the tube's section
    plug: float  # m of water


def grows(fault: PortFault, pressure: float, temperature: float) -> bool:
    """Whether the air is such that ice grows: its temperature, K, and the pressure height of its pressure, Pa."""
    if fault.below_temperature is not None and not temperature < fault.below_temperature:
        return False
    if fault.between_heights is None:
        return True
    if not pressure > 0.0:
        return False
    low, high = fault.between_heights
    height: float = STANDARD_SCALE * (1.0 - (pressure / STANDARD["pressure"]) ** STANDARD_POWER)
    return low <= height <= high


def condition(faults: tuple[PortFault, ...], t: float, grown: Mapping[int, float] = NOTHING_GROWN) -> Condition:
    """Return how a port is at a time, s; for how long ice has grown that does so only in some air, s, by its place."""
    opening, leak, area, plug = 1.0, 0.0, 0.0, 0.0
    for i, fault in enumerate(faults):
        if fault.start <= t < fault.stop:
            if fault.kind == "blocked":
                opening = 0.0
            elif fault.kind == "ice":
                share = grown.get(i, t - fault.start) / fault.duration
                opening = min(opening, 0.5 * (1.0 + cos(pi * share)) if share < 1.0 else 0.0)
            elif fault.kind == "leak":
                leak += 1.0 / fault.time_constant
                area += fault.area
            else:
                plug += fault.water_length
    return Condition(opening, leak, area, plug)


def steady_until(faults: tuple[PortFault, ...], t: float) -> float:
    """Return the time up to which the condition is that of time `t`, s; ice that may be growing changes it always."""
    if any(
        f.kind == "ice" and f.start <= t < (f.stop if f.conditional else min(f.start + f.duration, f.stop))
        for f in faults
    ):
        return t
    edges = [edge for f in faults for edge in (f.start, f.stop) if edge > t]
    return min(edges, default=inf)
