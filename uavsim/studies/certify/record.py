"""A set's folder: who flew it, and a row a flight, written as flights end, each file whole.

    campaign.json     the set, its root seed and size, the software and how far it is
    runs.parquet      a row a flight, sorted by number

A run that was ended goes on where it was, if the set, the seed, the size and the software are the same: a row depends
on nothing else.
"""

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sensors.data_files import parse_json
from uavsim.files import whole, write_json
from uavsim.folders import StandingPlace
from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.tasks import Flyable, fly
from uavsim.studies.engine import Crew
from uavsim.studies.identity import differences, identity, versions

if TYPE_CHECKING:
    import pandas as pd

ABOUT, ROWS = "campaign.json", "runs.parquet"
Progress = Callable[[int, int], None]
LIMIT = 600.0  # s on a clock that a flight may take
WRITING = 10.0  # s between two writings


class Record:
    """A set's folder while it is flown.

    Parameters
    ----------
    folder
        One that is there.
    name, seed, tasks
        What is flown.
    resume
        Whether what is there is taken up.
    revision
        Of the sources, as people name it.

    Raises
    ------
    ValueError
        What is there was flown by other software, or is another set; one line.
    """

    def __init__(
        self, folder: Path, name: str, seed: int, tasks: Sequence[Flyable], *, resume: bool, revision: str
    ) -> None:
        self.folder, self.tasks = folder, tasks
        self._about: dict[str, Any] = {"set": name, "seed": seed, "flights": len(tasks), "revision": revision}
        self._about |= {"versions": versions(), "identity": identity()}
        self._rows: dict[int, Row] = {}
        self._spent = 0.0
        if resume and (folder / ABOUT).is_file():
            self._take_up(parse_json((folder / ABOUT).read_text(encoding="utf-8")))
        self.write()

    def _take_up(self, before: Any) -> None:
        if not (isinstance(before, dict) and isinstance(before.get("identity"), dict)):
            raise ValueError(f"{self.folder / ABOUT} is no record of a set")  # noqa: TRY004 (of what a user gave)
        for key in ("set", "seed", "flights"):
            if before.get(key) != self._about[key]:
                raise ValueError(f"{self.folder}: {key} is {before.get(key)!r} there, {self._about[key]!r} here")
        different = differences(identity(), before["identity"])
        if different:
            raise ValueError(f"{self.folder} was flown by another software: {'; '.join(different)[:300]}")
        self._spent = float(before.get("wall_time", 0.0))
        if (self.folder / ROWS).is_file():
            self._rows = {row["number"]: row for row in rows_in(self.folder)}

    @property
    def missing(self) -> list[Flyable]:
        """Flights that are still to be flown."""
        return [task for task in self.tasks if task.number not in self._rows]

    def keep(self, rows: Sequence[Row]) -> None:
        """Take rows in."""
        self._rows |= {row["number"]: row for row in rows}

    @property
    def rows(self) -> list[Row]:
        """All rows, by number."""
        return [self._rows[number] for number in sorted(self._rows)]

    def write(self, spent: float = 0.0) -> None:
        """Write what there is."""
        import pandas as pd

        if self._rows:
            with whole(self.folder / ROWS) as part:
                pd.DataFrame(self.rows).to_parquet(part, index=False)
        done = len(self._rows)
        about = {**self._about, "finished": done, "complete": done == len(self.tasks)}
        write_json(self.folder / ABOUT, {**about, "wall_time": round(self._spent + spent, 1)})


def rows_in(folder: Path) -> list[Row]:
    """Return the rows of a folder as plain values; None where there is no number."""
    import pandas as pd

    frame = pd.read_parquet(folder / ROWS).astype(object)
    frame = frame.where(frame.notna(), None)
    return [dict(zip(frame.columns, row, strict=True)) for row in frame.itertuples(index=False, name=None)]


def frame(rows: Sequence[Row]) -> "pd.DataFrame":
    """Return rows as a table."""
    import pandas as pd

    return pd.DataFrame(list(rows))


def about(folder: Path) -> dict[str, Any]:
    """Return what a set's folder says of itself."""
    found: dict[str, Any] = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    return found


def run(
    out: Path,
    name: str,
    seed: int,
    tasks: Sequence[Flyable],
    crew: Crew,
    *,
    resume: bool = False,
    revision: str = "unknown",
    progress: Progress | None = None,
) -> list[Row]:
    """Fly what is missing of a set and return all its rows.

    Raises
    ------
    ValueError
        See `Record`; or flights could not be flown.
    OSError
        The folder is not empty, or cannot be written.
    KeyboardInterrupt
        Somebody wants to end; what was finished is written.
    """
    with StandingPlace(out, resume=resume) as place:
        record = Record(place.folder, name, seed, tasks, resume=resume, revision=revision)
        missing, started = record.missing, time.monotonic()
        written = [started]

        def done(results: list[tuple[int, Row]]) -> None:
            record.keep([row for _, row in results])
            if time.monotonic() - written[0] > WRITING:
                written[0] = time.monotonic()
                record.write(time.monotonic() - started)
            if progress is not None:
                progress(len(record.rows), len(tasks))

        try:
            left = crew.each(fly, missing, done=done, limit=LIMIT)
        finally:
            record.write(time.monotonic() - started)
        if left:
            raise ValueError(f"{len(left)} flights could not be flown: {left[0].why}")
        return record.rows
