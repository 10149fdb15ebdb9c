"""Plants that are not ours: what they raise, and truth that is none, ends the flight with a reason."""

from collections.abc import Callable
from contextlib import suppress
from math import isinf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.failure import PartError, blamed, said, shown
from uavsim.plants.plant import Commands, Plant, Run, Vector
from uavsim.truth import OF_AIR, UNITS

MOST_REMARKS, LONGEST_REMARK = 20, 300
Flow = tuple[float, float, float, float, float, float, float]


class GuardedPlant:
    """A plant of somebody else's, looked at after each step.

    Parameters
    ----------
    name : str
        As registered.
    plant : Plant
    run : Run
        What it was told.

    Attributes
    ----------
    problem : str
        What is wrong with its truth, once that has been asked for; empty if nothing is.
    """

    def __init__(self, name: str, plant: Plant, run: Run) -> None:
        self._part, self._plant, self.rate = f"plant {name!r}", plant, run.step_rate
        self.k, self.t = 0, 0.0
        self.force: Vector = (0.0, 0.0, 0.0)
        self.on_rail = self.aloft = True
        self.failure = self.problem = ""
        self._look()

    @property
    def finite(self) -> bool:
        """Whether the whole state is finite."""
        return bool(self._asked(lambda: bool(self._plant.finite)))

    def step(self) -> None:
        """Advance by one step; see `Plant`."""
        self.k += 1
        self.t = self.k / self.rate
        self._asked(self._plant.step)
        self._look()

    def command(self, commands: Commands) -> None:
        """Take the onboard computer's commands."""
        self._asked(lambda: self._plant.command(commands))

    def air(self, time: float) -> Vector:
        """Total and static pressure, Pa, and temperature, K, at a time."""
        total, static, temperature = self._numbers("air", self._asked(lambda: self._plant.air(time)), 3)
        return total, static, temperature

    def flow(self) -> Flow:
        """Total, static pressure, Pa, temperature, K, Mach number, alpha, beta, rad, and throttle after this step."""
        a, b, c, d, e, f, g = self._numbers("flow", self._asked(self._plant.flow), 7)
        return a, b, c, d, e, f, g

    def truth(self) -> dict[str, NDArray[np.float64]]:
        """Columns of the truth; NaN where the plant has none, which is a failure then (`problem`)."""
        rows = self.k + 1
        columns = {name: np.full(rows, np.nan) for name in UNITS}
        try:
            given = dict(self._plant.truth())
            for name, column in columns.items():
                if name in given or name not in OF_AIR:
                    column[:] = np.asarray(given[name], dtype=np.float64)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 (the flight is over; what is known of it is kept)
            self.problem = f"{self._part} has no whole truth after {rows} rows: {said(error)}"
        columns["t"] = np.arange(rows) / self.rate
        return columns

    @property
    def remarks(self) -> list[str]:
        """What it says that deserves a word; nothing if it cannot."""
        with suppress(PartError):
            said = self._asked(lambda: list(map(str, getattr(self._plant, "remarks", ()))))
            return [" ".join(line.split())[:LONGEST_REMARK] for line in said[:MOST_REMARKS]]
        return []

    def _look(self) -> None:
        plant = self._plant
        k, t = self._asked(lambda: (plant.k, plant.t))
        if k != self.k or not abs(t - self.t) < 1e-9 + 1e-12 * self.t:
            raise PartError(f"{self._part} is at step {k}, {t:g} s, and should be at {self.k}, {self.t:g} s")
        x, y, z = self._numbers("force", self._asked(lambda: plant.force), 3)
        self.force = x, y, z
        failure = self._asked(lambda: " ".join(str(getattr(plant, "failure", "")).split()))
        if failure:
            raise PartError(f"{self._part} has failed at {self.t:.4f} s: {failure[:300]}")
        self.on_rail, self.aloft = self._asked(lambda: (bool(plant.on_rail), bool(plant.aloft)))

    def _numbers(self, what: str, found: Any, count: int) -> tuple[float, ...]:
        try:
            values = tuple(map(float, found))
        except (TypeError, ValueError, OverflowError):
            values = ()
        if len(values) != count or any(map(isinf, values)):
            raise PartError(f"{self._part} has {what} = {shown(found)} at {self.t:.4f} s; it must be {count} numbers")
        return values

    def _asked(self, ask: Callable[[], Any]) -> Any:
        with blamed(self._part, self.t):
            return ask()
