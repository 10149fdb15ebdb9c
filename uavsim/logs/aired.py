"""A log's replay with its airspeed: tables, events and score of a flight, as far as a log can have them.

Where the log holds a true airspeed of somebody else's, the error is held against it, as a flight's is against truth:
over the rows in flight, from each launch, or from when the aircraft was told to fly, to the next rest. Where it holds
a speed over ground, the mean difference to it and a wind is told.
"""

from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.airspeeds import of_pressures
from uavsim.failure import FAILED
from uavsim.flight import Flight, frame_of_floats, frame_of_rows
from uavsim.logs.airspeed import Aired, AirSettings, air_of
from uavsim.logs.doubt import taken
from uavsim.logs.over_ground import over_ground
from uavsim.logs.recording import Array, Recording, Series
from uavsim.misleading import FLAG, LOST, spells
from uavsim.score import HIDDEN, error_figures, innovation_figures

STALE = 0.5  # s, how far a reading of the reference may be from an estimate
SLOWEST = 2.0  # m/s: below it both of an airspeed and its reference stand on the ground


def with_airspeed(flight: Flight, recording: Recording, settings: AirSettings) -> Flight:
    """Add to a replay what the onboard code makes of the log's pressures.

    Parameters
    ----------
    flight
        As `replay_log` returns it.
    recording, settings
        The log, and how its airspeed is estimated.

    Returns
    -------
    Flight
        With the tables 'air_data' and 'estimate', the events of the flight computer, and a score that has the figures
        of an airspeed; without pressures it is the flight that was given, with a remark that says what is lacking.
    """
    recording = taken(recording)
    launches = list(flight.score["recording"]["detections"])
    try:
        with np.errstate(all="ignore"):  # pressures of a log may be any numbers
            found = air_of(recording, settings, launches)
    except (ArithmeticError, ValueError, RuntimeError) as error:  # the launch is told all the same
        found = f"no airspeed is estimated, for its figures cannot be: {error}"
    if found is None:
        return flight
    if isinstance(found, str):
        of = flight.score["recording"]
        return replace(flight, score=flight.score | {"recording": of | {"remarks": [*of["remarks"], found]}})
    estimate = frame_of_rows("estimate", found.estimates)
    columns: dict[str, Array] = {str(name): estimate[name].to_numpy(dtype=float) for name in estimate}
    others = of_pressures(columns["p_total"], columns["p_static"], settings.scenario.estimator.calibration)
    estimate = estimate.assign(**others.columns())
    reference = _reference(recording.series.get("airspeed_reference"), columns["t"])
    if reference is not None:
        estimate = estimate.assign(airspeed_reference=reference)
    tables = {
        **flight.tables,
        "air_data": frame_of_floats("air_data", found.rows.ravel()),  # type: ignore[arg-type]
        "estimate": estimate,
    }
    events = sorted([*flight.events, *found.events], key=lambda event: float(event["t"]))
    about = flight.scenario | {"estimator": _plain(found)}
    return Flight(about, tables, events, _scored(flight.score, found, columns, reference, recording, settings))


def _plain(found: Aired) -> dict[str, Any]:
    """What was believed, as nested plain values."""
    return {"kind": found.told.air.kind, "believed": {k: v for k, v in asdict(found.told.noise).items() if _number(v)}}


def _number(value: Any) -> bool:
    return isinstance(value, bool | int | float) and bool(np.isfinite(value))


def _reference(series: Series | None, t: Array) -> Array | None:
    """The log's reference at each estimate, m/s; NaN where it has nothing near."""
    if series is None:
        return None
    good = np.isfinite(series.values) & np.isfinite(series.t)
    at, values = series.t[good], series.values[good]
    if not at.size:
        return None
    near = np.minimum(np.searchsorted(at, t), at.size - 1)
    apart = np.minimum(np.abs(at[near] - t), np.abs(at[np.maximum(near - 1, 0)] - t))
    return np.where(apart <= STALE, np.interp(t, at, values), np.nan)


def flown(found: Aired, t: Array) -> NDArray[np.bool_]:
    """Which estimates are of a flight: from a launch that was one, or from being told, to the end of its span."""
    rows = np.zeros(t.shape, bool)
    for span in found.spans:
        told = [
            float(e["t"])  # type: ignore[arg-type]
            for e in found.events
            if e["event"] in ("stroke_end", "in_flight") and span.start <= float(e["t"]) < span.end  # type: ignore[arg-type]
        ]
        begins = [span.launch] if span.launch is not None and told else []
        if begins or told:
            rows |= (t >= min([*begins, *told])) & (t < span.end)
    return rows


def _scored(
    score: dict[str, Any],
    found: Aired,
    columns: dict[str, Array],
    reference: Array | None,
    recording: Recording,
    settings: AirSettings,
) -> dict[str, Any]:
    t, speed, sd = columns["t"], columns["airspeed"], columns["airspeed_sd"]
    rows = flown(found, t)
    truth = np.full(t.shape, np.nan) if reference is None else reference
    rows_scored = rows & (np.isnan(truth) | (np.maximum(truth, speed) > SLOWEST))
    figures = error_figures(
        (speed - truth)[rows_scored],
        (columns["airspeed_raw"] - truth)[rows_scored],
        sd[rows_scored],
        columns["valid"][rows_scored],
        (speed >= HIDDEN * sd)[rows_scored],
    )
    nis = np.column_stack([columns["nis_total"], columns["nis_static"]])
    valid = columns["valid"] == 1.0
    first = rows & valid
    after = rows & (t >= t[first][0]) if first.any() else np.zeros(t.shape, bool)
    flags = [event for event in found.events if event["event"] == FLAG]
    airspeed = score["airspeed"] | figures | innovation_figures(nis[rows])
    airspeed |= {
        "estimator": found.told.air.kind,
        "flags": len(flags),
        "losses": sum(spell >= LOST for spell in spells(t[after], ~valid[after])) if after.any() else None,
    }
    ready = [event["event"] for event in found.events if event["event"] in ("ready", "not_ready")]
    ground = over_ground({name: column[rows] for name, column in columns.items()}, recording.series)
    of = score["recording"] | {
        "airspeed": {
            "rows": len(found.rows),
            "differential": found.head.differential,
            "made_of": list(found.head.made),
            "said": list(found.said),
            "reference": None if reference is None else recording.series["airspeed_reference"].source,
            "clock": None if found.delay is None else asdict(found.delay),
            "flights": [asdict(span) for span in found.spans],
            "over_ground": None if ground is None else asdict(ground) | {"within": ground.within},
        }
    }
    result = score | {"airspeed": airspeed, "recording": of}
    result["flight"] = score["flight"] | {"ready": ready[0] == "ready" if ready else None}
    result["pressure"] = {
        name: score["pressure"][name] | {"nis_mean": _mean(columns[f"nis_{name}"][rows])} for name in score["pressure"]
    }
    if found.reason:
        result |= {"outcome": FAILED, "reason": found.reason}
    return result


def _mean(values: Array) -> float | None:
    values = values[np.isfinite(values)]
    return float(values.mean()) if values.size else None
