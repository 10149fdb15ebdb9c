"""What a differential sensor makes of the pressure difference between its two ports.

The difference is that of total and static port, p_t − p_s, behind the tubes. Where the tubes are swapped its sign is
turned. A membrane feels it as it is. Through a thermal part air flows,

    ṁ = ½ ṁ_c (√(1 + 8 Δp_s/Δp_c) − 1),      Δp_s: between the part's own ports

and in the two tubes, of length L together and diameter d, the flow loses (laminar, Hagen-Poiseuille)

    Δp − Δp_s = 128 μ L ṁ/(π d⁴ ρ) = a (√(1 + 8 Δp_s/Δp_c) − 1),      a = 64 μ L ṁ_c/(π d⁴ ρ)

With u = √(1 + 8 Δp_s/Δp_c) that is Δp_c (u² − 1)/8 + a (u − 1) = Δp, a quadratic equation in u. The part then reads

    reading = Δp_s · p/p_cal

as it counts molecules (Sensirion's data on the SDP3x: effective pressure = reading · 966 hPa/p; their application note
"Compensation of pressure drop in a hose" has the flow's law, with ṁ_c = 4.79e-7 kg/s and Δp_c = 59.33 Pa as PX4 uses
it in `airspeed.cpp`). Two tubes of 0.3 m and 2 mm lose 7 % of 600 Pa, 3.5 % of the airspeed, and of 1.5 mm 20 %.

What is shut behind a thermal part does not keep its pressure: air passes the part until both sides are equal, through
some 10⁻⁸ kg/(s Pa) into a cubic centimetre, which takes milliseconds. So a shut port reads Δp = 0, not what it held.

Left out: the lag that the flow takes off the tubes, and the air that the flow draws in at the pitot's tip.
"""

from collections.abc import Iterable
from math import isfinite, pi, sqrt

from sensors.differential_description import DifferentialDescription
from sensors.pneumatics import GAS_CONSTANT, STANDARD, viscosity
from sensors.settings import PortFault, TubeSettings

THROUGH = 1e-3  # s, in which a shut port's pressure goes through a thermal part to the other side; see above


class Response:
    """From the difference at the ends of the tubes to what the part reads, without its errors.

    Parameters
    ----------
    description : DifferentialDescription
    tubes : iterable of TubeSettings
        From the ports to the part; a length of 0 is none.
    reversed : bool
        Whether the two tubes are swapped.

    Attributes
    ----------
    hose : float
        Σ L/d⁴ of the tubes, 1/m³; 0 where nothing flows.
    passes : bool
        Whether air passes from one side to the other.
    """

    __slots__ = ("_calibration", "_flow", "_knee", "_sign", "hose", "passes")

    def __init__(
        self, description: DifferentialDescription, tubes: Iterable[TubeSettings] = (), *, reversed: bool = False
    ) -> None:
        self._sign = -1.0 if reversed else 1.0
        self._calibration, self._flow, self._knee = (
            description.calibration_pressure, description.flow, description.flow_pressure,
        )  # fmt: skip
        self.passes = self._flow > 0.0
        self.hose = hose(tubes) if self.passes else 0.0

    def __call__(self, difference: float, pressure: float, temperature: float) -> float:
        """Return what is read, Pa.

        Parameters
        ----------
        difference : float
            p_t − p_s, Pa.
        pressure, temperature : float
            Of the air in the part, Pa and K.
        """
        difference *= self._sign
        if self.hose > 0.0:
            difference = self._behind_tubes(difference, pressure, temperature)
        if self._calibration > 0.0:
            difference *= pressure / self._calibration
        return difference

    def _behind_tubes(self, difference: float, pressure: float, temperature: float) -> float:
        if not (isfinite(difference) and pressure > 0.0 and temperature > 0.0):
            return difference
        size, eighth = abs(difference), self._knee / 8.0
        lost = loss(self._flow, self.hose, pressure, temperature)
        root = sqrt(lost * lost + 4.0 * eighth * (eighth + lost + size))
        u = (root - lost) / (2.0 * eighth)
        left = eighth * (u * u - 1.0)
        return left if difference > 0.0 else -left


def hose(tubes: Iterable[TubeSettings]) -> float:
    """Return Σ L/d⁴ of tubes, 1/m³."""
    return sum(tube.length / tube.diameter**4 for tube in tubes if tube.length > 0.0)


def loss(flow: float, hoses: float, pressure: float, temperature: float) -> float:
    """Return a of the tubes' loss a (u − 1), Pa.

    Parameters
    ----------
    flow : float
        ṁ_c, kg/s.
    hoses : float
        Σ L/d⁴, 1/m³.
    pressure, temperature : float
        Of the air, Pa and K.
    """
    return 64.0 * viscosity(temperature) * hoses * flow * GAS_CONSTANT * temperature / (pi * pressure)


def share_lost(description: DifferentialDescription, tubes: Iterable[TubeSettings], difference: float) -> float:
    """Return which share of a difference, Pa, the flow loses in the tubes, in the standard air at sea level."""
    if not description.flow > 0.0:
        return 0.0
    response = Response(description, tubes)
    read = response(difference, **STANDARD)
    return 1.0 - read / Response(description)(difference, **STANDARD)


def passing(faults: Iterable[PortFault]) -> tuple[PortFault, ...]:
    """Return the faults of a port before a thermal part: what shuts it lets the pressure through to the other side."""
    faults = tuple(faults)
    shut = [fault for fault in faults if fault.kind in ("blocked", "ice")]
    return faults + tuple(
        PortFault(kind="leak", start=fault.start, stop=fault.stop, time_constant=THROUGH) for fault in shut
    )


__all__ = ["THROUGH", "Response", "hose", "loss", "passing", "share_lost"]
