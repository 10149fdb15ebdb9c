"""What many flights gave, in numbers: outcomes, quantiles with their bands, what was not as it should be.

All in SI. What is not finite becomes null where it is written as JSON.
"""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from uavsim.studies.batch import Batch
from uavsim.studies.batch_cramer_rao import against_bound
from uavsim.studies.campaign.causes import causes
from uavsim.studies.campaign.convergence import Running
from uavsim.studies.campaign.differences import differences
from uavsim.studies.campaign.envelopes import Envelope, envelopes
from uavsim.studies.campaign.far import far_traces, reach
from uavsim.studies.campaign.many import Many, many
from uavsim.studies.intervals import share_interval
from uavsim.studies.quantiles import QuantileBand
from uavsim.views.campaign.consistency import ensemble, inside
from uavsim.views.campaign.convergence import estimates
from uavsim.views.campaign.errors import error_times, rebinned, together
from uavsim.views.campaign.quantities import QUANTILES, SHOWN, bands
from uavsim.views.campaign.worst import worst

LISTED = 20  # worst flights, causes and flights beyond a scale
POINTS = 25  # of running estimates


def summary(flown: Batch | Many, folder: Path | None = None) -> dict[str, Any]:
    """Return everything that a table tells.

    Parameters
    ----------
    folder
        Where the campaign is; then the worst flights come with the command that flies them again.

    Returns
    -------
    dict
        Everything in SI; a number that no flight has is left out of `quantiles`, an open side of a band is None.
    """
    told = many(flown)
    outcomes = told.runs["outcome"].value_counts().to_dict() if len(told) else {}
    return {
        "flights": len(told),
        "outcomes": {str(name): int(count) for name, count in outcomes.items()},
        "as_expected": _share(int(told.expected.sum()), len(told)),
        "causes": [
            {name: value for name, value in asdict(cause).items() if name != "row"} for cause in causes(told)[:LISTED]
        ],
        "false_detections": int(np.nansum(told.column("launch.false_detections"))),
        "integrity": _integrity(told),
        "requirements_unmet": int((~told.met).sum()),
        "quantiles": {
            quantity.key: found for quantity in SHOWN if (found := _quantiles(told, quantity.key)) is not None
        },
        "beyond_scale": {quantity.key: far for quantity in SHOWN if (far := _beyond(told, quantity.key))},
        "worst": [
            {name: value for name, value in asdict(one).items() if name != "row"} for one in worst(told, folder, LISTED)
        ],
        "draws": [asdict(one) for one in differences(told)],
        "consistency": _consistency(told),
        "airspeed_bound": {name: asdict(found) for name, found in against_bound(told).items()},
    }


def curves(flown: Batch | Many) -> dict[str, Any]:
    """Return what the figures draw over time and over the number of flights, thinned to what they show."""
    told = many(flown)
    return {
        "airspeed_error": _errors(told),
        "convergence": {name: _running(one) for name, one in estimates(told, POINTS).items()} if len(told) else {},
    }


def _integrity(flown: Many) -> dict[str, Any]:
    """Return how many flights had a hazard (a valid airspeed 3 m/s off for 1 s), a false flag, a loss of validity."""
    found = {}
    for name, key in (("hazard", "hazard"), ("false_flag", "false_flags"), ("loss", "losses")):
        values = flown.column(f"airspeed.{key}")
        values = values[~np.isnan(values)]
        found[name] = _share(int((values > 0.0).sum()), values.size)
    return found


def _share(count: int, flights: int) -> dict[str, Any]:
    low, high = share_interval(count, flights) if flights else (None, None)
    return {"flights": count, "share": count / flights if flights else None, "low": low, "high": high}


def _quantiles(flown: Many, key: str) -> dict[str, Any] | None:
    sample = flown.column(key)
    sample = sample[~np.isnan(sample)]
    if sample.size == 0:
        return None
    found = {name: _band(one) for name, one in bands(sample).items()}
    return {"flights": int(sample.size), "least": float(sample.min()), **found, "greatest": float(sample.max())}


def _band(one: QuantileBand) -> dict[str, float | None]:
    return {"value": one.value, "low": one.low, "high": one.high}


def _beyond(flown: Many, key: str) -> list[int]:
    """Return the indices of flights whose number is so far from the others' that no scale shows both."""
    rows = np.flatnonzero(reach(flown.column(key), flown.sound).beyond)[:LISTED]
    return [flown.index(int(row)) for row in rows]


def _consistency(flown: Many) -> dict[str, Any]:
    found = ensemble(flown)
    if found is None:
        return {}
    mean, share = inside(found[1])
    left_out = [flown.index(int(row)) for row in np.flatnonzero(found[3])]
    return {"nees_mean": mean, "inside_band": share, "flights": len(found[1]), "left_out": left_out}


def _errors(flown: Many) -> dict[str, Any]:
    time, there = error_times(flown)
    if not there.any():
        return {}
    raw, filtered = (flown.matrix(kind)[:, there] for kind in ("raw", "filtered"))
    far = far_traces(flown, time[there], filtered) | far_traces(flown, time[there], raw)
    t, raw, filtered = rebinned(together(time[there]), time[there], raw[~far], filtered[~far])
    found: dict[str, Any] = {"time": t, "flights": len(raw)}
    found["left_out"] = [flown.index(int(row)) for row in np.flatnonzero(far)]
    for name, values in (("raw", raw), ("filtered", filtered)):
        every = envelopes(values, tuple(QUANTILES.values()))
        found[name] = {quantile: _envelope(one) for quantile, one in zip(QUANTILES, every, strict=True)}
    return found


def _envelope(one: Envelope) -> dict[str, Any]:
    return {"value": one.value, "low": one.low, "high": one.high}


def _running(one: Running) -> dict[str, Any]:
    return {"flights": one.n, "value": one.value, "low": one.low, "high": one.high}
