"""The flights to look at first, and the command that flies each again."""

import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uavsim.studies.campaign.far import reach
from uavsim.studies.campaign.many import Many
from uavsim.views.campaign.quantities import RMSE, SHOWN, Array

LISTED = 5  # in a table


@dataclass(frozen=True, slots=True)
class Worst:
    """A flight that deserves a look.

    Attributes
    ----------
    row : int
    index : int
    seed : int or None
    outcome, reason : str
    expected, met : bool
        Whether it ended as expected; whether it met its requirements.
    rmse, latency : float
        m/s, s; NaN where there is none.
    command : str
        What flies it again; empty where the campaign has no folder.
    """

    row: int
    index: int
    seed: int | None
    outcome: str
    reason: str
    expected: bool
    met: bool
    rmse: float
    latency: float
    command: str


def worst(flown: Many, folder: Path | None = None, most: int = LISTED) -> list[Worst]:
    """Return the worst flights.

    First those that broke off (diverged, failed), then those that ended otherwise than expected, then those that do not
    meet a requirement, then those with a number far beyond the others'; among equals the greater RMSE of the airspeed
    comes first.
    """
    rmse, latency = flown.column(RMSE.key), flown.column("launch.latency")
    odd = np.any([reach(quantity.of(flown), flown.sound).beyond for quantity in SHOWN], axis=0)
    keys = (np.arange(len(flown)), -_known(rmse), ~odd, flown.met, flown.expected, flown.sound)
    order = np.lexsort(keys)[:most]
    outcomes, reasons = flown.words("outcome"), flown.words("reason")
    return [
        Worst(
            row,
            flown.index(row),
            flown.seed(row),
            outcomes[row],
            reasons[row],
            bool(flown.expected[row]),
            bool(flown.met[row]),
            float(rmse[row]),
            float(latency[row]),
            "" if folder is None else again(folder, flown.index(row)),
        )
        for row in order.tolist()
    ]


def _known(values: Array) -> Array:
    return np.where(np.isnan(values), -np.inf, values)


def again(folder: Path, index: int) -> str:
    """Return the command that flies one flight of a campaign again."""
    return shlex.join(["uavsim", "fly", "--from", str(folder), "--index", str(index)])
