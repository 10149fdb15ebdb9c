"""What is doubtful about a log's readings, each said in a sentence that names the setting which mends it.

unit         an accelerometer at rest reads 1 g, wherever it points: 32.2 is ft/s², much more are counts, 0 is a force
             that gravity has been taken from, and what is near 1 g has a scale or an offset that is off
axes         at rest the force points up, along -z in body axes forward-right-down, along +x on a vertical rail
clipping     an extreme that is held while the readings live, or what the log's own counters say
range        a level of the detector that lies beyond what is clipped, less 1 g, as `fly` has it
repeats      readings that stay as they are for far longer than is usual in the log
others       another accelerometer of the same log that does not read the same

What at rest reads 32.2 is taken as ft/s² unless the map has a factor, and it is said. All else is left as it is.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from uavsim.logs.evidence import Evidence, Rest, collected
from uavsim.logs.mounting import UP, advised, forward_of, opposite
from uavsim.logs.recording import AXES, COLUMNS, Array, Clipping, Recording
from uavsim.onboard.launch.kinds import Need
from uavsim.onboard.launch.settings import DetectorSettings, if_known
from uavsim.truth import STANDARD_GRAVITY

G0 = STANDARD_GRAVITY
FOOT = 0.3048  # m
ONE_G = 0.15  # of 1 g, by which rest may be off: the offset of a coarse part is 0.1 g, a scale error 3 %
MOST = 0.5  # part of the quiet blocks that has to agree to say what it reads
SOME = 0.1  # part of them that reads 1 g, from which on the unit is right
IN_FEET = 0.06  # of 1 g in ft/s², likewise: what is further off is no unit but a scale
NOTHING = 0.3 * G0  # m/s², below which gravity has been taken off
ALONG = 0.7  # of 1 g along an axis, from which on that is up: tilted by less than 45°
AVERAGED = 0.1  # s, over which two accelerometers are compared: vibration and lags of some samples are no difference
APART = 0.3  # of 1 g, or of the force itself, by which they may differ: offsets of coarse parts, and their scales
BEFORE = 0.05  # s before a detection, over which its force is averaged
TAKES = ("px4", "px4-norm", "ardupilot", "altos")


def doubted(recording: Recording, settings: DetectorSettings, evidence: Evidence | None = None) -> Recording:
    """Return a recording with remarks on what is doubtful, in m/s² if it is taken to be in ft/s².

    Parameters
    ----------
    recording
        As it was read.
    settings
        Of the detector that will run over it.
    evidence
        What its readings show, if that has been collected already.
    """
    seen = collected(recording.readings, recording.rate) if evidence is None else evidence
    rest = seen.rest()
    remarks = [
        *_unit(rest, recording),
        *_repeats(seen),
        *_dead(seen, settings),
        *_counted(recording),
        *_others(recording),
    ]
    recording = taken(recording, seen)
    remarks += _range(recording, settings)
    return replace(recording, remarks=(*recording.remarks, *remarks))


def scaled(mapping: str) -> bool:
    """Whether a map gives the force a factor: somebody has thought of its unit."""
    return any("*" in entry for entry in mapping.split(",") if entry.strip().partition("=")[0].strip() in AXES)


def is_in_feet(rest: Rest) -> bool:
    """Whether rest reads 1 g in ft/s²."""
    return rest.share(G0, ONE_G) < SOME and rest.share(G0 / FOOT, IN_FEET) >= MOST


def taken(recording: Recording, evidence: Evidence | None = None) -> Recording:
    """Return a recording in m/s²: as it is, or scaled if it is taken to be in ft/s²."""
    seen = collected(recording.readings, recording.rate) if evidence is None else evidence
    factor = unit_of(seen, recording.mapping)
    return recording if factor == 1.0 else replace(recording, readings=recording.readings * ([1.0] + [factor] * 3))


def unit_of(evidence: Evidence, mapping: str) -> float:
    """Return what a log's unit of force is taken for, m/s²: 0.3048 if rest reads 1 g in ft/s² and no map says else."""
    return FOOT if is_in_feet(evidence.rest()) and not scaled(mapping) else 1.0


# -- unit ------------------------------------------------------------------------------------------------------------


def _unit(rest: Rest, recording: Recording) -> Iterator[str]:
    """Doubt the unit by what rest reads."""
    if not rest.sizes.size or rest.share(G0, ONE_G) >= SOME:
        return
    reads, axes = rest.middle, rest.axes
    agree = rest.share(reads, ONE_G) >= MOST
    if is_in_feet(rest):
        taken = "doubtful" if scaled(recording.mapping) else f"taken as ft/s² and scaled by {FOOT}"
        yield (
            f"at rest |f| reads {reads:.1f}, which is 1 g in ft/s² and not in m/s²: {taken}; map fx=…*{FOOT} and so on "
            "to say so, fx=…*1 if it is m/s² all the same"
        )
    elif len(axes) < len(AXES):
        if reads > 1.5 * G0 and agree:
            yield (
                f"at rest {' and '.join(axes)} reads {reads:.4g} m/s², more than 1 g: another unit, or counts? "
                "map it with a factor"
            )
    elif np.mean(rest.sizes <= NOTHING) >= MOST:
        yield (
            f"at rest |f| reads {reads:.2f} m/s², not 1 g: gravity has been taken off, so that this is no specific "
            "force; map the accelerometer's own readings. Without them levels are missed by gravity's part along the "
            f"axis, but those of rules that take it off themselves (detector.kind={', '.join(TAKES)})"
        )
    elif agree and reads > 1.5 * G0:
        yield (
            f"at rest |f| reads {reads:.4g}, which is {reads / G0:.1f} g in m/s²: counts, or another unit? "
            f"map fx=…*{G0 / reads:.4g} and so on, by which rest reads 1 g"
        )
    elif agree:
        yield (
            f"at rest |f| reads {reads / G0:.2f} g and not 1 g: a scale or an offset is off; "
            f"map fx=…*{G0 / reads:.4g} and so on if it is the scale, fx=…+offset if not"
        )


# -- axes ------------------------------------------------------------------------------------------------------------


def up_of(rest: Rest) -> tuple[str, float] | None:
    """Return the signed axis that points up by what rest reads, and what it reads there, g; None if none does."""
    near = np.abs(rest.sizes - G0) <= ONE_G * G0
    if near.mean() < SOME if near.size else True:
        return None
    reads = (np.nan_to_num(np.median(rest.vectors[near], axis=0)) / G0).tolist()
    most = max(range(len(AXES)), key=lambda i: abs(reads[i]))
    if abs(reads[most]) < ALONG:
        return None
    return ("+" if reads[most] > 0.0 else "-") + "xyz"[most], reads[most]


def settled(recording: Recording, evidence: Evidence) -> tuple[str, float] | None:
    """Return `up_of` a recording in m/s², by what was collected before it was brought to that."""
    rest, scale = evidence.rest(), unit_of(evidence, recording.mapping)
    return up_of(Rest(rest.vectors * scale, rest.sizes * scale))


def oriented(
    recording: Recording,
    settings: DetectorSettings,
    up: tuple[str, float] | None,
    forward: str | None = None,
    *,
    launched: bool = False,
) -> list[str]:
    """Doubt the axes of a recording by where up is, and say which map turns them.

    Parameters
    ----------
    recording
        What is replayed.
    settings
        Of the detector.
    up
        As `settled` returns it.
    forward
        Signed axis along which there is a force like a launch's, if it is none that the detector reads.
    launched
        Whether there is one along an axis that it reads.
    """
    along = forward_of(settings.axes) if forward is None else forward
    if up is None or up[0] in (UP, along):
        return []
    axis, reads = up
    down = axis == opposite(along)
    what = {
        "+z": "these axes have z up, and ours have it down",
        "-x": "−x points up, which is a nose that points down",
    }.get(axis, f"{axis.replace('-', '−')} points up, and with us −z does")
    mend = advised(recording.mapping, recording.origins, opposite(along) if down else along, axis)
    said = "" if down and launched else f"; {mend} turns them{', if the nose is up' if down else ''}"
    return [f"at rest f_{axis[1]} reads {reads:+.2f} g: {what}{said}"]


# -- readings that do not live, or end -------------------------------------------------------------------------------


def _repeats(seen: Evidence) -> Iterator[str]:
    """Tell spells in which readings repeat, all axes or one of them."""
    for what, spells in (("readings repeat", seen.repeats), *((f"{a} repeats", of) for a, of in seen.stuck.items())):
        if not spells:
            continue
        longest = max(spells, key=lambda spell: spell.end - spell.start)
        more = f", the longest of {len(spells)} such spells" if len(spells) > 1 else ""
        yield (
            f"{what} for {longest.end - longest.start:.3g} s from {longest.start:.3f} s on ({longest.rows} rows)"
            f"{more}: what happened meanwhile is not in the log, and no launch can be seen in it"
        )


def _dead(seen: Evidence, settings: DetectorSettings) -> Iterator[str]:
    """Tell axes that the detector reads and that never change."""
    for axis, reads in seen.dead.items():
        if settings.axes != "any" and axis[1] in {signed[1] for signed in settings.axes}:
            yield (
                f"{axis} repeats {reads:.4g} m/s² from the first row to the last, while other axes live: it is no "
                "reading, and no launch can be seen along it; map it to one that is"
            )


def backwards(recording: Recording, settings: DetectorSettings, detections: Sequence[float]) -> list[str]:
    """Tell detections of a rule that takes a force in any direction, while the force pulls backwards."""
    if if_known(settings).name != "px4-norm" and settings.axes != "any":
        return []
    t, f = recording.readings[:, 0], recording.readings[:, 1]
    said = []
    for when in detections:
        near = f[(t > when - BEFORE) & (t <= when)]
        mean = float(np.nanmean(near)) if np.isfinite(near).any() else 0.0
        if mean < -G0:
            said.append(
                f"at {when:.3f} s f_x is {mean / G0:.2g} g: the rule goes by the magnitude of the force, and this one "
                "lies along −x, backwards, as of an arrest"
            )
    return said


def counted(recording: Recording) -> Mapping[str, tuple[int, float, float]]:
    """Return what the log's own counters say: how many readings of an axis were clipped, and between which times, s."""
    found = {}
    for axis in AXES:
        series = recording.series.get(f"clips_{axis[1]}")
        if series is None or not np.isfinite(series.values).any():
            continue
        sound = np.isfinite(series.values)
        t, values = series.t[sound], series.values[sound]
        rises = np.flatnonzero(np.diff(values) > 0.0)
        total = int(np.diff(values)[rises].sum())
        found[axis] = (total, float(t[rises[0]]), float(t[rises[-1] + 1])) if total else (0, np.nan, np.nan)
    return found


def _counted(recording: Recording) -> Iterator[str]:
    """Tell what the log's counters say of clipping."""
    for axis, (total, start, end) in counted(recording).items():
        if total:
            yield f"clipping: the log's own counter has {total} readings of {axis} from {start:.3f} to {end:.3f} s"


def _others(recording: Recording) -> Iterator[str]:
    """Tell where the log's other accelerometers read something else."""
    own = _means(recording.readings)
    for name, readings in recording.others.items():
        others = _means(readings)
        both = sorted(own.keys() & others.keys())
        if not both:
            continue
        first, second = (np.array([of[k] for k in both]) for of in (own, others))
        away = np.linalg.norm(np.nan_to_num(first - second), axis=1)
        most = int(np.argmax(away))
        allowed = APART * max(G0, float(np.linalg.norm(np.nan_to_num(first[most]))))
        if away[most] > allowed or float(np.median(away)) > APART * G0:
            yield (
                f"two IMUs disagree: {name} is up to {away[most] / G0:.2g} g away from the one that is replayed (at "
                f"{both[most] * AVERAGED:.2f} s), {float(np.median(away)) / G0:.2g} g in the middle; map fx={name}.… "
                "and so on to replay the other"
            )


def _means(readings: Array) -> dict[int, Array]:
    """Mean force in each stretch of `AVERAGED`, by its number."""
    sound = np.isfinite(readings).all(axis=1)
    numbers = np.floor(readings[sound, 0] / AVERAGED)
    places, which, n = np.unique(numbers, return_inverse=True, return_counts=True)
    means = np.column_stack([np.bincount(which, column, places.size) for column in readings[sound, 1:].T])
    return dict(zip(places.astype(np.int64).tolist(), means / n[:, np.newaxis], strict=True))


def ends(recording: Recording) -> list[Clipping]:
    """Return the axes that are clipped: by the log's own counters where it has them, else by what is held."""
    counts = counted(recording)
    found = [clipped for clipped in recording.clipping() if counts.get(clipped.axis, (1,))[0]]
    known = {clipped.axis for clipped in found}
    t = recording.readings[:, 0]
    for axis, (total, start, end) in counts.items():
        f = recording.readings[(t >= start) & (t <= end), COLUMNS.index(axis)] if total else np.empty(0)
        f = f[np.isfinite(f)]
        if axis not in known and f.size:
            level = float(f[np.argmax(np.abs(f))])
            found.append(Clipping(axis, level, total, start))
    return found


def _range(recording: Recording, settings: DetectorSettings) -> Iterator[str]:
    """Tell a level of the detector that lies beyond what is clipped."""
    need = need_of(settings)
    if need is None or settings.axes == "any":
        return
    for clipped in ends(recording):
        along = ("+" if clipped.level > 0.0 else "-") + clipped.axis[1]
        reach = abs(clipped.level) - G0
        if along in settings.axes and need.level >= reach:
            yield (
                f"range: {clipped.axis} ends at {clipped.level / G0:.3g} g, and detector.{need.level_key} = "
                f"{need.level:g} m/s² ({need.level / G0:.3g} g) can never be sure to be shown; less 1 g of gravity the "
                f"limit is {reach / G0:.3g} g: a part of a wider range is needed, or a lower level"
            )


def need_of(settings: DetectorSettings) -> Need | None:
    """Return what a launch must show at least for the detector, if its kind says so."""
    need = if_known(settings).need
    return None if need is None else need(settings, 2.0 * G0)
