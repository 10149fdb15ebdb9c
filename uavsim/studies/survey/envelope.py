"""Where flights have been: angle of attack, sideslip and Mach number of their truth, phase by phase.

Each scored phase of each flight gives as many rows as any other, `ROWS` evenly spaced ones, so that a stroke of 0.3 s
counts as much as half a minute of cruise. Rows below `LEAST_SPEED` are left out: there the wind sets the angles.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

ROWS = 200  # of a phase of a flight
LEAST_SPEED = 8.0  # m/s
PHASES = ("stroke", "transition", "cruise")
COLUMNS = ("phase", "airspeed", "mach", "alpha", "beta", "p_static", "wing")
WING_OUT = 0.99
DEFAULT = ("catapult", "gusty")  # packaged scenarios flown where no flights are given


@dataclass(frozen=True, eq=False)
class Envelope:
    """Rows of flights.

    Attributes
    ----------
    airspeed, mach, alpha, beta, static : array
        m/s, –, rad, rad, Pa.
    wing_out : array of bool
    phase : array of str
    weight : array
        Sums to 1; each phase has the same.
    source : tuple of str
        The flights.
    """

    airspeed: Array
    mach: Array
    alpha: Array
    beta: Array
    static: Array
    wing_out: NDArray[np.bool_]
    phase: NDArray[np.str_]
    weight: Array
    source: tuple[str, ...]

    @property
    def mean_speed(self) -> float:
        """Weighted mean airspeed, m/s."""
        return float(np.sum(self.weight * self.airspeed))

    def range(self, name: str) -> tuple[float, float]:
        """Least and largest of a column."""
        column = getattr(self, name)
        return float(column.min()), float(column.max())


def envelope_of(truths: "Sequence[pd.DataFrame]", source: Sequence[str]) -> Envelope:
    """Take the rows of flights' truth tables.

    Raises
    ------
    ValueError
        A column is missing, or no row is in a scored phase at speed.
    """
    taken = [rows for truth, name in zip(truths, source, strict=True) for rows in _rows(truth, name)]
    if not taken:
        raise ValueError(f"no scored phase at {LEAST_SPEED:g} m/s or more in {', '.join(source)}")
    columns = {name: np.concatenate([rows[name].to_numpy() for rows in taken]) for name in COLUMNS}
    phase = columns["phase"].astype(str)
    weight = np.zeros(phase.size)
    present = [name for name in PHASES if np.any(phase == name)]
    for name in present:
        weight[phase == name] = 1.0 / (len(present) * np.count_nonzero(phase == name))
    speed, mach, alpha, beta, static, wing = (columns[name].astype(float) for name in COLUMNS[1:])
    return Envelope(speed, mach, alpha, beta, static, wing >= WING_OUT, phase, weight, tuple(source))


def _rows(truth: "pd.DataFrame", name: str) -> "list[pd.DataFrame]":
    missing = [column for column in COLUMNS if column not in truth]
    if missing:
        raise ValueError(f"{name}: truth has no column {missing[0]}")
    moving = truth[truth["airspeed"] >= LEAST_SPEED]
    found = []
    for phase in PHASES:
        known = np.isfinite(moving[["mach", "alpha", "beta", "p_static"]].to_numpy(dtype=float)).all(axis=1)
        rows = moving.loc[known & (moving["phase"].astype(str) == phase).to_numpy()]
        if len(rows):
            at = np.unique(np.linspace(0, len(rows) - 1, ROWS).round().astype(int))
            found.append(rows.iloc[at])
    return found


def load_envelope(folders: Sequence[Path]) -> Envelope:
    """Take the envelope of flights on disk.

    Parameters
    ----------
    folders : sequence of Path
        Flights' folders, or folders whose `flights/` holds some.

    Raises
    ------
    ValueError
        A folder that is neither.
    """
    from uavsim.flight import load

    flights: list[Path] = []
    for folder in folders:
        inside = sorted(p.parent for p in (folder / "flights").glob("*/truth.parquet"))
        flights += inside or [folder]
    loaded = [load(flight) for flight in flights]
    for flight, path in zip(loaded, flights, strict=True):
        if "truth" not in flight.tables:
            raise ValueError(f"{path}: has no truth.parquet, so nothing tells how it flew")
    return envelope_of([flight.truth for flight in loaded], [str(path) for path in flights])


def model_of(aircraft: str) -> str | None:
    """Return what a scenario calls this aircraft, None if it has no JSBSim model."""
    from uavsim.plants.hangar import find_aircraft

    try:
        return str(find_aircraft(aircraft))
    except ValueError:
        return None


def fly_envelope(
    seed: int = 1, *, model: str | None = None, progress: Callable[[float], None] | None = None
) -> Envelope:
    """Fly the packaged scenarios `DEFAULT` for their envelope.

    Parameters
    ----------
    seed : int
    model : str, optional
        Aircraft to fly, as a scenario names it; None: the scenarios' own, fw8.
    progress : function, optional
        Called with the share that is done.
    """
    from uavsim.cosim import fly
    from uavsim.scenario import load_scenario

    truths = []
    for k, name in enumerate(DEFAULT):
        overrides = [f"aircraft.model={model}"] if model is not None else []
        truths.append(fly(load_scenario(name, overrides=overrides, seed=seed)).truth)
        if progress is not None:
            progress((k + 1) / len(DEFAULT))
    return envelope_of(truths, [f"{name} (seed {seed})" for name in DEFAULT])
