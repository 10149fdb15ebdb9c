"""Why no launch was detected in a log: what was seen, what the detector needs, and what would have seen something.

Seen is the greatest force along each signed axis, and for how long it stayed above the detector's level. The nearest
setting is looked for around the greatest forces, averaged over 20 ms: the same rule along other axes, the same rule
with a lower level, the highest that is enough, and the other kinds as they are shipped. Whether what they see is a
launch nobody can tell from a force alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, get_args

import numpy as np

from uavsim.logs.doubt import need_of
from uavsim.logs.mounting import UP, advised, opposite
from uavsim.logs.recording import Array, Recording
from uavsim.onboard import launch
from uavsim.onboard.launch.settings import if_known, with_key
from uavsim.truth import STANDARD_GRAVITY

G0 = STANDARD_GRAVITY
MEAN = 0.02  # s, over which forces are averaged to find the greatest: one shock is not taken for a stroke
AROUND = (3.0, 1.5)  # s before and after the greatest force that a rule looks at
PLACES = 3  # greatest forces along each axis that are looked at
LOWEST = 1.8 * G0  # m/s², level below which no launch is looked for: handling has nearly as much, a throw 2.4 g
STEPS = 20  # levels that are tried
STEADY, STRETCHES = (0.7, 0.1), 6  # s before a detection along another axis, in so many stretches
UNSTEADY = 0.5 * G0  # m/s², by which the means of the stretches differ in flight; those of a rail that shakes do not
PULL, PULL_FOR = 1.5 * G0, (0.08, 1.0)  # m/s² and s of a pull against the launch that a reading that wraps shows, too
PULL_EDGE = 0.03  # s, or two readings, in which it begins or ends
SKEW = 0.34  # of a force, along a second axis: 20° off the first
WORTH = 1.3 * G0  # m/s², force along an axis from which on it is looked at


@dataclass(frozen=True, slots=True)
class Seen:
    """What there is along a signed axis.

    Attributes
    ----------
    axis : str
    greatest : float
        m/s².
    time : float
        When, s.
    above : float
        Longest time for which it stayed above the level of the detector, s.
    """

    axis: str
    greatest: float
    time: float
    above: float


@dataclass(frozen=True, slots=True)
class Nearest:
    """A setting that would have seen something: as it is given to `--set`, what it reads, and when it detects, s."""

    set: str
    axis: str
    detected: float


@dataclass(frozen=True, slots=True)
class Unseen:
    """Why there was no detection.

    Attributes
    ----------
    level : float, optional
        That the detector needs, m/s², for `lasting` s; None if its kind does not say.
    level_key, time_key : str
        Keys of the detector that say so.
    axes : tuple of str
        That it reads.
    seen : tuple of Seen
    nearest : tuple of Nearest
    """

    level: float | None
    lasting: float | None
    level_key: str
    time_key: str
    axes: tuple[str, ...]
    seen: tuple[Seen, ...]
    nearest: tuple[Nearest, ...]

    def document(self) -> dict[str, Any]:
        """Return it as plain values."""
        plain = asdict(self)
        return plain | {name: list(plain[name]) for name in ("axes", "seen", "nearest")}

    @property
    def forward(self) -> str | None:
        """The axis that the detector does not read along which the greatest force like a launch's lies."""
        return forward_in(self.document())

    def remarks(self, recording: Recording, up: str | None) -> list[str]:
        """Say which force lies along an axis that the detector does not read, of a recording of which up is known."""
        greatest = {one.axis: one for one in self.seen}
        others = [
            f"a force like a launch's lies along {one.axis.replace('-', '−')}, "
            f"{greatest[one.axis].greatest / G0:.3g} g at {greatest[one.axis].time:.3f} s, and the detector reads "
            f"{' or '.join(self.axes)}: {mend} makes it fx"
            for one in self.nearest
            if one.axis not in self.axes
            for mend in [_mend(one, recording, up)]
        ]
        told = {one.axis for one in self.nearest}
        against = [opposite(axis) for axis in self.axes if len(self.axes) == 1 and opposite(axis) not in told]
        askew = [] if others else _askew(recording, self)
        return [*others, *askew, *(said for axis in against for said in _pulls(recording, axis))]


def forward_in(document: Mapping[str, Any]) -> str | None:
    """Return `Unseen.forward` of its plain values."""
    others = [one["axis"] for one in document["nearest"] if one["axis"] not in document["axes"]]
    greatest = {one["axis"]: one["greatest"] for one in document["seen"]}
    return max(others, key=lambda axis: greatest[axis], default=None)


def _askew(recording: Recording, why: Unseen) -> list[str]:
    """Name a force that is above the level between two axes, and along neither of them."""
    if why.level is None:
        return []
    n = max(1, round(MEAN * recording.rate))
    force = np.nan_to_num(recording.readings[:, 1:])
    if len(force) <= n:
        return []
    away = force - np.median(force, axis=0)
    mean = np.column_stack([np.convolve(column, np.full(n, 1.0 / n), mode="same") for column in away.T])
    at = int(np.argmax(np.linalg.norm(mean, axis=1)))
    push, whole = mean[at], float(np.linalg.norm(mean[at]))
    first, second = np.argsort(-np.abs(push))[:2].tolist()
    if whole < why.level or abs(push[second]) < SKEW * whole:
        return []
    named = [f"{'+' if push[i] > 0.0 else '−'}{'xyz'[i]} {abs(push[i]) / G0:.3g} g" for i in (first, second)]
    return [
        f"a force of {whole / G0:.3g} g at {recording.readings[at, 0]:.3f} s lies between two axes, "
        f"{' and '.join(named)}: a sensor mounted askew; turn its readings before they are replayed, for a map "
        "turns by quarters only"
    ]


def _pulls(recording: Recording, axis: str) -> list[str]:
    """Name the first pull that begins or ends at once, along an axis against that of the launch."""
    t, f = recording.readings[:, 0], _force(recording.readings, axis)
    edges = np.diff(np.concatenate(([0], (f > PULL).astype(np.int8), [0])))
    for first, stop in zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True):
        lasting = float(t[stop - 1] - t[first])
        if not PULL_FOR[0] <= lasting <= PULL_FOR[1]:
            continue
        level = float(np.median(f[first:stop]))
        n = max(2, round(PULL_EDGE * recording.rate))
        before, after = f[max(0, first - n)], f[min(f.size - 1, stop + n - 1)]
        if level > PULL and min(abs(before), abs(after)) < 0.3 * level:
            return [
                f"f_{axis[1]} pulls backwards, along {axis.replace('-', '−')}, with {level / G0:.3g} g for "
                f"{lasting:.2g} s from {t[first]:.3f} s on: an arrest, or a wrap, as of a push of more than the "
                "reading's integer can hold"
            ]
    return []


def _mend(one: Nearest, recording: Recording, up: str | None) -> str:
    """Return what makes an axis be read: a map, or the setting where that alone leaves no doubt of the axes."""
    turn = advised(recording.mapping, recording.origins, one.axis, up)
    return f"--set {one.set} reads it, and {turn}" if one.set and up in (None, UP, one.axis) else turn


def unseen(recording: Recording, settings: launch.DetectorSettings) -> Unseen:
    """Explain why a detector saw nothing in a recording.

    Parameters
    ----------
    recording
        In which it saw nothing.
    settings
        Of the detector.
    """
    need, rate = need_of(settings), recording.rate
    axes = get_args(launch.Axis) if settings.axes == "any" else settings.axes
    level = None if need is None else need.level
    seen = [_along(recording, axis, np.inf if level is None else level) for axis in get_args(launch.Axis)]
    there = sorted((one for one in seen if one is not None), key=lambda one: one.axis not in axes)
    worth = [one.axis for one in there if one.greatest >= WORTH]
    places = {axis: _places(recording, axis) for axis in worth}
    nearest = [*_other_axes(recording, settings, axes, places), *_lower(recording, settings, axes, places)]
    nearest += _other_kinds(recording, settings, axes, places)
    return Unseen(
        level,
        None if need is None else max(need.time, 1.0 / rate),
        "" if need is None else need.level_key,
        "" if need is None else need.time_key,
        tuple(axes),
        tuple(there),
        tuple(nearest),
    )


def _force(readings: Array, axis: str) -> Array:
    f: Array = readings[:, 1 + "xyz".index(axis[1])]
    return f if axis[0] == "+" else -f


def _along(recording: Recording, axis: str, level: float) -> Seen | None:
    """Return what there is along an axis; None if the log has no number of it, or nothing of that sign."""
    t, f = recording.readings[:, 0], _force(recording.readings, axis)
    if not np.isfinite(f).any() or not np.nanmax(f) > 0.0:
        return None
    at = int(np.nanargmax(f))
    edges = np.diff(np.concatenate(([0], (f > level).astype(np.int8), [0])))
    starts, stops = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    lasting = t[stops - 1] - t[starts] + 1.0 / recording.rate
    return Seen(axis, float(f[at]), float(t[at]), float(lasting.max()) if lasting.size else 0.0)


def _places(recording: Recording, axis: str) -> list[Array]:
    """Return the readings around the greatest forces along an axis, each on one clock."""
    t, f = recording.readings[:, 0], np.nan_to_num(_force(recording.readings, axis))
    n = max(1, round(MEAN * recording.rate))
    mean = np.convolve(f, np.full(n, 1.0 / n), mode="same") if f.size > n else f
    left, found = mean.copy(), []
    for _ in range(PLACES):
        at = int(np.argmax(left))
        if left[at] < WORTH:
            break
        part = next(p for p in recording.parts if p.start <= at < p.stop)
        first = max(part.start, at - round(AROUND[0] * recording.rate))
        last = min(part.stop, at + round(AROUND[1] * recording.rate))
        near = recording.readings[first:last]
        found.append(near[(near[:, 0] >= t[at] - AROUND[0]) & (near[:, 0] <= t[at] + AROUND[1])])
        left[first:last] = 0.0
    return found


def _first(settings: launch.DetectorSettings, rate: float, places: Sequence[Array]) -> float | None:
    """Time of the first detection around the greatest forces, s."""
    times = []
    for readings in places:
        try:
            detector = launch.build(settings, rate)
        except ValueError:  # it does not fit the rate
            return None
        # A step between kept rows is a gap of the log: what comes before is another place.
        times += [row[0] for row in readings.tolist() if detector.step(*row)][:1]
    return min(times, default=None)


def _other_axes(
    recording: Recording, settings: launch.DetectorSettings, axes: Sequence[str], places: dict[str, list[Array]]
) -> Iterator[Nearest]:
    """Try the same rule along the axes that it does not read; ours for one that can read no other."""
    if settings.axes == "any":
        return
    ours = if_known(settings).ours
    base = settings if ours else launch.DetectorSettings()
    kind = "" if ours else f"detector.kind={base.kind} --set "
    for axis, near in places.items():
        if axis not in axes:
            other = replace(base, axes=(axis,))  # type: ignore[arg-type]
            quick = launch.DetectorSettings(axes=(axis,))  # type: ignore[arg-type]
            times = [(_first(other, recording.rate, [one]), one) for one in near]
            begins = [(t, _first(quick, recording.rate, [one]), one) for t, one in times if t is not None]
            # A rule with a delay detects in the stroke or behind it: what was before is told by one without.
            found = min((t for t, b, one in begins if _from_rest(one, t if b is None else min(t, b))), default=None)
            if found is not None:
                yield Nearest(f"{kind}'detector.axes=[\"{axis}\"]'", axis, found)


def _from_rest(readings: Array, t: float) -> bool:
    """Whether the force was steady before a time, s: a launch begins so, a pull-up in flight does not."""
    before = readings[(readings[:, 0] > t - STEADY[0]) & (readings[:, 0] < t - STEADY[1])]
    means = [
        np.nanmean(part[:, 1:], axis=0)
        for part in np.array_split(before, STRETCHES)
        if len(part) and np.isfinite(part[:, 1:]).any(axis=0).all()
    ]
    sizes = [float(np.linalg.norm(mean)) for mean in means]
    return not sizes or max(sizes) - min(sizes) < UNSTEADY


def _lower(
    recording: Recording, settings: launch.DetectorSettings, axes: Sequence[str], places: dict[str, list[Array]]
) -> Iterator[Nearest]:
    """Try the same rule with lower levels; the highest that sees something."""
    need = need_of(settings)
    for axis in axes:
        if need is None or axis not in places or need.level <= LOWEST:
            continue
        for level in np.linspace(need.level, LOWEST, STEPS + 1)[1:].round(1).tolist():
            found = _first(with_key(settings, need.level_key, level), recording.rate, places[axis])
            if found is not None:
                yield Nearest(f"detector.{need.level_key}={level:g}", axis, found)
                break


def _other_kinds(
    recording: Recording, settings: launch.DetectorSettings, axes: Sequence[str], places: dict[str, list[Array]]
) -> Iterator[Nearest]:
    """Try the other kinds as they are shipped."""
    for kind in launch.KINDS.values():
        if not kind.ours or kind.name == if_known(settings).name:
            continue
        for axis in axes:
            chosen = launch.DetectorSettings(kind=kind.name, axes=(axis,))  # type: ignore[arg-type]
            found = _first(chosen, recording.rate, places[axis]) if axis in places else None
            if found is not None:
                yield Nearest(f"detector.kind={kind.name}", axis, found)
                break
