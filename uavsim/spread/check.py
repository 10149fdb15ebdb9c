"""Whether a scenario's dispersions can be drawn: keys, parameters, bounds, correlations; errors are one line."""

from collections.abc import Callable
from typing import Any

from sensors.choice import shown
from uavsim.settings import SettingError
from uavsim.spread.correlated import SINGULAR, groups, matrix
from uavsim.spread.distribution import LEAST_SHARE, NORMALS, Distribution, distribution
from uavsim.spread.key import OF_PROPERTIES, Bounds, Key, find
from uavsim.spread.read import unread
from uavsim.spread.settings import Correlation, Dispersion

LEAST = 1e-9  # probability of a value out of its key's bounds from which a dispersion is refused
MOST_TRIED = 300  # values: 0.4 s
WHERE = "dispersions"
FIXED = {
    "name": "names the scenario",
    "description": "is for people",
    "expect": "is what the flight is judged by",
    "seed": "is what everything is drawn from",
    "index": "is what everything is drawn from",
}
"""Keys that are not what flies."""

NEEDS = {
    "normal": (("sd",), ("mean",)),
    "truncated-normal": (("sd",), ("mean", "low", "high")),
    "uniform": (("low", "high"), ()),
    "choice": (("values",), ("weights",)),
}
"""Parameters that a distribution must have, and those that it may have."""

Try = Callable[[Any, dict[str, Any]], Any]


def check(scenario: Any, tried: Try) -> None:
    """Refuse what cannot be drawn.

    Parameters
    ----------
    scenario
        A scenario that is right but for its dispersions.
    tried
        Gives the scenario other values of some keys, and raises SettingError if it cannot have them.

    Raises
    ------
    SettingError
        One line that names the dispersion and what is allowed.
    """
    if not scenario.dispersions:
        return
    found: dict[str, tuple[Key, Distribution]] = {}
    for i, one in enumerate(scenario.dispersions):
        where = f"{WHERE}[{i}] ({shown(one.key)})"
        key = _key(scenario, one, where)
        twice = next((k for k, _ in found.values() if _overlap(k, key)), None)
        if twice is not None:
            raise SettingError(f"{where}: {twice.name} is dispersed already", WHERE)
        _check_parameters(one, where)
        _check_type(key, one, where)
        drawn = _distribution(key, one, key.own(scenario), where)
        _check_bounds(key, one, drawn, where)
        found[one.key] = key, drawn
    _check_values(scenario, found, tried)
    _check_correlations(scenario.dispersions, scenario.correlations)


def _key(scenario: Any, one: Dispersion, where: str) -> Key:
    try:
        key = find(scenario, one.key)
    except SettingError as error:
        raise SettingError(f"{where}: {error.problem}", WHERE) from None
    if one.key in FIXED:
        raise SettingError(f"{where}: it {FIXED[one.key]} and cannot be dispersed", WHERE)
    if not key.single:
        raise SettingError(f"{where}: is no number, text or truth; of a list of numbers give an entry, KEY[0]", WHERE)
    if why := unread(scenario, key.name):
        raise SettingError(f"{where}: {why}", WHERE)
    return key


def _overlap(one: Key, other: Key) -> bool:
    short = min(len(one.path), len(other.path))
    return one.path[:short] == other.path[:short]


def _check_parameters(one: Dispersion, where: str) -> None:
    needed, may = NEEDS[one.distribution]
    given = [name for name in ("mean", "sd", "low", "high") if getattr(one, name) is not None]
    given += [name for name in ("values", "weights") if getattr(one, name)]
    lacking = [name for name in needed if name not in given]
    if one.distribution == "truncated-normal" and one.low is None and one.high is None:
        lacking.append("low or high")
    if lacking:
        raise SettingError(f"{where}: {one.distribution!r} needs {' and '.join(lacking)}", WHERE)
    if more := [name for name in given if name not in (*needed, *may)]:
        raise SettingError(
            f"{where}: {one.distribution!r} has no {' and no '.join(more)}; it has {', '.join((*needed, *may))}", WHERE
        )
    if one.low is not None and one.high is not None and one.low >= one.high:
        raise SettingError(f"{where}: low = {one.low:g} must be below high = {one.high:g}", WHERE)
    if one.weights and len(one.weights) != len(one.values):
        raise SettingError(
            f"{where}: has {len(one.weights)} weights and {len(one.values)} values; give each value one", WHERE
        )
    if one.weights and not any(one.weights):
        raise SettingError(f"{where}: weights must not all be 0", WHERE)


def _check_type(key: Key, one: Dispersion, where: str) -> None:
    choice, numeric = one.distribution == "choice", key.number is not None
    if not choice and not numeric:
        raise SettingError(f"{where}: takes no number; of texts and truths only 'choice' can draw", WHERE)
    if key.number is int and one.distribution in NORMALS:
        raise SettingError(f"{where}: takes whole numbers, which only 'uniform' and 'choice' draw", WHERE)
    if one.relative and key.number is not float:
        raise SettingError(f"{where}: relative is a factor on a number, and it takes no number with a fraction", WHERE)
    if one.relative and choice and not all(_is_number(value) for value in one.values):
        raise SettingError(f"{where}: relative values are factors, so each must be a number", WHERE)
    if key.number is int and not choice:
        for name, end in (("low", one.low), ("high", one.high)):
            if end is not None and end != int(end):
                raise SettingError(f"{where}: takes whole numbers, so {name} = {end:g} must be one", WHERE)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _distribution(key: Key, one: Dispersion, own: Any, where: str) -> Distribution:
    wants_own = one.relative or (one.distribution in NORMALS and one.mean is None)
    if wants_own and not _is_number(own):
        place = "[aircraft.properties]" if key.name.startswith(OF_PROPERTIES) else "the scenario"
        has = f"has no value of its own in {place}" if own is None else f"is {shown(own)} in the scenario"
        raise SettingError(f"{where}: {has}, so give {'it one' if one.relative else 'mean'}", WHERE)
    if one.relative and own == 0:
        raise SettingError(f"{where}: is 0, and no factor changes that; give its parameters without relative", WHERE)
    drawn = distribution(one, own, key.number)
    if one.distribution == "truncated-normal" and drawn.left < LEAST_SHARE:
        raise SettingError(
            f"{where}: only {drawn.left:.1g} of the normal distribution lies from low to high; at least "
            f"{LEAST_SHARE:g} must",
            WHERE,
        )
    return drawn


def _check_bounds(key: Key, one: Dispersion, drawn: Distribution, where: str) -> None:
    if one.distribution == "choice":
        for value in drawn.values:
            try:
                key.checked(value)
            except SettingError as error:
                raise SettingError(f"{where}: {error.problem}", WHERE) from None
        return
    bounds: Bounds = key.bounds
    for share, side, bound in (
        (drawn.below(bounds.low), "below", bounds.low),
        (drawn.above(bounds.high), "above", bounds.high),
    ):
        if share >= LEAST:
            end = "low" if side == "below" else "high"
            other = "" if one.distribution == "uniform" else f" or use truncated-normal with {end}"
            raise SettingError(
                f"{where}: {_percent(share)} of draws would be {side} {bound:g}, which it cannot be; narrow it{other}",
                WHERE,
            )


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _check_values(scenario: Any, found: dict[str, tuple[Key, Distribution]], tried: Try) -> None:
    """Try ends and choices, one at a time beside the medians of all others.

    So what no bound of a single key tells is said when the file is read; of what is drawn together only a flight can.
    """
    medians = {name: drawn.median for name, (_, drawn) in found.items()}
    try:
        central = tried(scenario, medians)
    except SettingError as error:
        raise SettingError(f"{WHERE}, each at its median or first value: {error.problem}", WHERE, *error.keys) from None
    values = [(name, value) for name, (_, drawn) in found.items() for value in drawn.tried if value != medians[name]]
    for name, value in values[:MOST_TRIED]:
        where = f"{WHERE} ({name}), value {shown(value)}"
        try:
            one = tried(central, {name: value})
        except SettingError as error:
            raise SettingError(f"{where}: {error.problem}", WHERE, *error.keys) from None
        if name.endswith(".kind"):
            for other in found:
                if why := unread(one, other):
                    raise SettingError(f"{where}: {other}, which is dispersed too, {why}", WHERE)


def _check_correlations(dispersions: tuple[Dispersion, ...], correlations: tuple[Correlation, ...]) -> None:
    normal = {one.key: one.distribution == "normal" for one in dispersions}
    seen: set[frozenset[str]] = set()
    for i, correlation in enumerate(correlations):
        where, pair = f"correlations[{i}]", correlation.between
        if pair[0] == pair[1]:
            raise SettingError(f"{where}.between = {shown(list(pair))}: must be two different keys", "correlations")
        for key in pair:
            if key not in normal:
                raise SettingError(
                    f"{where}: {shown(key)} is not dispersed; there are {', '.join(normal)}", "correlations"
                )
            if not normal[key]:
                raise SettingError(
                    f"{where}: {key} is not drawn from a normal distribution; only such go together", "correlations"
                )
        if frozenset(pair) in seen:
            raise SettingError(f"{where}: {pair[0]} and {pair[1]} are correlated already", "correlations")
        seen.add(frozenset(pair))
    for group in groups(list(normal), correlations):
        _check_matrix(group, correlations)


def _check_matrix(group: list[str], correlations: tuple[Correlation, ...]) -> None:
    import numpy as np

    values, vectors = np.linalg.eigh(np.array(matrix(group, correlations)))
    if values[0] >= -SINGULAR:
        return
    shares = np.abs(vectors[:, 0])
    concerned = [key for key, share in zip(group, shares, strict=True) if share > 0.1 * shares.max()]
    raise SettingError(
        f"correlations: coefficients of {', '.join(concerned)} cannot all be so: the matrix has the eigenvalue "
        f"{values[0]:.3g}, and none may be below 0",
        "correlations",
    )
