"""The launch detector run over a recording, from its first reading to its last."""

from array import array
from collections.abc import Iterator
from dataclasses import asdict, replace
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim import __version__
from uavsim.failure import FAILED, PartError
from uavsim.files import without_none
from uavsim.flight import Flight, frame
from uavsim.logs.doubt import backwards, doubted, ends, oriented, settled
from uavsim.logs.evidence import collected
from uavsim.logs.informed import sources, telling
from uavsim.logs.recording import AXES, COLUMNS, Array, Recording
from uavsim.logs.unseen import unseen
from uavsim.logs.watch import PAUSE
from uavsim.onboard import launch
from uavsim.onboard.launch.guarded import STATE
from uavsim.onboard.launch.settings import kind_of
from uavsim.plugins import plugged_in
from uavsim.score_keys import FLIGHT, INSTALLATION, INTEGRITY, PHASES, PRESSURE, PRESSURES, no_airspeed

LOT = 50_000  # readings that are plain numbers at once


def replay_log(recording: Recording, settings: launch.DetectorSettings | None = None) -> Flight:
    """Run the launch detector over a recording.

    After a detection the detector is left alone for `PAUSE`, then reset: later ones are found, too, and a force that
    lasts longer than that is found again.

    Parameters
    ----------
    recording
        Readings.
    settings
        Of the detector; without, it is that of the packaged scenarios.

    Returns
    -------
    Flight
        Tables 'accelerometer' and 'detector' (every reading); an event ``launch_detected`` a detection; a score with
        ``launch.detected_time`` (the first), null for what needs the truth, and ``recording``: files, rate, gaps,
        clipping, all detections. Its ``scenario`` says what was replayed, and does not fly.
    """
    rate = recording.rate
    used = launch.DetectorSettings() if settings is None else settings
    check_axes(recording, used)
    evidence = collected(recording.readings, rate)
    recording = doubted(recording, used, evidence)
    columns, detections, reason = _watch(used, recording)
    t, fx, fy, fz = recording.readings.T
    tables = {
        "accelerometer": frame("accelerometer", {"t": t, "fx": fx, "fy": fy, "fz": fz}),
        "detector": frame("detector", {"t": t[: columns["recognised"].size], **columns}),
    }
    events = [{"t": when, "event": "launch_detected"} for when in detections]
    about: dict[str, Any] = {
        "name": recording.files[0],
        "recording": {"files": list(recording.files), "map": recording.mapping, "rate": rate},
        "detector": asdict(used),
    }
    told = sources(launch.build(used, rate), recording.series)
    recording = replace(recording, remarks=(*recording.remarks, *told, *backwards(recording, used, detections)))
    up, forward = settled(recording, evidence), None
    score = _score(recording, used.kind, detections)
    if not detections and not reason:
        why = unseen(recording, used)
        forward = why.forward
        said = why.remarks(recording, None if up is None else up[0])
        score["recording"] |= {"unseen": why.document(), "remarks": [*recording.remarks, *said]}
    score["recording"]["remarks"] += oriented(recording, used, up, forward, launched=bool(detections))
    if reason:
        score |= {"outcome": FAILED, "reason": reason}
    return Flight(about, tables, events, score)


def check_axes(recording: Recording, settings: launch.DetectorSettings) -> None:
    """Refuse a log that lacks an axis which the detector reads; one of one axis reads no other."""
    needed: tuple[str, ...] = AXES
    if settings.axes != "any" and len(settings.axes) == 1 and kind_of(settings).ours:
        needed = (f"f{settings.axes[0][1]}",)
    if lacking := [axis for axis in needed if axis not in recording.axes]:
        raise ValueError(
            f"the detector reads {', '.join(needed)}, and the log holds no {', '.join(lacking)}: map it, or set "
            "detector.axes to what there is"
        )


def _watch(settings: launch.DetectorSettings, recording: Recording) -> tuple[dict[str, NDArray[Any]], list[float], str]:
    """Return the detector's state at each reading, when it recognised a launch, and what ended it before the end.

    Each part of the recording, whose clock began anew or whose rate is another, has a detector of its own. An axis
    that the log does not hold at all reads 0: a detector that reads it was refused.
    """
    state = {name: array("d") for name in STATE}
    recognised, detections, reason = array("b"), [], ""
    try:
        for part in recording.parts:
            detector, resume = launch.build(settings, recording.rate_of(part)), np.inf
            readings = filled(recording, part)
            tell = telling(detector, readings[:, 0], recording.series)
            for k, (t, fx, fy, fz) in enumerate(_rows(readings)):
                if tell is not None:
                    tell(k)
                if t >= resume:
                    detector.reset()
                    resume = np.inf
                seen = detector.step(t, fx, fy, fz)
                told = [getattr(detector, name, None) for name in STATE]
                if seen:
                    detections.append(t)
                    resume = t + PAUSE
                for name, value in zip(STATE, told, strict=True):
                    state[name].append(np.nan if value is None else value)
                recognised.append(seen)
    except PartError as failure:
        reason = str(failure)
    columns = {name: _column(np.array(state[name]), of_flags=name == "triggered") for name in STATE}
    return {**columns, "recognised": np.array(recognised, dtype=bool)}, detections, reason


def filled(recording: Recording, part: range) -> Array:
    """Return readings of a part, 0 for axes that the log does not hold at all."""
    readings = recording.readings[part.start : part.stop]
    absent = [COLUMNS.index(axis) for axis in AXES if axis not in recording.axes]
    if absent:
        readings = readings.copy()
        readings[:, absent] = 0.0
    return readings


def _column(values: Array, *, of_flags: bool) -> NDArray[Any]:
    """Return a state of the detector as whole numbers or flags where that is what it tells; NaN where it tells none."""
    if np.isnan(values).any():
        return values
    if of_flags:
        return values.astype(bool)
    return values.astype(np.int64) if (values == np.round(values)).all() else values


def _rows(readings: Array) -> Iterator[list[float]]:
    """Rows as plain numbers; not all at once, for these take six times the memory of an array."""
    for first in range(0, len(readings), LOT):
        yield from readings[first : first + LOT].tolist()


def _score(recording: Recording, kind: str, detections: list[float]) -> dict[str, Any]:
    start, end = recording.span
    return {
        "outcome": None,
        "expected": None,
        "reason": None,
        "seed": None,
        "plugins": [without_none(asdict(source)) for source in plugged_in({"detector": kind})],
        "versions": {"uavsim": __version__, "numpy": version("numpy")},
        "launch": {
            "release_time": None,
            "true_time": None,
            "crossing_time": None,
            "detected_time": detections[0] if detections else None,
            "latency": None,
            "latency_from_crossing": None,
            "detections": len(detections),
            "false_detections": None,
            "detector": kind,
        },
        "airspeed": {
            "estimator": None,
            **no_airspeed(),
            **dict.fromkeys(INTEGRITY),
            **{phase: no_airspeed() for phase in PHASES},
        },
        "pressure": {name: dict.fromkeys(PRESSURE) for name in PRESSURES},
        "flight": {**dict.fromkeys(FLIGHT), "duration": recording.duration},
        "installation": dict.fromkeys(INSTALLATION),
        "requirements": [],
        "remarks": [],
        "recording": {
            "files": list(recording.files),
            "map": recording.mapping,
            "start": start,
            "end": end,
            "readings": len(recording.readings),
            "rate": recording.rate,
            "gaps": [asdict(gap) for gap in recording.gaps()],
            "clipping": [asdict(clipped) for clipped in ends(recording)],
            "detections": detections,
            "unseen": None,
            "pause": PAUSE,
            "remarks": list(recording.remarks),
        },
    }
