"""Several flights: the folder they are kept in.

A folder holds ``runs.parquet`` (a row a flight), ``campaign.json`` (what was flown, with what, on what), whole flights
in ``flights/SEED/`` for those that were kept, and plots, those of `views.campaign.plots`. Rows and kept flights are
written as flights end, each whole: whatever ends the process, what was finished can be read.
"""

import platform
import shutil
from collections.abc import Iterable
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uavsim import inputs
from uavsim.files import whole, write_json
from uavsim.studies.batch import Batch, Result
from uavsim.studies.batch_cramer_rao import against_bound
from uavsim.studies.campaign.many import Many, many
from uavsim.views.campaign.plots import save_many_plots
from uavsim.views.plots import save_plots

if TYPE_CHECKING:
    import pandas as pd

    from uavsim.flight import Flight
    from uavsim.scenario import Scenario

PACKAGES = ("uavsim", "jsbsim", "numpy", "scipy", "filterpy", "pandas", "pyarrow")
FEATURES = ("avx", "fma", "sse4", "asimd", "sve")  # of the processor, that floating point may depend on
PART = 1000  # rows in a file, which is written anew with each of them
DRAWN = 8  # flights with plots of their own; `uavsim replay` draws any other


class Record:
    """The folder of several flights, from the first to the last one.

    Parameters
    ----------
    folder
        One that is there, see `uavsim.folders`.
    scenario, seeds
        What is flown.
    """

    def __init__(self, folder: Path, scenario: "Scenario", seeds: list[int]) -> None:
        self._folder = folder
        self._asked = ranges(seeds)
        self._parts = -(-len(seeds) // PART)
        self._rows: dict[int, dict[int, dict[str, Any]]] = {}
        self._scenario = inputs.write(folder, scenario.to_dict())
        self._describe(Batch(scenario, _table([]), [], {}, complete=False, wall_time=0.0))

    def keep(self, results: list[tuple[int, Result]]) -> None:
        """Write finished flights: those that are kept, then the rows of all."""
        written = set()
        try:
            for position, (row, _, flight) in results:
                if flight is not None:
                    self._keep_flight(flight)
                self._rows.setdefault(position // PART, {})[position] = row
                written.add(position // PART)
        finally:
            for part in written:
                self._write_rows(part)

    def _write_rows(self, part: int) -> None:
        rows = self._rows[part]
        with whole(self._part(part)) as file:
            _table([rows[position] for position in sorted(rows)]).to_parquet(file, index=False)

    def _part(self, number: int) -> Path:
        """File of up to `PART` rows: `runs.parquet`, or one in a folder of that name, by position."""
        runs = self._folder / "runs.parquet"
        if self._parts == 1:
            return runs
        runs.mkdir(exist_ok=True)
        return runs / f"part-{number:05}.parquet"

    def _keep_flight(self, flight: "Flight") -> None:
        """A flight's folder appears in `flights/` when it is whole."""
        unfinished, flights = self._folder / ".keeping", self._folder / "flights"
        try:
            unfinished.mkdir()
            flight.write(unfinished)
            flights.mkdir(exist_ok=True)
            unfinished.rename(flights / str(flight.score["seed"]))
        except BaseException:
            shutil.rmtree(unfinished, ignore_errors=True)
            raise

    def close(self, flown: Batch, *, plots: bool) -> None:
        """Describe what was flown and draw it: plots of all flights, and of the first `DRAWN` that are kept.

        An interrupt leaves out what is not yet drawn.
        """
        self._describe(flown)
        flights = many(flown)
        self._describe(flights, bound=True)
        if not plots:
            return
        save_many_plots(flights, self._folder / "plots")
        for seed, flight in list(flown.kept.items())[:DRAWN]:
            save_plots(flight, self._folder / "flights" / str(seed) / "plots")

    def _describe(self, flown: Batch | Many, *, bound: bool = False) -> None:
        write_json(
            self._folder / "campaign.json",
            {"asked": self._asked, **campaign(flown, bound=bound), "scenario": self._scenario},
        )


def _table(rows: list[dict[str, Any]]) -> "pd.DataFrame":
    import pandas as pd

    return pd.DataFrame(rows)


def ranges(seeds: Iterable[int]) -> str:
    """Seeds as `--seeds` takes them: 1-4,9."""
    found: list[list[int]] = []
    for seed in seeds:
        if found and seed == found[-1][1] + 1:
            found[-1][1] = seed
        else:
            found.append([seed, seed])
    return ",".join(f"{first}-{last}" if last > first else f"{first}" for first, last in found)


def campaign(flown: Batch | Many, *, bound: bool = True) -> dict[str, Any]:
    """Describe what was flown, with which software and on which processor, and how near it came to the bound.

    `wall_time` in s; `airspeed_bound` as `studies.batch_cramer_rao.against_bound` has it, empty without `bound`.
    """
    return {
        "scenario": flown.scenario.to_dict(),
        "root_seed": flown.scenario.seed,
        "seeds": [int(seed) for seed in flown.runs["seed"]] if len(flown.runs) else [],
        "complete": flown.complete,
        "versions": {**{name: _version(name) for name in PACKAGES}, "python": platform.python_version()},
        "processor": {
            "machine": platform.machine(),
            "name": platform.processor(),
            "features": processor_features(Path("/proc/cpuinfo")),
        },
        "wall_time": flown.wall_time,
        "airspeed_bound": {name: asdict(found) for name, found in against_bound(flown).items()} if bound else {},
    }


def processor_features(cpuinfo: Path) -> list[str]:
    """Features of the first processor that floating point may depend on; none where the system does not tell."""
    if not cpuinfo.is_file():
        return []
    for line in cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines():
        name, _, flags = line.partition(":")
        if name.strip() in {"flags", "Features"}:
            return sorted({flag for flag in flags.split() if flag.startswith(FEATURES)})
    return []


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
