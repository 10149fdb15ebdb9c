"""Recordings of real hardware, replayed and held against their right answers.

A recording is what a TOML file says of some files in a folder:

    title, files            what it is
    map, set, noise         as on the command line of `uavsim replay`
    launches                [from, to], s of the log, for each launch: its onset, and when it has to be recognised by
    lasts                   [from, to], s, in which a force lasts and is found again each second; nothing false
    allowed_flags           channels whose flags are right; without it, flags are not judged
    over_ground             true: the difference to the speed over ground is within both error bars
    coverage, error         of the airspeed against the log's reference: at least, and RMSE at most, m/s

The answers lie beside the files, or in a folder of their own. A file that none of them names is replayed by itself,
and what it gives is told without a verdict.
"""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sensors.bench_log import listed
from uavsim.logs import read_log, replay_log
from uavsim.logs.aired import with_airspeed
from uavsim.logs.airspeed import air_settings

LARGEST_ANSWER = 100_000  # bytes
SIDE_FILES = {".md", ".txt", ".toml", ".json", ".png", ".html", ".pdf"}  # of a folder that are no logs
WORDS = {
    "title": str, "files": list, "map": str, "set": list, "noise": str, "launches": list, "lasts": list,
    "allowed_flags": list, "over_ground": bool, "coverage": float, "error": float,
}  # fmt: skip

Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Answer:
    """What is known of a recording; see the module."""

    title: str
    files: tuple[str, ...]
    map: str | None = None
    set: tuple[str, ...] = ()
    noise: str | None = None
    launches: tuple[Span, ...] | None = None
    lasts: tuple[Span, ...] = ()
    allowed_flags: tuple[str, ...] | None = None
    over_ground: bool = False
    coverage: float | None = None
    error: float | None = None


@dataclass(frozen=True, slots=True)
class Replayed:
    """What a replay gave.

    Attributes
    ----------
    title : str
    expected, found : int or None
        Launches that there are, and those of them that were recognised in time; None: nobody knows.
    delays : tuple of float
        From each onset to its recognition, s.
    false_alarms : int or None
    airspeed : mapping
        Figures of the score: rmse, coverage_95, valid_fraction, flags; over_ground.
    wrong : tuple of str
        What is not as it should be, a sentence each.
    judged : bool
        Whether there is an answer.
    """

    title: str
    expected: int | None
    found: int | None
    delays: tuple[float, ...]
    false_alarms: int | None
    airspeed: Mapping[str, Any] = field(default_factory=dict)
    wrong: tuple[str, ...] = ()
    judged: bool = True


def read_answer(path: Path) -> Answer:
    """Read what is known of a recording; ValueError, one line, if it is not as the module says."""
    if path.stat().st_size > LARGEST_ANSWER:
        raise ValueError(f"{path}: more than {LARGEST_ANSWER} bytes")
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: {error}") from None
    for name, value in values.items():
        if name not in WORDS:
            raise ValueError(f"{path}: {name!r} is no word of an answer; they are {listed(list(WORDS))}")
        kind = WORDS[name]
        if not (isinstance(value, kind) or (kind is float and isinstance(value, int) and not isinstance(value, bool))):
            raise ValueError(f"{path}: {name} must be a {kind.__name__}")
    if not values.get("files"):
        raise ValueError(f"{path}: files = […] is missing")
    for name in ("launches", "lasts"):
        if name in values:
            values[name] = tuple(_span(path, name, one) for one in values[name])
    lists = {name: tuple(values[name]) for name in ("files", "set", "allowed_flags") if name in values}
    return Answer(**({"title": path.stem} | values | lists))


def _span(path: Path, name: str, value: Any) -> Span:
    if not (isinstance(value, list) and len(value) == 2 and all(isinstance(one, int | float) for one in value)):
        raise ValueError(f"{path}: {name} must be pairs of times, [[from, to], …]")
    return float(value[0]), float(value[1])


def answers_for(folder: Path, places: Iterable[Path]) -> list[Answer]:
    """Return those answers of `places` whose files the folder has, and one for each file that none of them names."""
    known = [read_answer(path) for place in places for path in sorted(place.glob("*.toml"))]
    here = [answer for answer in known if all((folder / name).is_file() for name in answer.files)]
    named = {name for answer in here for name in answer.files}
    rest = [
        path.name
        for path in sorted(folder.iterdir())
        if path.is_file() and path.suffix.lower() not in SIDE_FILES and path.name not in named
    ]
    return [*here, *(Answer(name, (name,)) for name in rest)]


def replayed(folder: Path, answers: Iterable[Answer]) -> Iterator[Replayed]:
    """Replay each recording of a folder and judge it; one that cannot be read is told, too."""
    for answer in answers:
        try:
            score, events = _replay(folder, answer)
        except (ValueError, OSError) as error:
            yield Replayed(answer.title, None, None, (), None, wrong=(str(error),), judged=answer.launches is not None)
        else:
            yield judged(answer, score, events)


def _replay(folder: Path, answer: Answer) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    settings = air_settings(answer.set, answer.noise)
    chosen = settings.scenario.detector if any(key.startswith("detector.") for key in settings.named) else None
    recording = read_log([folder / name for name in answer.files], answer.map)
    flight = with_airspeed(replay_log(recording, chosen), recording, settings)
    return flight.score, flight.events


def judged(answer: Answer, score: Mapping[str, Any], events: Iterable[Mapping[str, Any]]) -> Replayed:
    """Hold a replay's score and events against what is known."""
    detections = list(score["recording"]["detections"])
    air = score["recording"].get("airspeed") or {}
    figures = {name: score["airspeed"][name] for name in ("rmse", "coverage_95", "valid_fraction", "flags")}
    figures["over_ground"] = air.get("over_ground")
    if answer.launches is None:
        return Replayed(answer.title, None, len(detections), (), None, figures, judged=False)
    wrong, delays, left = [], [], list(detections)
    for start, end in answer.launches:
        hit = next((t for t in left if start <= t <= end), None)
        if hit is None:
            wrong.append(f"no launch recognised from {start:g} to {end:g} s")
        else:
            delays.append(hit - start)
            left.remove(hit)
    false = [t for t in left if not any(start <= t <= end for start, end in answer.lasts)]
    if false:
        wrong.append(f"{len(false)} false alarms, the first at {false[0]:.3f} s")
    wrong += _wrong_airspeed(
        answer, figures, air, [str(e.get("channel")) for e in events if e["event"] == "airspeed_fault"]
    )
    return Replayed(answer.title, len(answer.launches), len(delays), tuple(delays), len(false), figures, tuple(wrong))


def _wrong_airspeed(
    answer: Answer, figures: Mapping[str, Any], air: Mapping[str, Any], flags: list[str]
) -> Iterator[str]:
    if answer.allowed_flags is not None:
        false = [channel for channel in flags if channel not in answer.allowed_flags]
        if false:
            yield f"{len(false)} false flags, the first of the {false[0]} port"
    ground = figures["over_ground"]
    if answer.over_ground and not (ground and ground["within"]):
        yield (
            "no speed over ground over two turns"
            if not ground
            else (f"the airspeed is {ground['difference']:+.2f} m/s off the speed over ground, beyond both error bars")
        )
    for name, wanted, low in (("coverage_95", answer.coverage, True), ("rmse", answer.error, False)):
        value = figures[name]
        if wanted is not None and (value is None or (value < wanted if low else value > wanted)):
            yield f"{name} is {'not there' if value is None else f'{value:.3g}'}, and {wanted:g} is asked for"
    if (answer.coverage is not None or answer.error is not None) and air.get("reference") is None:
        yield "the log has no reference airspeed"
