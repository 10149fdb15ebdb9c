"""What several flights gave, in a few numbers: outcomes, quantiles with their bands, what was not as it should be."""

from dataclasses import asdict
from typing import Any

from uavsim.studies.batch import Batch
from uavsim.studies.batch_cramer_rao import against_bound
from uavsim.studies.quantiles import quantile_band

QUANTILES = {"p05": 0.05, "median": 0.50, "p95": 0.95}
FIGURES = (
    "launch.latency",
    "launch.latency_from_crossing",
    "flight.rail_exit_speed",
    "airspeed.rmse",
    "airspeed.reduction_percent",
    "airspeed.stroke.reduction_percent",
    "airspeed.cruise.reduction_percent",
    "airspeed.cruise.coverage_95",
)
"""Numbers of the score whose distribution is told."""


def summary(flown: Batch) -> dict[str, Any]:
    """Everything in SI; a figure that no flight has is left out of `quantiles`, an open side of a band is None."""
    runs = flown.runs
    return {
        "flights": len(runs),
        "outcomes": {str(name): int(count) for name, count in runs["outcome"].value_counts().items()},
        "false_detections": int(runs["launch.false_detections"].sum()),
        "requirements_unmet": int((~runs["requirements.met"].astype(bool)).sum()),
        "quantiles": {key: found for key in FIGURES if (found := _quantiles(flown, key)) is not None},
        "airspeed_bound": {name: asdict(found) for name, found in against_bound(flown).items()},
    }


def _quantiles(flown: Batch, key: str) -> dict[str, Any] | None:
    sample = flown.runs[key].dropna().to_numpy(float)
    if sample.size == 0:
        return None
    bands = {name: quantile_band(sample, probability) for name, probability in QUANTILES.items()}
    found = {name: {"value": band.value, "low": band.low, "high": band.high} for name, band in bands.items()}
    return {"least": float(sample.min()), **found, "greatest": float(sample.max())}
