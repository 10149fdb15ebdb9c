"""Table 5 and figure 12: Mach numbers from the paper's own pressures, by its relation and by the compressible one.

    paper           M = √(2 (p_t - p_s)/ρ)/a,   ρ = p_s M_a/(R T)   (2)-(4) with K = 1, x_v = 0, Z = 1
    compressible    M = √(5 [(p_t/p_s)^(2/7) - 1])

a is not given. Each printed M allows an interval of it, since it is rounded; only one constant, near 334 m/s, is in
all of them, whereas the speed of sound at the printed temperatures is 348 to 364 m/s. The pressures come from a
simulation of the head itself and hold its flow field: with the free stream at 101 325 Pa, as of table 6,

    Cp_t = (p_t - p_∞)/q,   Cp_s = (p_s - p_∞)/q,   q = γ/2 p_∞ M²

and the temperatures are warmed by the flow, T = T_∞ (1 + r/5 M²), with T_∞ and r from a straight line through the four.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from uavsim import airdata
from uavsim.studies.paper.entry import Entry

Array = NDArray[np.float64]

SET = (0.3, 0.5, 0.7, 0.9)  # k₁, Mach number of the simulated stream
TOTAL = (106_323.0, 116_015.0, 126_139.0, 141_136.0)  # Pa
STATIC = (99_330.0, 97_389.0, 91_873.0, 86_015.0)  # Pa
TEMPERATURE = (302.0, 310.0, 319.0, 329.0)  # K
PRINTED = (0.33, 0.55, 0.78, 1.04)  # k₂
PRINTED_ERRORS = (10.0, 10.0, 11.4, 15.6)  # δ, %
HALF_DIGIT = 0.005  # rounding of k₂
FREE_STREAM = 101_325.0  # Pa, table 6
PAPER_SOUND = 334.0  # m/s, a documented guess from within the interval that the table allows
SURVEY_MACH = 0.6  # table 6
SURVEY_TEMPERATURE = 300.0  # K, table 6


@dataclass(frozen=True)
class AirDataStudy:
    """The four conditions, each an array of four.

    Attributes
    ----------
    paper, local, compressible
        Mach numbers: the paper's relation over 334 m/s, the same over the speed of sound at the printed temperature,
        and the compressible relation.
    sound
        Least and greatest constant speed of sound that give every printed Mach number, m/s.
    total_coefficient, static_coefficient
        Cp_t and Cp_s.
    recovery
        Factor r of the temperatures.
    incompressible_percent, recovery_percent
        What the paper's relation, and a thermometer of r = 0.9 that is taken for the air's, add to the airspeed at
        Mach 0.6 and 300 K, %.
    """

    paper: Array
    local: Array
    compressible: Array
    sound: tuple[float, float]
    total_coefficient: Array
    static_coefficient: Array
    recovery: float
    incompressible_percent: float
    recovery_percent: float

    def entries(self) -> dict[str, Entry]:
        """Table 5."""
        low, high = self.sound
        printed = np.round(self.paper, 2)
        return {
            "table5": Entry(
                title="Mach number from the printed pressures",
                paper={"mach": list(PRINTED), "error_percent": list(PRINTED_ERRORS)},
                ours={"mach": _rounded(self.paper, 4), "error_percent": _rounded(errors(printed), 1)},
                tolerance=HALF_DIGIT,
                note=f"In the paper's mode: incompressible, over a constant speed of sound, {PAPER_SOUND:g} m/s, which "
                f"is not given; only {low:.2f} to {high:.2f} m/s agree with all four. The error is no accumulation of "
                "amplitudes: four to nine points of it are that constant, the rest is missing compressibility and the "
                f"ports' position error. The compressible relation has {rms(errors(self.compressible)):.1f} % rms on "
                f"the same pressures, against {rms(np.array(PRINTED_ERRORS)):.1f} % printed.",
                details={
                    "compressible_mach": _rounded(self.compressible, 4),
                    "compressible_error_percent": _rounded(errors(self.compressible), 6),
                    "compressible_rms_percent": round(rms(errors(self.compressible)), 2),
                    "paper_rms_percent": round(rms(np.array(PRINTED_ERRORS)), 2),
                    "local_speed_of_sound_error_percent": _rounded(errors(self.local), 2),
                    "speed_of_sound_allowed": _rounded(np.array(self.sound), 2),
                    "total_pressure_coefficient": _rounded(self.total_coefficient, 3),
                    "static_pressure_coefficient": _rounded(self.static_coefficient, 3),
                    "recovery_factor": round(self.recovery, 2),
                    "incompressible_at_mach_0.6_percent": round(self.incompressible_percent, 2),
                    "warmed_thermometer_at_mach_0.6_percent": round(self.recovery_percent, 2),
                },
            )
        }


def errors(mach: Array) -> Array:
    """δ of (5), %."""
    relative: Array = mach / np.array(SET) - 1.0
    return 100.0 * relative


def rms(values: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _rounded(values: Array, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]


def study() -> AirDataStudy:
    """Compute all of it."""
    total, static, temperature, mach = map(np.array, (TOTAL, STATIC, TEMPERATURE, SET))
    speed = airdata.airspeed(total=total, static=static, temperature=temperature, model="bernoulli")
    dynamic = 0.5 * airdata.GAMMA * FREE_STREAM * mach**2
    slope, cold = np.polyfit(mach**2, temperature, 1)
    return AirDataStudy(
        paper=speed / PAPER_SOUND,
        local=speed / airdata.speed_of_sound(temperature),
        compressible=airdata.mach(total=total, static=static),
        sound=(
            float(np.max(speed / (np.array(PRINTED) + HALF_DIGIT))),
            float(np.min(speed / (np.array(PRINTED) - HALF_DIGIT))),
        ),
        total_coefficient=(total - FREE_STREAM) / dynamic,
        static_coefficient=(static - FREE_STREAM) / dynamic,
        recovery=float(slope / (0.2 * cold)),
        incompressible_percent=_incompressible(SURVEY_MACH),
        recovery_percent=_warmed(SURVEY_MACH, 0.9),
    )


def _incompressible(mach: float) -> float:
    """Return what the paper's relation adds to the airspeed at a Mach number, %."""
    total, static, temperature = airdata.total_pressure(static=FREE_STREAM, mach=mach), FREE_STREAM, SURVEY_TEMPERATURE
    true = airdata.airspeed(total=total, static=static, temperature=temperature)
    read = airdata.airspeed(total=total, static=static, temperature=temperature, model="bernoulli")
    return 100.0 * (read / true - 1.0)


def _warmed(mach: float, factor: float) -> float:
    """Return what a warmed thermometer adds that is taken for the air's temperature, %."""
    read = airdata.recovery_temperature(static=SURVEY_TEMPERATURE, mach=mach, factor=factor)
    return 100.0 * (sqrt(read / SURVEY_TEMPERATURE) - 1.0)
