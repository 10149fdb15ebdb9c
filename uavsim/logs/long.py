"""The replay of a log that does not fit into memory, and of a log of several flights.

One pass tells rate, unit and gaps (`stream.Survey`), a second one runs the detector by its loop (`watch`) and writes
the readings as they pass. Around the first detection, or the greatest force, a stretch is replayed as any log
is, with all that is made of one. A log of several flights is cut where a detection follows the one before it after
`APART` or more: each flight is replayed by itself.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim.files import whole
from uavsim.flight import UNITS, Flight, frame
from uavsim.logs.doubt import doubted, oriented, settled, unit_of
from uavsim.logs.informed import sources
from uavsim.logs.recording import Array, Gap, Recording
from uavsim.logs.stream import Shown, Stream, Survey
from uavsim.logs.unseen import forward_in
from uavsim.logs.watch import Watch
from uavsim.onboard import launch

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow.parquet as pq

BEFORE, AFTER = 60.0, 300.0  # s of a stretch around a detection
MOST_STRETCH = 250_000  # readings of one: with all that is made of them 100 MB
LASTING = 0.05  # s, over which the force is averaged to find the greatest where there is no detection: no jolt
APART = 30.0  # s from one detection to the next, from which that is another flight's
BINS = 4000  # of the whole log, of each of which the figure has the least and the greatest force
GROUP = 250_000  # readings of a group of the Parquet file that is written

Replay = Callable[[Recording], Flight]


@dataclass(frozen=True, slots=True, eq=False)
class LongReplay:
    """What was made of a long log.

    Attributes
    ----------
    flight : Flight
        The stretch around the first detection, with the figures of the whole log; its accelerometer's table is thinned
        to what a figure shows.
    written : tuple of str
        Tables that are in the folder already.
    spans : list of tuple
        When each flight of the log begins and ends, s.
    """

    flight: Flight
    written: tuple[str, ...]
    spans: list[tuple[float, float]]

    def write(self, folder: Path, extra: Callable[[Path], None] | None = None) -> None:
        """Write what is not there yet."""
        rest = {name: table for name, table in self.flight.tables.items() if name not in self.written}
        replace(self.flight, tables=rest).write(folder, extra)


def replay_long(
    stream: Stream,
    settings: launch.DetectorSettings,
    replay: Replay,
    folder: Path,
    shown: Shown | None = None,
) -> LongReplay:
    """Replay a long log.

    Parameters
    ----------
    stream
        The log.
    settings
        Of the detector.
    replay
        What makes a flight of a recording.
    folder
        Where the table of readings is written.
    shown
        Is told the share that is done.

    Raises
    ------
    ValueError
        One line, if it cannot be replayed.
    """
    survey, watch, thin, greatest = _passes(stream, settings, folder, shown)
    centre = watch.detections[0] if watch.detections else greatest
    before, after = _reach(survey)
    stretch = stream.between(centre - before, centre + after)
    stretch = replace(stretch, remarks=tuple(dict.fromkeys((*stream.remarks, *stretch.remarks))))
    flight = _whole(replay(stretch), survey, watch.detections)
    said = flight.score["recording"]["remarks"]
    if sources(launch.build(settings, survey.rate), stretch.series):
        said.append(
            "a log that is read in parts is searched by the force alone; what the detector is told besides it is told "
            "where a flight is replayed by itself"
        )
    why = flight.score["recording"].get("unseen")
    axes = oriented(
        stretch,
        settings,
        settled(stretch, survey.evidence),
        None if why is None else forward_in(why),
        launched=bool(flight.score["recording"]["detections"]),
    )
    doubts = (*doubted(stretch, settings, survey.evidence).remarks, *axes)
    said += [remark for remark in doubts if remark not in said]
    tables = {**flight.tables, "accelerometer": thin.table(stretch.readings)}
    spans = spans_of(watch.detections, survey)
    return LongReplay(replace(flight, tables=tables), ("accelerometer",), spans)


def spans_of(detections: Sequence[float], survey: Survey) -> list[tuple[float, float]]:
    """When each flight begins and ends, s: around its detections, and half-way to the flights beside it at most."""
    before, after = _reach(survey)
    groups: list[list[float]] = []
    for t in detections:
        if groups and 0.0 <= t - groups[-1][-1] < APART:
            groups[-1].append(t)
        else:
            groups.append([t])
    middles = [0.5 * (one[-1] + other[0]) for one, other in pairwise(groups)]
    found = []
    for i, group in enumerate(groups):
        start = max([group[0] - before, *([middles[i - 1]] if i and middles[i - 1] < group[0] else [])])
        end = min([group[0] + after, *([middles[i]] if i < len(middles) and middles[i] > group[0] else [])])
        found.append((start, end))
    return found


def _reach(survey: Survey) -> tuple[float, float]:
    """Seconds before and after a detection that are replayed."""
    span = min(BEFORE + AFTER, MOST_STRETCH / survey.rate)
    share = BEFORE / (BEFORE + AFTER)
    return span * share, span * (1.0 - share)


def _passes(
    stream: Stream, settings: launch.DetectorSettings, folder: Path, shown: Shown | None
) -> tuple[Survey, Watch, "_Thin", float]:
    """Survey a log, then watch it and write its readings."""
    survey = stream.survey(None if shown is None else lambda share: shown(0.4 * share))
    watch, part = Watch(settings, survey.rate, survey.axes), -1
    thin, greatest, at = _Thin(survey), -np.inf, survey.start
    scale = unit_of(survey.evidence, stream.mapping or "")
    with _table(folder / "accelerometer.parquet") as write:
        for lot in stream.lots(None if shown is None else lambda share: shown(0.4 + 0.6 * share)):
            if lot.begins or part < 0:
                part += 1
                watch.begin(survey.rates[min(part, len(survey.rates) - 1)])
            readings = lot.readings if scale == 1.0 else lot.readings * np.array([1.0, scale, scale, scale])
            watch.take(readings)
            thin.take(readings)
            write(readings)
            greatest, at = max((greatest, at), _greatest(readings, survey.rate))
    return survey, watch, thin, at


def _greatest(readings: Array, rate: float) -> tuple[float, float]:
    """The greatest force along whatever axis, averaged over `LASTING`, m/s², and when, s."""
    size = max(1, round(LASTING * rate))
    blocks = readings[: len(readings) // size * size or None].reshape(-1, min(size, len(readings)), 4)
    mean = np.nan_to_num(blocks).mean(axis=1)
    force = np.linalg.norm(mean[:, 1:], axis=1)
    row = int(np.argmax(force))
    return float(force[row]), float(mean[row, 0])


@contextmanager
def _table(path: Path) -> Iterator[Callable[[Array], None]]:
    """Write readings as they come, as `uavsim.flight` writes them at once."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    units = UNITS["accelerometer"]
    schema = pa.schema([pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in units.items()])
    kept: list[Array] = []

    def write(readings: Array) -> None:
        kept.append(readings)
        if sum(map(len, kept)) >= GROUP:
            flush(writer)

    def flush(to: "pq.ParquetWriter") -> None:
        if kept:
            columns = np.concatenate(kept).T
            kept.clear()
            to.write_table(pa.Table.from_arrays([pa.array(column) for column in columns], schema=schema))

    with whole(path) as part, pq.ParquetWriter(part, schema, use_dictionary=False) as writer:
        yield write
        flush(writer)


class _Thin:
    """What a figure of a whole log needs: of each stretch of time the least and the greatest force."""

    def __init__(self, survey: Survey) -> None:
        self._start, self._width = survey.start, max((survey.end - survey.start) / BINS, 1e-9)
        self._rows: list[Array] = []

    def take(self, readings: Array) -> None:
        """Take in a lot: of each bin the rows with the extremes of f_x, f_y, f_z."""
        bins = np.minimum((readings[:, 0] - self._start) // self._width, BINS).astype(np.intp)
        starts = np.flatnonzero(np.diff(bins, prepend=-1))
        ends = np.append(starts[1:], len(bins))
        low = np.fmin.reduceat(readings[:, 1:], starts, axis=0)
        high = np.fmax.reduceat(readings[:, 1:], starts, axis=0)
        self._rows.append(np.column_stack((readings[starts, 0], low)))
        self._rows.append(np.column_stack((readings[ends - 1, 0], high)))

    def table(self, stretch: Array) -> "pd.DataFrame":
        """Return the thinned log, with all readings of a stretch."""
        outside = np.concatenate(self._rows)
        if len(stretch):
            outside = outside[(outside[:, 0] < stretch[:, 0].min()) | (outside[:, 0] > stretch[:, 0].max())]
        rows = np.concatenate((outside, stretch))
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        return frame("accelerometer", dict(zip(UNITS["accelerometer"], rows.T, strict=True)))


def _whole(stretch: Flight, survey: Survey, detections: Sequence[float]) -> Flight:
    """Return a stretch's flight with the figures of the whole log."""
    said = stretch.score["recording"]
    outside = [t for t in detections if not said["start"] <= t <= said["end"]]
    detections = [
        *(t for t in outside if t < said["start"]),
        *said["detections"],  # there it is by each reading, and with all that the log tells besides
        *(t for t in outside if t > said["end"]),
    ]
    inside = {"start": said["start"], "end": said["end"], "readings": said["readings"]}
    recording: dict[str, Any] = {
        **said,
        "start": survey.start,
        "end": survey.end,
        "readings": survey.readings,
        "rate": survey.rate,
        "gaps": [asdict(Gap(*gap)) for gap in survey.gaps],
        "detections": list(detections),
        "stretch": inside,
    }
    launched = {
        **stretch.score["launch"],
        "detected_time": detections[0] if detections else None,
        "detections": len(detections),
    }
    others = [event for event in stretch.events if event["event"] != "launch_detected"]
    events = sorted(
        [*others, *({"t": t, "event": "launch_detected"} for t in detections)], key=lambda event: float(event["t"])
    )
    duration = {**stretch.score["flight"], "duration": survey.duration}
    score = {**stretch.score, "launch": launched, "flight": duration, "recording": recording}
    return replace(stretch, events=events, score=score)
