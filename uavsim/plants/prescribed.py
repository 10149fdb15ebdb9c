"""A rig as a plant: the truth of the whole run is known before it starts, and no command changes it.

The columns that a rig does not give are NaN: there is no wing on a bench. The air is that of the room, at rest unless
the rig says otherwise (`air.weather`).
"""

from math import isfinite

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.air.weather import at_ground
from uavsim.plants.plant import Commands, Run, Vector
from uavsim.plants.settings import EnvironmentSettings
from uavsim.truth import UNITS

Array = NDArray[np.float64]


def room(environment: EnvironmentSettings) -> tuple[float, float]:
    """Pressure, Pa, and temperature, K, of still air at the place."""
    pressure, temperature, _ = at_ground(environment)
    return pressure, temperature


class PrescribedPlant:
    """A plant that plays a truth that is known beforehand.

    Parameters
    ----------
    run
        Length and step of the record, place and air.
    columns
        Of the truth, one value a row of `run.time`: at least `fx`, `fy`, `fz`. Without pressures and temperature the
        air is that of the room, at rest.
    shaking
        Specific force beside the truth, m/s², shape (rows, 3), body axes; it is felt and not recorded, as vibration.
    """

    failure = ""  # nothing in it can fail

    def __init__(self, run: Run, columns: dict[str, Array], shaking: Array | None = None) -> None:
        self._rate = run.step_rate
        time = run.time
        pressure, temperature = room(run.environment)
        given: dict[str, Array | float] = {
            "p_total": pressure,
            "p_static": pressure,
            "temperature": temperature,
            **columns,
            "t": time,
        }
        self._columns = {name: np.broadcast_to(given.get(name, np.nan), time.shape) for name in UNITS}
        felt = np.column_stack([self._columns[axis] for axis in ("fx", "fy", "fz")])
        if shaking is not None:
            felt = felt + shaking
        self._felt: list[Vector] = [(x, y, z) for x, y, z in felt.tolist()]
        self._total, self._static, self._temperature = (
            self._columns[name].tolist() for name in ("p_total", "p_static", "temperature")
        )
        self._flow = [np.nan_to_num(self._columns[name]).tolist() for name in ("mach", "alpha", "beta", "throttle")]
        self.k = 0
        self.t = 0.0
        self.force = self._felt[0]
        self.on_rail = True
        self.aloft = True

    def step(self) -> None:
        """Go on to the next row."""
        self.k += 1
        self.t = self.k / self._rate
        self.force = self._felt[self.k]

    def command(self, commands: Commands) -> None:
        """Take commands that nothing on a rig obeys."""

    @property
    def finite(self) -> bool:
        """Whether the force is finite."""
        return all(map(isfinite, self.force))

    def air(self, time: float) -> Vector:
        """Total, static pressure, Pa, and temperature, K, at any recorded `time`, s, linear within a step."""
        k = min(int(time * self._rate), self.k - 1)
        share = time * self._rate - k
        total, static, temperature = (
            values[k] + share * (values[k + 1] - values[k]) for values in (self._total, self._static, self._temperature)
        )
        return total, static, temperature

    def flow(self) -> tuple[float, float, float, float, float, float, float]:
        """Total, static pressure, Pa, temperature, K, Mach number, alpha, beta, rad, and throttle after this step."""
        k = self.k
        mach, alpha, beta, throttle = (values[k] for values in self._flow)
        return self._total[k], self._static[k], self._temperature[k], mach, alpha, beta, throttle

    def flow_at(self, time: float) -> tuple[float, float, float, float, float, float, float]:
        """As `flow`, at any recorded `time`, s: pressures and temperature linear within a step, the rest nearest."""
        k = min(round(time * self._rate), self.k)
        mach, alpha, beta, throttle = (values[k] for values in self._flow)
        return *self.air(time), mach, alpha, beta, throttle

    def truth(self) -> dict[str, Array]:
        """Columns of the truth up to this step."""
        return {name: np.array(values[: self.k + 1]) for name, values in self._columns.items()}
