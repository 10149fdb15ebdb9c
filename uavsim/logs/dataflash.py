"""An ArduPilot DataFlash log read, binary or text, as far as it goes.

Binary: messages of two bytes A3 95, a number, and what the format of that number says. The format of formats has the
number 80 (all hexadecimal). A message counts only if it is whole and is followed by another or by the end. Where that
is not so, reading goes on at the next message of a known format; what lies between is lost, and counted. Zeros or ones
that fill the last page are no loss. Text: lines of values, separated by commas.

Formats are letters, a field each: numbers of some width, some of them hundredths (c, C, e, E) or 1e-7 (L), and text.
Text logs have them in their units. Which instance a message is of, a field says that FMTU marks with #, or else "I".

Source: ArduPilot, libraries/AP_Logger/LogStructure.h and README.md.
"""

import re
from dataclasses import dataclass, field
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from sensors.files import Held
from uavsim.logs.logged import Key, Logged, check_rows, labelled

HEAD = b"\xa3\x95"
BEGIN = 3  # B, of a message before its fields
FORMAT = 0x80  # number of the format of formats
TEXT = b"FMT,"  # with which a text log begins
FILLED = re.compile(rb"\x00*|\xff*")
LETTERS = {
    "a": "S64",
    "b": "i1",
    "B": "u1",
    "c": "<i2",
    "C": "<u2",
    "d": "<f8",
    "e": "<i4",
    "E": "<u4",
    "f": "<f4",
    "g": "<f2",
    "h": "<i2",
    "H": "<u2",
    "i": "<i4",
    "I": "<u4",
    "L": "<i4",
    "M": "u1",
    "n": "S4",
    "N": "S16",
    "q": "<i8",
    "Q": "<u8",
    "Z": "S64",
}
OVER = {"c": 100.0, "C": 100.0, "e": 100.0, "E": 100.0, "L": 1e7}
LONG_LINE = 10_000  # B, of a text log
CONTROL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")
NAME = re.compile(r"[A-Za-z0-9_]{1,16}")
_FMT = Struct("<BB4s16s64s").unpack


@dataclass(slots=True, eq=False)
class _Format:
    """The fields of a message, and what was found of it.

    Attributes
    ----------
    size : int
        Of its binary form with the beginning, B.
    layout : numpy.dtype
        The fields by their places.
    texts : tuple of bool
        Which fields are text.
    count : int
        How many messages there are.
    at : list of int
        Where the fields of each begin, if they are wanted.
    """

    name: str
    letters: str
    columns: tuple[str, ...]
    size: int
    layout: "np.dtype[np.void]"
    texts: tuple[bool, ...]
    count: int = 0
    at: list[int] = field(default_factory=list)

    def is_as(self, other: "_Format | None") -> bool:
        """Whether another is the same but for what was found."""
        return other is not None and (self.name, self.letters, self.columns) == (
            other.name,
            other.letters,
            other.columns,
        )


def _format(name: str, letters: str, columns: str, size: int | None = None) -> _Format | None:
    """Return a format, or None if it is none, or of another size than is told."""
    fields = tuple(columns.split(","))
    known = bool(letters) and all(letter in LETTERS for letter in letters)
    if not known or not NAME.fullmatch(name) or not len(set(fields)) == len(fields) == len(letters):
        return None
    layout = np.dtype([(str(i), LETTERS[letter]) for i, letter in enumerate(letters)])
    whole = layout.itemsize + BEGIN
    texts = tuple(LETTERS[letter].startswith("S") for letter in letters)
    return _Format(name, letters, fields, whole, layout, texts) if size in (None, whole) else None


def read_dataflash(held: Held, wanted: set[str]) -> Logged:
    """Read a DataFlash log.

    Parameters
    ----------
    held
        The file.
    wanted
        Names of the messages whose fields are returned.

    Raises
    ------
    ValueError
        One line, if it has no format, or too many messages.
    """
    return (_Text if held.head.startswith(TEXT) else _Binary)(held, wanted).logged()


class _Log:
    """What a log holds, as it is read."""

    def __init__(self) -> None:
        self.formats: list[_Format] = []
        self.instances: dict[str, str] = {}  # the field that tells a message's instance, by its name
        self.lost, self.truncated = 0, False

    def of(self, tables: dict[str, dict[str, NDArray[np.generic]]]) -> Logged:
        """Return tables by their instances, and what else is known."""
        found = {one.name for one in self.formats if one.count}
        if not found:
            raise ValueError("not a DataFlash log that can be read (no message with its format is in it)")
        split: dict[Key, dict[str, NDArray[np.generic]]] = {}
        for name, table in tables.items():
            split |= _by_instance(name, table, self.instances.get(name, "I"))
        names = {labelled(key) for key in split} | (found - set(tables))
        silent = {one.name for one in self.formats} - found
        return Logged(split, tuple(sorted(names)), tuple(sorted(silent)), self.lost, self.truncated)

    def mark(self, of: _Format | None, units: str) -> None:
        """Note which field of a message tells its instance, that with the unit `#`."""
        place = units.find("#")
        if of is not None and 0 <= place < len(of.columns):
            self.instances[of.name] = of.columns[place]


def _by_instance(
    name: str, table: dict[str, NDArray[np.generic]], told: str
) -> dict[Key, dict[str, NDArray[np.generic]]]:
    numbers = table.get(told)
    if numbers is None or numbers.dtype.kind not in "iu":
        return {(name, 0): table}
    return {
        (name, int(number)): {column: values[numbers == number] for column, values in table.items()}
        for number in np.unique(numbers)
    }


# -- binary ----------------------------------------------------------------------------------------------------------


class _Binary(_Log):
    """A binary log."""

    def __init__(self, held: Held, wanted: set[str]) -> None:
        super().__init__()
        self._content, self._wanted = held.content(), wanted
        formats = _format("FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
        assert formats is not None
        self._known = {FORMAT: formats}
        self._run()

    def logged(self) -> Logged:
        """Return what it holds; of a message with several formats those of which there is most."""
        tables = {}
        for name in self._wanted:
            one = max((f for f in self.formats if f.name == name), key=lambda f: len(f.at), default=None)
            if one is not None and one.at:
                tables[name] = self._table(one)
        return self.of(tables)

    def _run(self) -> None:
        content, stop, at = self._content, len(self._content), 0
        while at < stop:
            known = self._known.get(content[at + 2]) if content.startswith(HEAD, at) and at + BEGIN <= stop else None
            end = stop + 1 if known is None else at + known.size
            if known is not None and end <= stop and (content.startswith(HEAD, end) or self._is_end(end)):
                self._take(known, at, end)
                at = end
            elif (known is not None and end > stop) or self._is_end(at):
                self.truncated |= FILLED.fullmatch(content, at) is None
                return
            else:
                going_on = self._next(at + 1)
                self.lost += going_on - at
                at = going_on

    def _is_end(self, at: int) -> bool:
        """Whether the log ends at a place: with it, a cut beginning, or what fills a page."""
        left = len(self._content) - at
        return left < BEGIN or (self._content[at] in (0x00, 0xFF) and FILLED.fullmatch(self._content, at) is not None)

    def _next(self, at: int) -> int:
        """Where reading goes on after damage, or the end."""
        content, stop = self._content, len(self._content)
        while (at := content.find(HEAD, at)) >= 0:
            known = self._known.get(content[at + 2]) if at + BEGIN <= stop else None
            if known is not None and (at + known.size > stop or content.startswith(HEAD, at + known.size)):
                return at
            at += 1
        return stop

    def _take(self, known: _Format, at: int, end: int) -> None:
        """Take in a message."""
        known.count += 1
        if known.name == "FMT":
            number, size, name, letters, columns = _FMT(self._content[at + BEGIN : end])
            found = _format(_text(name), _text(letters), _text(columns), size)
            if number == FORMAT or (found is not None and found.is_as(self._known.get(number))):
                return
            if found is None:
                self.lost += end - at
            else:
                self._known[number] = found
                self.formats.append(found)
        elif known.name == "FMTU":
            row = np.frombuffer(self._content, known.layout, 1, at + BEGIN)[0].tolist()
            fields = dict(zip(known.columns, row, strict=True))
            of, units = fields.get("FmtType"), fields.get("UnitIds")
            if isinstance(of, int) and isinstance(units, bytes):
                self.mark(self._known.get(of), _text(units))
        if known.name in self._wanted:
            known.at.append(at + BEGIN)

    def _table(self, of: _Format) -> dict[str, NDArray[np.generic]]:
        check_rows(of.name, len(of.at))
        size = of.layout.itemsize
        rows = np.frombuffer(b"".join([self._content[start : start + size] for start in of.at]), of.layout)
        columns = {}
        for i, (column, letter) in enumerate(zip(of.columns, of.letters, strict=True)):
            values = rows[str(i)]
            columns[column] = values / OVER[letter] if letter in OVER else values
        return columns


def _text(field: bytes) -> str:
    return field.partition(b"\0")[0].decode("latin-1")


# -- text ------------------------------------------------------------------------------------------------------------


class _Text(_Log):
    """A text log; a line counts only if it ends, has no control characters, and numbers where its format says so."""

    def __init__(self, held: Held, wanted: set[str]) -> None:
        super().__init__()
        self._known: dict[str, _Format] = {}
        self._numbers: dict[str, _Format] = {}
        self._rows: dict[str, list[list[float]]] = {name: [] for name in wanted}
        with held.open() as file:
            for line in iter(lambda: file.readline(LONG_LINE), b""):
                self._read(line)

    def logged(self) -> Logged:
        """Return what it holds."""
        return self.of({name: self._table(name, rows) for name, rows in self._rows.items() if rows})

    def _read(self, line: bytes) -> None:
        """Take in a line, or count it as lost."""
        if not line.strip():
            return
        if not line.endswith(b"\n") and len(line) < LONG_LINE:
            self.truncated = True
        elif CONTROL.search(line) or not self._is_taken([value.strip() for value in line.decode("latin-1").split(",")]):
            self.lost += len(line)

    def _is_taken(self, values: list[str]) -> bool:
        """Take in a line's values, if they are as a format says."""
        if values[0] == "FMT" and len(values) >= 6:
            return self._is_defined(*values[1:])
        known = self._known.get(values[0])
        return known is not None and self._is_kept(known, values[1:])

    def _is_defined(self, number: str, _: str, name: str, letters: str, *columns: str) -> bool:
        """Take in the format of a message."""
        found = _format(name, letters, ",".join(columns))
        if found is None:
            return name == "FMT"  # whose columns some logs do not tell in full
        if name != "FMT" and not found.is_as(self._known.get(name)):
            self._known[name] = self._numbers[number] = found
            self.formats.append(found)
            if name in self._rows:
                self._rows[name] = []  # another format from here on
        return True

    def _is_kept(self, known: _Format, values: list[str]) -> bool:
        """Keep values if they are as many as their format says; a text at the end may hold commas."""
        more = len(values) - len(known.columns)
        if more < 0 or (more and not known.texts[-1]):
            return False
        if known.name in self._rows:
            try:
                row = [np.nan if text else float(value) for value, text in zip(values, known.texts, strict=False)]
            except ValueError:
                return False
            self._rows[known.name].append(row)
            check_rows(known.name, len(self._rows[known.name]))
        elif known.name == "FMTU":
            fields = dict(zip(known.columns, values, strict=False))
            self.mark(self._numbers.get(fields.get("FmtType", "")), fields.get("UnitIds", ""))
        known.count += 1
        return True

    def _table(self, name: str, rows: list[list[float]]) -> dict[str, NDArray[np.generic]]:
        """Fields of a message; bytes are whole numbers, for one of them tells the instance."""
        of = self._known[name]
        table: dict[str, NDArray[np.generic]] = {}
        for column, letter, values in zip(of.columns, of.letters, np.array(rows).T, strict=True):
            small = LETTERS[letter] in ("i1", "u1") and bool(np.all(np.abs(values) < 256.0))
            table[column] = values.astype(np.int64) if small else values
        return table
