"""Write docs/scenario.md: every key of a scenario with its default, its bounds and what it means.

Everything is taken from the settings' own declarations and docstrings, so the page cannot tell another story than the
code; a test compares it with the file. Run it after a setting has changed:

    .venv/bin/python scripts/scenario_reference.py
"""

import re
import types
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from inspect import cleandoc, getdoc
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from sensors import data_files
from uavsim import settings
from uavsim.scenario import MOST_READINGS, Scenario

PAGE = Path(__file__).resolve().parent.parent / "docs" / "scenario.md"

INTRODUCTION = """
# Keys of a scenario

A scenario is a TOML file that holds only what differs from the defaults below; groups are TOML tables. The same keys,
joined by dots, go with `--set KEY=VALUE`. SI unless the name ends in another unit (`_g`, `_deg`, `_pa`, `_hz`).

```toml
description = "heavier noise on a rail that shakes"
expect = "cruise"

[vibration]
stroke_rms_g = 1.0

[accelerometer]
preset = "adxl345"
noise_scale = 3.0

[[requirements]]
key = "launch.latency"
maximum = 0.030
```

`uavsim fly FILE.toml` flies it; `uavsim scenarios` lists the packaged ones. A flight's folder holds its resolved
`scenario.toml`, which flies again to the same result.

Besides what each key allows: a number is 0 or from {least:g} to {most:g} in magnitude; a text has at most {text}
characters, a list {entries} entries, a list of groups {groups}; and no sensor gives more than {readings} readings in a
flight, which is `duration` times its rate. (At the default rates an hour of flight takes 4.5 GB of memory.) A file has
at most {bytes} bytes, {marks} keys and entries, {parts} parts in a name and brackets {deep} deep, so that reading any
file takes less than a second.

This page is written by `scripts/scenario_reference.py` from the settings' own declarations.
"""
BOUNDS = {
    "least": settings.SMALLEST_NUMBER, "most": settings.LARGEST_NUMBER, "text": settings.LONGEST_TEXT,
    "entries": settings.MOST_ENTRIES, "groups": settings.MOST_GROUPS, "readings": MOST_READINGS,
    "bytes": data_files.LARGEST, "marks": data_files.MARKS, "parts": data_files.PARTS, "deep": data_files.DEEPEST,
}  # fmt: skip


def page() -> str:
    """Return the whole page."""
    groups = "".join(
        _group(f"`[{name.rstrip('.')}]`" if name else "At the top", name, kind) for name, kind in _groups()
    )
    lists = "".join(_group(", ".join(names), "", kind) for kind, names in _lists().items())
    return cleandoc(INTRODUCTION).format(**BOUNDS) + "\n" + groups + lists


def _groups(kind: type = Scenario, prefix: str = "") -> Iterator[tuple[str, type]]:
    yield prefix, kind
    for name, hint in get_type_hints(kind).items():
        if is_dataclass(hint):
            yield from _groups(hint, f"{prefix}{name}.")  # type: ignore[arg-type]  # a class, not an instance


def _lists() -> dict[type, list[str]]:
    """Kinds of groups that come in lists, and where: `[[accelerometer.faults]]`."""
    found: dict[type, list[str]] = {}
    for prefix, kind in _groups():
        for name, hint in get_type_hints(kind).items():
            if _entry(hint) is not None:
                found.setdefault(_entry(hint), []).append(f"`[[{prefix}{name}]]`")
    return found


def _entry(hint: Any) -> Any:
    """Kind of the groups in a list, if it is one of groups."""
    members = get_args(hint) if get_origin(hint) is tuple else ()
    return members[0] if members and is_dataclass(members[0]) else None


def _group(title: str, prefix: str, kind: type) -> str:
    rows = list(_rows(prefix, kind))
    if not rows:
        return ""
    summary = (getdoc(kind) or "").split("\n")[0]
    table = "\n".join(rows)
    return f"\n## {title}\n{summary}\n\n| key | default | allowed | meaning |\n|---|---|---|---|\n{table}\n"


def _rows(prefix: str, kind: type) -> Iterator[str]:
    meanings = dict(_meanings(kind))
    hints = get_type_hints(kind, include_extras=True)
    for setting in fields(kind):  # type: ignore[arg-type]  # a class of settings
        hint = hints[setting.name]
        if is_dataclass(hint):
            continue
        shown = _default(f"{prefix}{setting.name}", setting)
        yield f"| `{prefix}{setting.name}` | {shown} | {_allowed(hint)} | {meanings.get(setting.name, '')} |"


def _default(key: str, setting: "Field[Any]") -> str:
    if setting.default_factory is not MISSING:
        return _shown(setting.default_factory())
    if setting.default is MISSING:
        return "must be given"
    if setting.default is None:
        group, _, name = key.rpartition(".")
        return _NONE.get(key, _NONE.get(group, _NONE.get(name, "the part's own")))
    return _shown(setting.default)


# What a default of nothing stands for, by key, group or name; else it is the part's own.
_NONE = {
    "detector.options": "none",
    "estimator.options": "none",
    "plant.options": "none",
    **dict.fromkeys(("airspeed", "climb_deg", "bank_deg", "throttle"), "as before"),
    "load_g": "from the path",
    **dict.fromkeys(("below_temperature", "between_heights"), "any"),
    "version": "none",
    "sha256": "none",
    "detector": "as `threshold`",
    "estimator": "by the gain",
    "normal": "by port",
    "direction": "by port",
    "mean": "the key's own",
    "sd": "none",
    "low": "none",
    "high": "none",
    "minimum": "none",
    "maximum": "none",
}


def _meanings(kind: type) -> Iterator[tuple[str, str]]:
    """Names and descriptions of the docstring's Attributes section; names that stand together share theirs."""
    _, _, section = (getdoc(kind) or "").partition("Attributes\n----------\n")
    for match in re.finditer(r"^(\S.*)\n((?:    .*\n?)+)", section, re.MULTILINE):
        names, text = match.group(1).split(" : ")[0], " ".join(match.group(2).split())
        for name in names.split(", "):
            yield name, text


def _shown(value: Any) -> str:
    if value in ((), {}):
        return "none"
    if isinstance(value, tuple):
        return "`[" + ", ".join(_shown(v).strip("`") for v in value) + "]`"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value:g}`"


_WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false", type(None): ""}
_DICTIONARIES = {Any: "group of keys", float: "JSBSim property = number"}
_SIGNS = (("ge", "≥"), ("gt", ">"), ("le", "≤"), ("lt", "<"))


def _allowed(hint: Any) -> str:
    origin = get_origin(hint)
    if origin is Annotated:
        base, *bounds = get_args(hint)
        limits = [
            f"{sign} {value:g}"
            for bound in bounds
            for name, sign in _SIGNS
            if (value := getattr(bound, name, None)) is not None
        ]
        return ", ".join([_allowed(base), *limits])
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in get_args(hint))
    if origin in (Union, types.UnionType):
        return " or ".join(filter(None, map(_allowed, get_args(hint))))
    if origin is tuple:
        return _allowed_list([m for m in get_args(hint) if m is not Ellipsis])
    return _WORDS[hint] if origin is None else _DICTIONARIES[get_args(hint)[1]]


def _allowed_list(members: list[Any]) -> str:
    if is_dataclass(members[0]):
        return "list of groups, below"
    if len(members) == 1:
        return f"list of {_allowed(members[0])}"
    return f"list of {len(members)} {'texts' if members[0] is str else 'numbers'}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written {PAGE}")
