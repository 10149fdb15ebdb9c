"""Files of data, TOML and JSON: looked at before a parser sees them, so that reading any takes less than a second.

A parser's time may grow with the square of its input. Python's `tomllib` needs 25 s for one key of 20 000 dots and
10 s for 100 000 keys under a header of 500 parts, both below 1 MB. So one pass over the text counts what costs, and a
text beyond these bounds is refused with the line at which it is:

    LARGEST    bytes of a file
    MARKS      of = , . [ { outside of text and comments: keys, entries of lists, parts of names, groups
    DEEPEST    brackets within one another
    PARTS      of a name that is joined by dots
    WORD       characters of a name or a number
    TEXT       characters of a text

JSON's parser is quick and stops by itself where it is nested too deep. It takes what JSON does not have, NaN and
numbers too large for a float; they are refused here.
"""

import json
import re
import stat
import tomllib
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

LARGEST = 1_000_000  # bytes; the largest file that is shipped has a hundredth of it
MARKS = 20_000  # at their slowest, a header of ten parts and keys below it, tomllib needs 0.4 s for so many
DEEPEST = 16  # a list of groups that hold lists of lists has 4
PARTS = 10  # of a scenario's keys none has more than 4
WORD = 200
TEXT = 20_000

# The tokens of TOML in the order in which they must be tried. A quote that nothing closes is the last alternative: no
# parser gets beyond it. Loops are unrolled, no two of their parts begin alike, single characters repeat possessively:
# this keeps it linear. A group is not repeated possessively, for Python before 3.11.5 matches that wrongly (gh-106052).
_TOKEN = re.compile(
    r"""
    (?P<text>\"{3}[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*\"{3} | '{3}[^']*+(?:'(?!'')[^']*+)*'{3}
           | "[^"\\\n]*+(?:\\.[^"\\\n]*+)*" | '[^'\n]*+')
    | (?P<between>(?:\s|\#[^\n]*+)+)
    | (?P<mark>[=,.\[\]{}])
    | (?P<word>[^\s=,.\[\]{}"'\#]++)
    | (?P<open>["'])
    """,
    re.VERBOSE | re.DOTALL,
)


def read_toml(path: Path) -> dict[str, Any]:
    """Return what a TOML file holds; ValueError as of `read_text` and `parse_toml`."""
    return parse_toml(read_text(path))


def read_text(path: Path, largest: int = LARGEST) -> str:
    """Return the text of a file of at most `largest` bytes, without the byte-order mark that some editors begin with.

    Raises
    ------
    ValueError
        One line, without the file's name: it cannot be read, is larger, or is no text.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would be waited for, and some devices never end
            raise ValueError("cannot be read: it is no regular file")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    if len(content) > largest:
        raise ValueError(f"is larger than {largest} bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("is not text in UTF-8") from None


def parse_toml(text: str) -> dict[str, Any]:
    """Return what a text in TOML holds; ValueError, one line, if it is none or beyond the bounds above."""
    check_shape(text)
    try:
        return tomllib.loads(text)
    except ValueError as error:
        raise ValueError(f"not valid TOML: {error}") from None


def parse_json(text: str) -> Any:
    """Return what a text in JSON holds; ValueError, one line, if it is none, too deep, or a number is not finite."""
    try:
        return json.loads(text, parse_float=_finite, parse_constant=_refuse)
    except RecursionError:
        raise ValueError("nested too deep") from None


def _finite(number: str) -> float:
    value = float(number)
    return value if isfinite(value) else _refuse(number)


def _refuse(number: str) -> NoReturn:
    raise ValueError(f"{number[:30]} is not a finite number")


def check_shape(text: str) -> None:
    """Refuse a text in TOML that is larger, deeper or longer than data of ours is; ValueError with the line."""
    if len(text) > LARGEST:
        raise ValueError(f"is larger than {LARGEST} characters")
    marks = depth = parts = 0
    for found in _TOKEN.finditer(text):
        kind, length = found.lastgroup, found.end() - found.start()
        if kind == "mark":
            mark = found[0]
            marks += mark in "=,.[{"
            depth += (mark in "[{") - (mark in "]}")
            parts = parts + 1 if mark == "." else 0
            if marks > MARKS or depth > DEEPEST or parts >= PARTS:
                raise ValueError(_beyond(text, found.start(), marks, depth))
        elif kind == "between" and "\n" in found[0]:
            parts = 0
        elif kind == "word" and length > WORD:
            raise ValueError(f"line {_line(text, found.start())}: a name or number of more than {WORD} characters")
        elif kind == "text" and length > TEXT:
            raise ValueError(f"line {_line(text, found.start())}: a text of more than {TEXT} characters")
        elif kind == "open":
            return


def _beyond(text: str, place: int, marks: int, depth: int) -> str:
    if marks > MARKS:
        return f"line {_line(text, place)}: more than {MARKS} keys and entries"
    if depth > DEEPEST:
        return f"line {_line(text, place)}: nested too deep: brackets in brackets, more than {DEEPEST}"
    return f"line {_line(text, place)}: nested too deep: a name of more than {PARTS} parts"


def _line(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1
