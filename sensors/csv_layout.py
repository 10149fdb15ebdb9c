"""How a text file of numbers is laid out: what separates its values, where the names stand, where the numbers begin.

Loggers write what they like before the numbers: a preamble, names in a comment, names and then units, nothing. The
layout is told from the numbers: the separator is the one with which most cells are numbers, the width is that of most
lines of numbers, and the names are the last line before them that has as many.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from sensors.files import Held, is_binary
from sensors.text import brief

LONGEST_HEAD = 1_000_000  # B, in which the names and the first numbers stand
MOST_LINES = 3000  # lines that are looked at; the preamble of a Betaflight log has some 200
MOST_LOOKED_AT = 200_000  # characters of them
MOST_COLUMNS = 20_000
MOST_TOLD = 6  # names that are told
BLANKS = " "  # as a separator: any run of blanks and tabs
SEPARATORS = (",", ";", "\t", "|", BLANKS)
COMMENT = re.compile(r"\s*(?:#|//|%|!)+")
MARKS = {  # byte order marks, the longer before those that they begin with
    b"\xff\xfe\x00\x00": "utf-32",
    b"\x00\x00\xfe\xff": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
    b"\xef\xbb\xbf": "utf-8-sig",
}
LOST = re.compile(rb"\0{16,}")  # what a logger leaves of a page that was never written
LINE = re.compile(r"\r\n|\n|\r")
POINT = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf|infinity)", re.IGNORECASE)
COMMA = re.compile(r"[-+]?(?:\d+,\d*|,\d+)(?:[eE][-+]?\d+)?")
DATE = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.,]\d+)?)?(?:Z|[-+]\d\d:?\d\d)?")
CLOCK = re.compile(r"\d{1,2}:\d\d:\d\d(?:[.,]\d+)?")
UNIT = re.compile(
    r"-|1|[\[(].{0,12}[\])]|%|[mµun]?s|sec|seconds?|m|ft|k?m/h|kts?|(?:m|ft)/s|(?:c?m|ft|[mµ]?g)/?(?:s(?:\^|\*\*)?-?2|s²|s/s)?"
    r"|m?g|gees?|[hkm]?pa|m?bar|psi|k|[°º]?[cfk]|deg ?[cfk]?|rad|(?:deg|rad|°|º)/s|dps|m?v|m?a|hz|lsb|counts?|raw"
    r"|float\d*|double|u?int\d*|number|numeric|str(?:ing)?",  # or the type that a column is of
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class CsvLayout:
    """How a file is laid out.

    Attributes
    ----------
    encoding : str
    separator : str
        `BLANKS` for runs of blanks.
    decimal : str
        Point or comma.
    names : tuple of str
        Of the columns; numbers from "1" on if the file has no names.
    named : bool
        Whether it has.
    units : tuple of str
        Of the columns, if a line below the names tells them.
    width : int
        Values in a line; more than names where every line ends in separators.
    start : int
        Characters before the first line of numbers.
    dates, clocks : frozenset of int
        Columns that hold dates with a time, and times of day.
    remarks : tuple of str
        What is not usual.
    line : float
        Mean length of a line, characters.
    """

    encoding: str
    separator: str
    decimal: str
    names: tuple[str, ...]
    named: bool
    units: tuple[str, ...]
    width: int
    start: int
    dates: frozenset[int]
    clocks: frozenset[int]
    remarks: tuple[str, ...]
    line: float = 1.0


@dataclass(frozen=True, slots=True)
class _Line:
    """A line that is not empty, and where the next one begins."""

    text: str
    start: int
    comment: str | None  # what stands behind the sign of a comment


@dataclass(frozen=True, slots=True)
class _Reading:
    """A file's lines cut by one separator: which of them hold numbers, and how many values most of those have."""

    separator: str
    cells: list[list[str]]
    numeric: list[bool]
    width: int
    share: float

    @property
    def first(self) -> int:
        """The first line of numbers that is as wide as most."""
        return next(i for i, cells in enumerate(self.cells) if self.numeric[i] and len(cells) == self.width)


def layout_of(held: Held) -> CsvLayout:
    """Tell the layout of a file; ValueError, one line, if it is no table."""
    encoding, text, whole = _text(held)
    lines = _lines(text, whole=whole)
    if not any(line.comment is None for line in lines):
        if not whole:
            raise ValueError(f"not a table of comma-separated values (no names in the first {LONGEST_HEAD // 1000} kB)")
        raise ValueError("not a table of comma-separated values (it holds no numbers)")
    data = [line for line in lines if line.comment is None]
    for separator in SEPARATORS[:-1]:
        if (most := max(line.text.count(separator) for line in data[:100]) + 1) > MOST_COLUMNS:
            raise ValueError(f"has {most} columns; at most {MOST_COLUMNS} are read")
    best = max((_reading(data, separator) for separator in SEPARATORS), key=_rank)
    if not any(best.numeric):
        return _without_numbers(encoding, data)
    return _with_numbers(encoding, lines, data, best)


def cut(line: str, separator: str) -> list[str]:
    """Cut a line into its values, without the blanks and quotes around them."""
    if separator == BLANKS:
        return line.split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]
        except csv.Error:
            pass
    return [cell.strip().strip('"') for cell in line.split(separator)]


def told_apart(names: Iterable[Any]) -> tuple[str, ...]:
    """Names without blanks around them; those that are the same then get a number."""
    found: dict[str, None] = {}
    for given in names:
        name = stripped = str(given).strip()
        number = 0
        while name in found:
            number += 1
            name = f"{stripped}.{number}"
        found[name] = None
    return tuple(found)


# -- text ------------------------------------------------------------------------------------------------------------


def _text(held: Held) -> tuple[str, str, bool]:
    """Return the encoding of a file, the text at its beginning, and whether that is all of it."""
    head = held.first(LONGEST_HEAD)
    if not head:
        raise ValueError("not a table of comma-separated values (an empty file)")
    encoding = next((name for mark, name in MARKS.items() if head.startswith(mark)), "") or _without_mark(head)
    whole = len(head) < LONGEST_HEAD
    return encoding, head.decode(encoding, errors="replace").removeprefix("\ufeff"), whole


def _without_mark(head: bytes) -> str:
    """Tell an encoding by the text: where every other byte is zero it is UTF-16, as far as it is Western."""
    sample = head[:4096]
    for encoding, first in (("utf-16-le", 1), ("utf-16-be", 0)):
        zeros, others = sample[first::2], sample[1 - first :: 2]
        if len(sample) > 3 and zeros.count(0) > 0.8 * len(zeros) and others.count(0) < 0.1 * len(others):
            return encoding
    if is_binary(LOST.sub(b"", sample) or b"\0"):
        raise ValueError("not a table of comma-separated values (a binary file)")
    return "utf-8" if _is_utf8(head) else "latin-1"


def _is_utf8(head: bytes) -> bool:
    """Whether text is UTF-8; its last character may be cut."""
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        return error.start >= len(head) - 3 and len(head) == LONGEST_HEAD
    return True


def _lines(text: str, *, whole: bool) -> list[_Line]:
    """Return the first lines that are not empty; one that is cut at the end counts only if there is no more."""
    found: list[_Line] = []
    start = looked_at = 0
    while start < len(text) and len(found) < MOST_LINES and (looked_at < MOST_LOOKED_AT or len(found) < 3):
        ending = LINE.search(text, start)
        if ending is None and not whole:
            break
        line = text[start : len(text) if ending is None else ending.start()].replace("\0", "")
        if line.strip():
            comment = COMMENT.match(line)
            found.append(_Line(line, start, line[comment.end() :] if comment else None))
            looked_at += len(line)
        start = len(text) if ending is None else ending.end()
    return found


# -- numbers and names -----------------------------------------------------------------------------------------------


def _is_number(cell: str) -> bool:
    return len(cell) < 400 and bool(POINT.fullmatch(cell) or COMMA.fullmatch(cell) or is_time(cell))


def is_time(cell: str) -> bool:
    """Whether a value is a date with a time, or a time of day."""
    return bool(DATE.fullmatch(cell) or CLOCK.fullmatch(cell))


def _reading(lines: Sequence[_Line], separator: str) -> _Reading:
    """Cut lines by a separator, and tell which are lines of numbers: at least half of what they hold is."""
    cells = [cut(line.text, separator) for line in lines]
    numeric, share = [], 0.0
    for values in cells:
        filled = [value for value in values if value]
        numbers = sum(map(_is_number, filled))
        numeric.append(bool(filled) and 2 * numbers >= len(filled))
        share += numbers / len(filled) if numeric[-1] else 0.0
    widths = Counter(len(values) for values, is_data in zip(cells, numeric, strict=True) if is_data)
    width = max(widths, key=lambda each: (widths[each] * each, each)) if widths else 0
    return _Reading(separator, cells, numeric, width, share / max(1, sum(numeric)))


def _rank(one: _Reading) -> tuple[bool, bool, float, int]:
    """How well a separator fits: lines of numbers, of more than one value, most of them numbers, in most lines."""
    return any(one.numeric), one.width > 1, round(one.share, 2), sum(one.numeric) * (one.separator != BLANKS)


def _without_numbers(encoding: str, data: Sequence[_Line]) -> CsvLayout:
    """Names and nothing that is a number, or names alone."""
    separator = max(SEPARATORS[:-1], key=data[0].text.count)
    names = told_apart(cut(data[0].text, separator))
    start = data[1].start if len(data) > 1 else data[0].start + len(data[0].text)
    width = max(len(cut(line.text, separator)) for line in data[:2])
    _check_width(names, width, [])
    if len(data) == 1 or (len(data) == 2 and _are_units(cut(data[1].text, separator))):
        shown = ", ".join(brief(name) for name in names[:MOST_TOLD])
        more = f" and {len(names) - MOST_TOLD} more" if len(names) > MOST_TOLD else ""
        raise ValueError(f"holds a line of names ({shown}{more}) and no line of numbers below it: nothing was logged")
    none: frozenset[int] = frozenset()
    return CsvLayout(encoding, separator, ".", names, bool(names), (), len(names), start, none, none, ())


def _with_numbers(encoding: str, lines: Sequence[_Line], data: Sequence[_Line], best: _Reading) -> CsvLayout:
    first, width = best.first, best.width
    start = data[first].start
    rows = [cells for cells, numeric in zip(best.cells[first:], best.numeric[first:], strict=True) if numeric]
    rows = [cells for cells in rows if len(cells) == width]
    bare = _bare(rows)
    names, units = _names(lines, data[:first], best, bare)
    remarks = []
    if names is None:
        found: tuple[str, ...] = tuple(map(str, range(1, bare + 1)))
        remarks.append("there is no line of names: columns are called by their numbers, from 1 on")
    else:
        _check_width(names, bare, rows)
        found = told_apart(names)
        remarks += _twice(names)
        if len(names) < width:
            remarks.append("every line ends in a separator, behind which nothing stands")
        elif bare < len(names):
            remarks.append(f"there are {len(names)} names, and lines of {bare} values: the last columns are empty")
    decimal = _decimal(rows)  # between commas a decimal one stands in quotes
    if names is not None and _is_commented(lines, start, names):
        remarks.append("the names stand in a comment")
    if decimal == ",":
        remarks.append("numbers are written with a decimal comma")
    if units:
        remarks.append("the line below the names is one of units")
    count = len(found)
    dates = frozenset(i for i in range(width) if _holds(rows, i, DATE))
    clocks = frozenset(i for i in range(width) if _holds(rows, i, CLOCK))
    named, said = names is not None, tuple(remarks)
    line = (data[-1].start - start) / max(1, len(data) - first - 1)
    return CsvLayout(
        encoding, best.separator, decimal, found, named, units, max(width, count), start, dates, clocks, said, line
    )


def _bare(rows: Sequence[Sequence[str]]) -> int:
    """Return how many values a line has without the empty ones at the end of every line."""
    return max((max((i + 1 for i, cell in enumerate(cells) if cell), default=0) for cells in rows), default=0)


def _names(
    lines: Sequence[_Line], before: Sequence[_Line], best: _Reading, bare: int
) -> tuple[Sequence[str] | None, tuple[str, ...]]:
    """Return names and units: the last line before the numbers that has as many values, be it in a comment."""
    cells = [_stripped(values) for values in best.cells[: len(before)]]
    texts = [values for values, numeric in zip(cells, best.numeric, strict=False) if not numeric]
    wide = [values for values in texts if len(values) >= min(bare, best.width)]
    if wide and len(wide) > 1 and _are_units(wide[-1]) and not _are_units(wide[-2]):
        return wide[-2], tuple(wide[-1])
    if wide:
        return wide[-1], ()
    ahead = [line.comment for line in lines if line.comment is not None and line.start < _end_of(before, lines, best)]
    for comment in reversed(ahead):
        for separator in (best.separator, *SEPARATORS):
            values = _stripped(cut(comment, separator))
            if bare <= len(values) <= best.width and not all(map(_is_number, values)):
                return values, ()
    if texts:  # a line of names that is too short, or a text: the caller says how it does not fit
        last = texts[-1]
        if len(last) > 1 or bare == 1:
            return last, ()
    return None, ()


def _twice(names: Sequence[str]) -> list[str]:
    """Say which names several columns have."""
    again = [(name, many) for name, many in Counter(name.strip() for name in names).items() if many > 1 and name]
    if not again:
        return []
    told = ", ".join(f"{brief(name)!r} ({many} columns)" for name, many in again[:MOST_TOLD])
    more = f" and {len(again) - MOST_TOLD} more" if len(again) > MOST_TOLD else ""
    name = brief(again[0][0])
    return [
        f"columns have the same name: {told}{more}; {name!r} is the first of them, the next is called '{name}.1', and "
        "so on"
    ]


def _is_commented(lines: Sequence[_Line], start: int, names: Sequence[str]) -> bool:
    """Whether no line before the numbers but a comment holds the first and the last name."""
    plain = [line.text for line in lines if line.start < start and line.comment is None]
    return not any(names[0] in text and names[-1] in text for text in plain)


def _end_of(before: Sequence[_Line], lines: Sequence[_Line], best: _Reading) -> int:
    """Where the numbers begin."""
    data = [line for line in lines if line.comment is None]
    return data[best.first].start if len(data) > best.first else before[-1].start


def _stripped(values: Sequence[str]) -> list[str]:
    """Values without the empty ones at the end."""
    return list(values[: max((i + 1 for i, value in enumerate(values) if value), default=0)])


def _are_units(values: Sequence[str]) -> bool:
    filled = [value for value in values if value]
    return bool(filled) and sum(bool(UNIT.fullmatch(value)) for value in filled) >= 0.7 * len(filled)


def _check_width(names: Sequence[str], width: int, rows: Sequence[Sequence[str]]) -> None:
    """Refuse lines of more values than there are names: which is which cannot be told."""
    if width <= len(names):
        return
    halves = width == 2 * len(names) and all(cell.isdigit() for cells in rows for cell in cells[1::2] if cell)
    why = ": a decimal comma cannot be told from one between values; write decimal points" if halves else ""
    raise ValueError(f"has {len(names)} names, and lines of {width} values{why}")


def _decimal(rows: Sequence[Sequence[str]]) -> str:
    commas = any(COMMA.fullmatch(cell) for cells in rows for cell in cells)
    points = any("." in cell and POINT.fullmatch(cell) for cells in rows for cell in cells)
    return "," if commas and not points else "."


def _holds(rows: Sequence[Sequence[str]], column: int, kind: re.Pattern[str]) -> bool:
    filled = [cells[column] for cells in rows if cells[column]]
    return bool(filled) and sum(bool(kind.fullmatch(cell)) for cell in filled) > 0.5 * len(filled)
