"""Write docs/scenario.md: every key of a scenario with its default, its bounds and what it means.

Everything is taken from the settings' own declarations and docstrings, so the page cannot tell another story than the
code; a test compares it with the file. Run it after a setting has changed:

    .venv/bin/python scripts/scenario_reference.py
"""

import re
import types
from collections.abc import Iterator
from dataclasses import is_dataclass
from inspect import cleandoc, getdoc
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from uavsim.scenario import Requirement, Scenario

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

This page is written by `scripts/scenario_reference.py` from the settings' own declarations.
"""


def page() -> str:
    """Return the whole page."""
    return cleandoc(INTRODUCTION) + "\n" + "".join(_group(name, kind) for name, kind in _groups()) + _requirements()


def _groups(kind: type = Scenario, prefix: str = "") -> Iterator[tuple[str, type]]:
    yield prefix, kind
    for name, hint in get_type_hints(kind).items():
        if is_dataclass(hint):
            yield from _groups(hint, f"{prefix}{name}.")  # type: ignore[arg-type]  # a class, not an instance


def _group(prefix: str, kind: type) -> str:
    rows = list(_rows(prefix, kind))
    if not rows:
        return ""
    title = f"`[{prefix.rstrip('.')}]`" if prefix else "At the top"
    summary = (getdoc(kind) or "").split("\n")[0]
    table = "\n".join(rows)
    return f"\n## {title}\n{summary}\n\n| key | default | allowed | meaning |\n|---|---|---|---|\n{table}\n"


def _rows(prefix: str, kind: type) -> Iterator[str]:
    meanings = dict(_meanings(kind))
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if is_dataclass(hint) or name == "requirements":
            continue
        default = getattr(kind(), name)
        shown = "the part's own" if default is None and prefix != "detector." else _shown(default)
        yield f"| `{prefix}{name}` | {shown} | {_allowed(hint)} | {meanings.get(name, '')} |"


def _requirements() -> str:
    meaning = " ".join((getdoc(Requirement) or "").split())
    return (
        f"\n## `[[requirements]]`\n{meaning} Each has the keys `key`, `minimum`, `maximum`; see [score.md](score.md).\n"
    )


def _meanings(kind: type) -> Iterator[tuple[str, str]]:
    """Names and descriptions of the docstring's Attributes section; names that stand together share theirs."""
    _, _, section = (getdoc(kind) or "").partition("Attributes\n----------\n")
    for match in re.finditer(r"^(\S.*)\n((?:    .*\n?)+)", section, re.MULTILINE):
        names, text = match.group(1).split(" : ")[0], " ".join(match.group(2).split())
        for name in names.split(", "):
            yield name, text


def _shown(value: Any) -> str:
    if value is None:
        return "as `threshold`"
    if isinstance(value, tuple):
        return "`[" + ", ".join(f'"{v}"' if isinstance(v, str) else f"{v:g}" for v in value) + "]`"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, dict):
        return "none"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value:g}`"


_WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false", type(None): ""}
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
        members = [m for m in get_args(hint) if m is not Ellipsis]
        return f"list of {_allowed(members[0])}" if len(members) == 1 else f"list of {len(members)} numbers"
    return "JSBSim property = number" if origin is dict else _WORDS[hint]


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written {PAGE}")
