"""Files as somebody might spoil them: seeded changes of what a preset or a scenario holds.

A change replaces a value, scales it by a power of ten, negates it, gives it another type, removes, adds or doubles a
key, shortens, lengthens, nests or turns a list, or writes hostile text. Equal seeds give equal files.
"""

import copy
import datetime
import math
import random
from typing import Any

import tomli_w

HOSTILE = (
    "\x1b[31mred\x1b[0m", "bell\x07", "back\x08space", "over\rwritten", "\u202eturned", "zero\u200bwidth", "\x9b31m",
    "[red]markup[/]", "[link=https://example.org]link[/link]", "[/]", "$x^2$", "$", r"$\frac{1}{0$", "<b>html</b>",
    "x" * 3000, "\u3164", "\U0001f680", "_hidden", "new\nline", "%s {0}", "",
)  # fmt: skip
ODD = (
    math.nan, math.inf, -math.inf, 1e308, -1e308, 1e-320, 0, 0.0, -0.0, -1, 1, 2**63 - 1, -(2**63), 0.5, True, False,
    [], {}, [[]], [math.nan], {"a": 1}, datetime.date(2020, 1, 1), datetime.time(1, 2, 3),
)  # fmt: skip


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the path of everything that is nested in a value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [found for key, item in inner for found in ((*path, key), *places(item, (*path, key)))]


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def at(tree: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def changed(draw: random.Random, value: Any) -> Any:
    """Return another value in place of this one."""
    if is_number(value) and draw.random() < 0.8:
        return draw.choice((
            *(value * 10.0 ** draw.randint(-3, 3), round(value * draw.uniform(0.3, 3.0), 3)) * 3,
            value * 10.0 ** draw.randint(-30, 30), -value, math.copysign(1, value), str(value), [value],
        ))  # fmt: skip
    if isinstance(value, list) and value and draw.random() < 0.7:
        return draw.choice((
            value[:-1], value[1:], value[::-1], [*value, value[-1]], value * 40, [value], [*value, draw.choice(ODD)],
            value[0], sorted(value, key=repr),
        ))  # fmt: skip
    return draw.choice((*ODD, *HOSTILE))


def mutated(draw: random.Random, sound: dict[str, Any], changes: int) -> dict[str, Any]:
    """Return nested plain values with some changes; the sound ones stay as they are."""
    tree = copy.deepcopy(sound)
    for _ in range(changes):
        everywhere = places(tree) or [("x",)]
        numbers = [path for path in everywhere if is_number(at(tree, path))]
        *groups, last = draw.choice(numbers if numbers and draw.random() < 0.6 else everywhere)
        group, what = at(tree, tuple(groups)), draw.random()
        if what < 0.06:
            del group[last]
        elif what < 0.12 and isinstance(group, dict):
            group[draw.choice((*(h for h in HOSTILE if h), f"{last}x", "modes", "kind"))] = draw.choice(ODD)
        else:
            group[last] = changed(draw, group[last])
    return tree


def written(draw: random.Random, tree: dict[str, Any]) -> str:
    """Return the values as TOML, at times with something in it that no writer would write."""
    text = tomli_w.dumps(tree)
    if draw.random() < 0.85:
        return text
    lines = text.splitlines() or [""]
    at = draw.randrange(len(lines) + 1)
    odd = (
        *(lines[at % len(lines)], "a" + ".a" * 20_000 + " = 1", "x = " + "[" * 500, "x = " + "9" * 5000, "y = 1e400"),
        *("[a" + ".b" * 300 + "]", "\x00", "\ufeff", "x = 0x" + "f" * 400, f'x = "{"z" * 30_000}"', "=", "[[values]]"),
        *("[values]", "\n".join(f"k{i} = {i}" for i in range(25_000))),
    )
    return "\n".join([*lines[:at], draw.choice(odd), *lines[at:]])
