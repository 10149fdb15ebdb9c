"""What columns are called in files of numbers, and what they are: times, forces, and the formats of common loggers.

A map says it; where there is none, names that leave no doubt are taken, and it is told. Betaflight and iNav write
accelerations in counts, forward-left-up. AltOS writes what its filter has of the acceleration along the rocket, from
which the pad's reading is taken: a rocket on its pad points up, and 1 g is added.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sensors.bench_log import Source
from sensors.text import brief
from uavsim.logs.recording import AXES, SERIES
from uavsim.truth import STANDARD_GRAVITY

TIMES = {
    **dict.fromkeys(("t", "time", "timestamp", "time_s", "t_s", "seconds", "secs", "datetime", "utc"), 1.0),
    **dict.fromkeys(
        ("ms", "millis", "time_ms", "t_ms", "timestamp_ms", "milliseconds", "timems", "time_boot_ms"), 1e-3
    ),
    **dict.fromkeys(("us", "micros", "time_us", "t_us", "timestamp_us", "microseconds", "timeus", "time_usec"), 1e-6),
    **dict.fromkeys(("time_ns", "timestamp_ns", "nanoseconds"), 1e-9),
}
"""What a column of times is called, and its unit in s."""
FORCES = (("ax", "ay", "az"), ("acc_x", "acc_y", "acc_z"), ("accx", "accy", "accz"), ("accel_x", "accel_y", "accel_z"))
UNITS = {
    "t": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9},
    "f": {
        **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "m/s/s", "m/s**2", "ms-2"), 1.0),
        **dict.fromkeys(("g", "gs", "gee", "gees"), STANDARD_GRAVITY),
        **dict.fromkeys(("mg",), 1e-3 * STANDARD_GRAVITY),
        **dict.fromkeys(("ft/s2", "ft/s^2", "ft/s²", "ft/s/s"), 0.3048),
    },
}
"""Units that stand behind a name or below it, in SI: of times, of forces."""
WITH_UNIT = re.compile(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]")
COUNTS = (256, 512, 1024, 2048, 4096, 8192, 16384)  # to 1 g, of Betaflight and iNav
CELSIUS = 273.15  # K


@dataclass(frozen=True, slots=True)
class Usual:
    """What columns of ours are, if no map says so.

    Attributes
    ----------
    sources : mapping
        By the names of ours.
    remarks : tuple of str
        What was assumed.
    counts : bool
        Whether the forces are counts, of which 1 g is told by the rest.
    """

    sources: Mapping[str, Source]
    remarks: tuple[str, ...] = ()
    counts: bool = False


def usual(names: Sequence[str], units: Sequence[str], mapped: Mapping[str, Source], *, named: bool) -> Usual:
    """Tell ours by the names of a table's columns, as far as the map leaves them open.

    Parameters
    ----------
    names, units
        Of the columns; units may be fewer.
    mapped
        What the map says.
    named
        Whether the file has names at all; else names are numbers.
    """
    if not named:
        return _by_number(names, mapped)
    for told in (_betaflight, _altos):
        found = told(names)
        if found is not None:
            sources = {ours: source for ours, source in found.sources.items() if ours not in mapped}
            force_mapped = any(axis in mapped for axis in AXES)
            if force_mapped:
                sources = {ours: source for ours, source in sources.items() if ours not in AXES}
            return Usual(sources, found.remarks, found.counts and not force_mapped)
    return _by_name(names, units, mapped)


def _by_number(names: Sequence[str], mapped: Mapping[str, Source]) -> Usual:
    if mapped or len(names) != 4:
        return Usual({})
    ours = ("t", *AXES)
    said = "columns 1 to 4 are taken for t, fx, fy, fz, for the file has no names (--map t=1,fx=2,… says it otherwise)"
    return Usual({name: Source(str(i + 1)) for i, name in enumerate(ours)}, (said,))


def _by_name(names: Sequence[str], units: Sequence[str], mapped: Mapping[str, Source]) -> Usual:
    """Take names that leave no doubt, with the unit that stands behind or below them."""
    below = dict(zip(names, units, strict=False))
    plain: dict[str, tuple[str, str]] = {}  # by what it is called: the column, and its unit
    for name in names:
        match = WITH_UNIT.fullmatch(name)
        called, unit = (match[1], match[2]) if match else (name, "")
        plain.setdefault(called.casefold().strip(), (name, unit or below.get(name, "").strip("[]() ")))
    sources: dict[str, Source] = {}
    remarks: list[str] = []
    if "t" not in mapped:
        _take(("t",), "t", [(name,) for name in TIMES], plain, sources, remarks)
    if not any(axis in mapped for axis in AXES):
        for called in (AXES, *FORCES):
            if called[0] in plain:
                _take(AXES, "f", [called], plain, sources, remarks)
                break
    for name in SERIES:
        if name not in mapped and name not in names and name in plain:
            sources[name] = Source(plain[name][0])
    return Usual(sources, tuple(remarks))


def _take(
    ours: Sequence[str],
    kind: str,
    called: Sequence[Sequence[str]],
    plain: Mapping[str, tuple[str, str]],
    sources: dict[str, Source],
    remarks: list[str],
) -> None:
    """Take the first of some ways to call ours, and say what was taken where it is not plain."""
    for names in called:
        if names[0] not in plain:
            continue
        taken: dict[str, tuple[str, float]] = {}
        for name, one in zip(names, ours, strict=True):
            if name in plain:
                column, unit = plain[name]
                factor = UNITS[kind].get(unit.casefold())
                taken[one] = column, factor or (TIMES[name] if kind == "t" else 1.0)
        sources |= {one: Source(column, factor) for one, (column, factor) in taken.items()}
        if any(column != one or factor != 1.0 for one, (column, factor) in taken.items()):
            remarks.append(_taken(taken))
        return


def _taken(taken: Mapping[str, tuple[str, float]]) -> str:
    """Say which columns are taken for ours."""
    columns = ", ".join(repr(brief(column)) for column, _ in taken.values())
    scales = {factor for _, factor in taken.values()}
    said = "" if scales == {1.0} else f" times {', '.join(f'{factor:.10g}' for factor in sorted(scales))}"
    many = len(taken) > 1
    return f"{', '.join(taken)} {'are' if many else 'is'} taken from column{'s' if many else ''} {columns}{said}"


# -- formats ---------------------------------------------------------------------------------------------------------


def _column(names: Sequence[str], called: str) -> str | None:
    """Return the column of a name, with a unit behind it or not."""
    for name in names:
        match = WITH_UNIT.fullmatch(name)
        if name == called or (match and match[1] == called):
            return name
    return None


def _unit(column: str) -> str:
    match = WITH_UNIT.fullmatch(column)
    return match[2].casefold() if match else ""


def _betaflight(names: Sequence[str]) -> Usual | None:
    """Decoded blackbox logs of Betaflight and iNav: `time (us)`, `accSmooth[0]` and so on."""
    time = _column(names, "time")
    loop = _column(names, "loopIteration")
    acc = [_column(names, f"accSmooth[{i}]") or _column(names, f"acc[{i}]") for i in range(3)]
    if time is None or loop is None or acc[0] is None:
        return None
    factor = UNITS["f"].get(_unit(acc[0]))
    signs = (1.0, -1.0, -1.0)  # forward-left-up to forward-right-down
    sources = {"t": Source(time, UNITS["t"].get(_unit(time), 1e-6))}
    sources |= {
        axis: Source(column, sign * (factor or 1.0))
        for axis, column, sign in zip(AXES, acc, signs, strict=True)
        if column
    }
    satellites = _column(names, "GPS_numSat")
    if satellites:
        sources["satellites"] = Source(satellites)
    pressure = _column(names, "baroAlt") or _column(names, "BaroAlt")
    if pressure:
        metres = {"cm": 0.01, "m": 1.0}.get(_unit(pressure), 0.01)
        sources["baro_height"] = Source(pressure, metres)
    said = "a decoded blackbox log: acceleration is taken for forward-left-up, and fy and fz are turned round"
    return Usual(sources, (said,), factor is None)


def _altos(names: Sequence[str]) -> Usual | None:
    """AltOS writes acceleration without gravity, m/s²; pressure, Pa; temperature, °C."""
    if not {"acceleration", "pressure", "time", "state_name"} <= set(names):
        return None
    sources = {
        "t": Source("time"),
        "fx": Source("acceleration", 1.0, STANDARD_GRAVITY),
        "p_static": Source("pressure"),
        **({"temperature": Source("temperature", 1.0, CELSIUS)} if "temperature" in names else {}),
        **({"satellites": Source("nsat")} if "nsat" in names else {}),
    }
    said = (
        "an AltOS log: fx is its acceleration along the rocket, from which gravity is removed, plus 1 g; its "
        "temperature is brought from °C to K"
    )
    return Usual(sources, (said,))
