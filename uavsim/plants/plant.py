"""What the loop asks of whatever the truth comes from.

A plant steps at a fixed interval and keeps its own record, one row of truth a step (`uavsim.truth.UNITS`). What it
does not have, as a centrifuge has no wing, is NaN there. Sensors read `force`, which the loop hands on with the
vibration, and ask for `flow` and `air` (`sensors.surroundings`), and nothing else.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings

Vector = tuple[float, float, float]
STEP_RATES = (1000, 2000, 4000, 8000)  # Hz, steps a second that a plant may take: whoever flies at one can halve it
Commands = tuple[float, float, float, float, float]
"""Wing (0 folded, 1 out), throttle (0 … 1), pitch and roll, rad, stabiliser engaged (0, 1)."""


class Plant(Protocol):
    """Where the truth comes from.

    Attributes
    ----------
    k, t
        Steps since the start of the record, and their time, s.
    force
        Specific force at the accelerometer after this step, body axes, m/s².
    on_rail
        Whether it is held by a launcher or a rig.
    aloft
        Whether it can go on: the altitude is a number and above the ground, and nothing of it touches that.
    failure
        What ended it from inside, one line; empty as long as it goes on.

    One with a launcher's machine may have `shakes`: the specific force that its push comes to, m/s², and in which time,
    s. It may have `remarks`, a list of lines that deserve a word at the start and, with more of them, at the end.
    """

    k: int
    t: float
    force: Vector
    on_rail: bool
    aloft: bool
    failure: str

    @property
    def finite(self) -> bool:
        """Whether the whole state is finite."""

    def step(self) -> None:
        """Advance by one step and record it."""

    def command(self, commands: Commands, /) -> None:
        """Take the onboard computer's commands; they act from the next step on."""

    def air(self, time: float, /) -> Vector:
        """Total, static pressure, Pa, and temperature, K, at any recorded `time`, s, linear within a step.

        Of the flow at the head (`Run.head_position`).
        """

    def flow(self) -> tuple[float, float, float, float, float, float, float]:
        """Total, static pressure, Pa, temperature, K, Mach number, alpha, beta, rad, and throttle after this step.

        Of the flow at the head, too.
        """

    def truth(self) -> dict[str, NDArray[np.float64]]:
        """Columns of the truth, SI, one value a step, the first at time 0; those of `uavsim.truth.OF_AIR` may lack."""


@dataclass(frozen=True, slots=True)
class Run:
    """What every plant is told of the run: place and air, launcher, length, what the seed has drawn, and what flies.

    Attributes
    ----------
    environment, launcher
        Of the scenario.
    duration
        Of the record, s.
    release_time
        When the latch lets go, or the rig begins, s.
    force_factor
        This run's specific force of the push over the nominal one.
    random_seed
        Of the plant's own noise: turbulence, a curve's.
    step_rate
        Hz.
    aircraft
        Of the scenario; a rig flies none.
    accelerometer_position, head_position
        Of accelerometer and air-data head from the aircraft's EYEPOINT, body axes forward-right-down, m.
    """

    environment: EnvironmentSettings
    launcher: LauncherSettings
    duration: float
    release_time: float
    force_factor: float = 1.0
    random_seed: int = 1
    step_rate: float = STEP_RATES[0]
    aircraft: AircraftSettings = field(default_factory=AircraftSettings)
    accelerometer_position: Vector = (0.0, 0.0, 0.0)
    head_position: Vector = (0.0, 0.0, 0.0)

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each row of the record, s."""
        return np.arange(round(self.duration * self.step_rate) + 1) / self.step_rate
