"""What `--json` prints, a function a command; keys and units in `docs/json.md`.

Numbers are whole, in SI, and come from where the tables' come from. What does not exist or is not finite is null.
"""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.flight import Flight
    from uavsim.plugins import Source
    from uavsim.studies.batch import Batch
    from uavsim.studies.bench import Cost, OnboardCost
    from uavsim.studies.campaign.many import Many
    from uavsim.studies.operating import Operating
    from uavsim.studies.sensor_bench import Bench
    from uavsim.studies.tuning import Tuned

Document = dict[str, Any]
MICROSECOND = 1e-6  # s


def plain(value: Any) -> Any:
    """The same nested value as JSON has it."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, float):
        return float(value) if np.isfinite(value) else None
    return str(value) if isinstance(value, Path | str) else value


def rows(table: "pd.DataFrame") -> list[Document]:
    """A table's rows, each with its columns by name."""
    return [plain(row) for row in table.to_dict("records")]


def scenarios(known: Mapping[str, str]) -> Document:
    """Of `uavsim scenarios`."""
    return {"scenarios": [{"name": name, "description": description} for name, description in known.items()]}


def flight(flown: "Flight", folder: Path) -> Document:
    """Of `uavsim fly` and `uavsim replay`: one flight, or what was found in a log."""
    return plain({"folder": folder, "scenario": flown.scenario["name"], "score": flown.score})  # type: ignore[no-any-return]


def batch(flown: "Batch | Many", folder: Path, *, seeds: bool = False, with_rows: bool = True) -> Document:
    """Of `uavsim fly --seeds` and of a campaign, whose many rows are in its folder and may be left out."""
    from uavsim.studies.campaign.many import many
    from uavsim.views.campaign.summary import curves, summary

    flights = many(flown)
    lost = "lost_seeds" if seeds else "lost"
    found: Document = plain(
        {
            "folder": folder,
            "scenario": flown.scenario.name,
            "complete": flown.complete,
            lost: flown.lost,
            "summary": summary(flights, folder),
            **curves(flights),
        }
    )
    return {**found, "rows": rows(flown.runs)} if with_rows else found


def presets() -> Document:
    """Of `uavsim sensors`."""
    from uavsim.views.datasheets import preset_rows

    return {"presets": preset_rows()}


def part(name: str, measured: "Bench", folder: Path) -> Document:
    """Of `uavsim sensors NAME`: the datasheet's values as the preset has them, and the bench."""
    from sensors.catalogue import sheet
    from uavsim.views.characterisation import numbers

    return plain({"folder": folder, "preset": sheet(name), "bench": numbers(measured)})  # type: ignore[no-any-return]


def operating(found: "Operating", cells: "pd.DataFrame | None", folder: Path) -> Document:
    """Of `uavsim roc`."""
    from uavsim.views.operating import summary

    points = rows(found.rows)
    return {
        **plain({"folder": folder, **summary(found)}),
        "points": points,
        "cells": [] if cells is None else rows(cells),
    }


def tuned(found: "Tuned", place: Path) -> Document:
    """Of `uavsim tune`; `folder` is the file if one was asked for."""
    from uavsim.views.tuning import summary

    return plain({"folder": place, **summary(found)})  # type: ignore[no-any-return]


def cost(found: "Cost", onboard: "OnboardCost") -> Document:
    """Of `uavsim bench`."""
    return plain(  # type: ignore[no-any-return]
        {
            "steps": found.steps,
            "in_loop_s": MICROSECOND * found.in_loop,
            "reference_s": MICROSECOND * found.reference,
            "bare_s": MICROSECOND * found.bare,
            "ratio_over_bare": found.ratio_over_bare,
            "onboard_mean_s": MICROSECOND * onboard.mean,
            "onboard_p99_s": MICROSECOND * onboard.p99,
            "onboard_steps": onboard.steps,
            "same_state": found.same_state,
            "ratio": found.ratio,
        }
    )


def plugins(found: "Mapping[str, list[Source]]") -> Document:
    """Of `uavsim plugins`: who every kind is, by what it is."""
    return {"plugins": [plain({"kind": what, **asdict(one)}) for what, sources in found.items() for one in sources]}
