"""Figures 4 to 6: the pressure sensors with and without their metal pipes, as far as it can be computed.

The paper gives the length, 5 cm, and says that pipes make the measurement more accurate, without a number. What pipes
do to the flow round the device's own box is not known. What is known, for a tube of length L on a cavity:

    lag         p + a₁ p' + a₂ p'' = p_port, the second-order equivalent of Bergh and Tijdeman's tube
    weight      ρ L f_x for the total pipe, which lies along the push f_x: its sensor drives the air in it, too
    angle       a plain tube loses 1 % of the impact pressure at 20°, a bevelled one at 28°, a shielded one at 40°

A sensor without a pipe has neither lag nor weight; what its bare hole feels at an angle, nobody has measured.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from sensors.pneumatics import STANDARD, Line, bergh_tijdeman, second_order
from sensors.probe import LIMITS, recovery
from sensors.settings import AFT, TubeSettings
from uavsim.studies.paper.entry import Entry

Array = NDArray[np.float64]

LENGTH = 0.05  # m, table 4
DIAMETERS = (0.5e-3, 1e-3, 2e-3)  # m; the paper has none
VOLUME = 5e-8  # m³, of the cavity at the sensor; the paper has none
DENSITY = 1.225  # kg/m³, ISO 2533
PUSH = 98.0665  # m/s², 10 g
SPEED = 20.0  # m/s, at which pressure errors are told as airspeed
STEP = 2e-5  # s, of the drawn response
SHOWN = 0.008  # s, of the drawn response
SIZE = 100.0  # Pa, of the drawn step
ANGLES = np.radians(np.arange(0.0, 50.5, 0.5))


@dataclass(frozen=True)
class Tube:
    """One pipe.

    Attributes
    ----------
    diameter
        m.
    lag
        a₁, s: what a ramp comes late by.
    frequency, damping
        Of the second-order equivalent, Hz and –.
    gain_100
        By Bergh and Tijdeman at 100 Hz.
    response
        Answer to a step at each of `PipeStudy.time`.
    """

    diameter: float
    lag: float
    frequency: float
    damping: float
    gain_100: float
    response: Array


@dataclass(frozen=True)
class PipeStudy:
    """What 5 cm of pipe do.

    Attributes
    ----------
    time
        s, of the responses.
    tubes
        By diameter.
    weight
        Error of the total pressure under a push of 10 g, Pa.
    angles
        By the kind of the mouth: share of the impact pressure that is felt at each of `ANGLES`.
    """

    time: Array
    tubes: tuple[Tube, ...]
    weight: float
    angles: Mapping[str, Array]

    def entries(self) -> dict[str, Entry]:
        """What is said of pipes; the paper has no numbers, and neither do we have any of the flow round the box."""
        return {
            "pipe": Entry(
                title="Pressure sensor with and without pipe",
                paper={"pipe": "more accurate"},
                ours={"pipe": "no error of the flow round the box, which is not described"},
                documented=False,
                note="The paper shows no measurement with and without, so that there is nothing to agree with. What "
                "5 cm of pipe do by themselves: a lag that does not matter, a ring of hundreds of hertz that sensors "
                "average out, and under the push of a launch the weight of the air in them, which an unpiped sensor "
                "does not have.",
                details=self.details,
            )
        }

    @property
    def details(self) -> dict[str, object]:
        """Numbers for the record."""
        return {
            "length": LENGTH,
            "lag_ms_by_diameter_mm": {f"{1e3 * t.diameter:g}": round(1e3 * t.lag, 3) for t in self.tubes},
            "gain_at_100_hz_by_diameter_mm": {f"{1e3 * t.diameter:g}": round(t.gain_100, 3) for t in self.tubes},
            "weight_of_air_at_10_g_pa": round(self.weight, 2),
            "weight_as_airspeed_at_20_m_s": round(self.weight / (DENSITY * SPEED), 3),
            "lag_as_airspeed_at_10_g": {f"{1e3 * t.diameter:g}": round(-t.lag * PUSH, 4) for t in self.tubes},
            "loss_at_30_degrees_percent": {
                name: round(100.0 * (1.0 - float(np.interp(np.radians(30.0), ANGLES, share))), 2)
                for name, share in self.angles.items()
            },
        }


def study() -> PipeStudy:
    """Compute all of it."""
    time: Array = np.linspace(0.0, SHOWN, round(SHOWN / STEP) + 1)
    return PipeStudy(
        time=time,
        tubes=tuple(_tube(diameter, time) for diameter in DIAMETERS),
        weight=_weight(),
        angles={name: np.array([recovery(float(a), limit) for a in ANGLES]) for name, limit in LIMITS.items()},
    )


def _weight() -> float:
    """Return what the total sensor reads too much behind its pipe under the push, Pa."""
    line = Line(TubeSettings(length=LENGTH, volume=VOLUME), AFT, (), 1e-3, **STANDARD)
    pressure, temperature = STANDARD["pressure"], STANDARD["temperature"]
    return line.step(0.0, pressure, pressure, temperature, (PUSH, 0.0, 0.0)) - pressure


def _tube(diameter: float, time: Array) -> Tube:
    shape = {"length": LENGTH, "diameter": diameter, "volume": VOLUME, **STANDARD}
    lag, inertia = second_order(**shape)
    gain = abs(bergh_tijdeman(100.0, **shape))
    line = Line(TubeSettings(length=LENGTH, diameter=diameter, volume=VOLUME), AFT, (), STEP, **STANDARD)
    low = STANDARD["pressure"]
    felt = [
        line.step(t, low + SIZE * (t >= 1e-3), low, STANDARD["temperature"], (0.0, 0.0, 0.0)) for t in time.tolist()
    ]
    return Tube(
        diameter=diameter,
        lag=lag,
        frequency=1.0 / (2.0 * pi * sqrt(inertia)),
        damping=lag / (2.0 * sqrt(inertia)),
        gain_100=float(gain),
        response=np.array(felt) - low,
    )
