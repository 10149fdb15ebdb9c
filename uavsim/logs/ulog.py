"""A PX4 ULog read, as far as it goes.

A header of 16 B, then messages: size (uint16), kind (a letter), so many bytes. F defines a format, A subscribes to it
under a number, D holds data of that number, S is a mark to find one's place again, all others are passed over. After
the data, a crash dump may be appended at offsets that B tells.

A message counts only if it is whole, is as its kind demands, and is followed by another or by the end. Where that is
not so, reading goes on at the next data of a known subscription, with the size that its format has, at the next
subscription, definition or mark; what lies between is lost, and counted.

Source: PX4 developer guide, "ULog File Format".
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from uavsim.logs.logged import Key, Logged, check_rows, labelled

MAGIC = b"ULog\x01\x12\x35"
HEADER = 16  # B
MARK = b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"
TYPES = {
    "int8_t": "i1",
    "uint8_t": "u1",
    "int16_t": "<i2",
    "uint16_t": "<u2",
    "int32_t": "<i4",
    "uint32_t": "<u4",
    "int64_t": "<i8",
    "uint64_t": "<u8",
    "float": "<f4",
    "double": "<f8",
    "bool": "i1",
    "char": "i1",
}
MOST_FIELDS = 10_000  # of a message; those of PX4 have up to some hundreds
MOST_SUBSCRIPTIONS = 10_000  # PX4 has some hundreds
MOST_PADDING = 64  # B at the end of a message; PX4 has up to 7
DEEPEST = 8  # of formats within formats
APPENDED = 0x01  # the only flag that need be understood
NEAR, FAR = 2**8, 2**20  # B that are searched at once for where reading goes on: few at first, then twice as many
EFFORT = 10, 10**7  # what a search may cost for each byte of the log, and besides
SEARCH, FAILED = 2000, 100  # what a search costs, and a place at which reading cannot go on after all
DATA, DEFINES, SUBSCRIBES, FLAGS, SYNC = b"DFABS"
LONGEST = {DEFINES: 2**14, SUBSCRIBES: 300}  # B; other kinds of PX4's messages have up to some hundreds
LONGEST_OTHER = 2**14
FORMAT = re.compile(rb"[\w/-]+:(?:[\w/-]+(?:\[\d{1,5}\])? [\w/-]+;)+")
FIELD = re.compile(r"([\w/-]+)(?:\[(\d+)\])? ([\w/-]+);")
SUBSCRIPTION = re.compile(rb"[\s\S]{3}[\w/-]+")
KEY = re.compile(rb"[\w/]+(?:\[\d{1,5}\])? [\x21-\x7e]+")
_HEAD = Struct("<HB").unpack_from
_NUMBER = Struct("<H").unpack_from


def _is_text(body: bytes) -> bool:
    try:
        body.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _is_keyed(body: bytes) -> bool:
    """Whether it is a key, `type name`, with its length before it, and a value."""
    return len(body) >= 1 + body[0] and KEY.fullmatch(body, 1, 1 + body[0]) is not None if body else False


def _is_said(body: bytes, before: int) -> bool:
    """Whether it is a text with its level, 0 to 7, as the first of so many bytes before it."""
    return len(body) >= before and 0x30 <= body[0] <= 0x37 and _is_text(body[before:])


BODIES: dict[int, Callable[[bytes], bool]] = {
    DEFINES: lambda body: FORMAT.fullmatch(body) is not None,
    SUBSCRIBES: lambda body: SUBSCRIPTION.fullmatch(body) is not None,
    FLAGS: lambda body: len(body) >= 40,
    SYNC: lambda body: body == MARK,
    ord("I"): _is_keyed,
    ord("M"): lambda body: _is_keyed(body[1:]),
    ord("P"): _is_keyed,
    ord("Q"): lambda body: _is_keyed(body[1:]),
    ord("R"): lambda body: len(body) == 2,
    ord("O"): lambda body: len(body) == 2,
    ord("L"): lambda body: _is_said(body, 9),
    ord("C"): lambda body: _is_said(body, 11),
}
"""What the bodies of messages of each kind, but data, are like."""


@dataclass(slots=True)
class _Subscription:
    """A message under a number: its format laid out flat, and where its data are."""

    key: Key
    layout: np.dtype[np.void]
    padded: int  # B, with the padding at its end, which is not always logged
    at: list[int] = field(default_factory=list)


class _UnreadableError(Exception):
    """A message is not as its kind demands."""


def read_ulog(content: bytes, wanted: set[str]) -> Logged:
    """Read a ULog.

    Parameters
    ----------
    content
        Of the file.
    wanted
        Names of the messages whose data are returned.

    Raises
    ------
    ValueError
        One line, if it is none, or one that this reader cannot know.
    """
    if not content.startswith(MAGIC) or len(content) < HEADER:
        raise ValueError("not a ULog that can be read (its header is not that of one)")
    scan = _Scan(content)
    scan.run()
    held: dict[Key, list[_Subscription]] = {}
    for one in scan.subscriptions:
        if one.at:
            held.setdefault(one.key, []).append(one)
    silent = {one.key[0] for one in scan.subscriptions} - {name for name, _ in held}
    tables = {key: _table(content, parts) for key, parts in held.items() if key[0] in wanted}
    names = tuple(sorted(map(labelled, held)))
    return Logged(tables, names, tuple(sorted(silent)), scan.lost, scan.truncated)


def _table(content: bytes, parts: list[_Subscription]) -> dict[str, NDArray[np.generic]]:
    """Fields of a message; where it was subscribed to again with another format, those of which there is most."""
    one = max(parts, key=lambda part: len(part.at))
    at = sorted(start for part in parts if part.layout == one.layout for start in part.at)
    check_rows(labelled(one.key), len(at))
    size = one.layout.itemsize
    rows = np.frombuffer(b"".join([content[start : start + size] for start in at]), one.layout)
    return {name: rows[name] for name in one.layout.names or ()}


class _Scan:
    """The way through a log: where data are, and what could not be read."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.subscriptions: list[_Subscription] = []
        self.lost, self.truncated = 0, False
        self._formats: dict[str, list[tuple[str, int, str]]] = {}
        self._layouts: dict[str, tuple[np.dtype[np.void], int]] = {}
        self._known: dict[int, _Subscription] = {}
        self._sizes = np.ones((2, 2**16), np.int64)  # least and most of data of a number, B; none is known
        self._sizes[1] = 0
        self._appended: list[int] = []
        self._effort = EFFORT[0] * len(content) + EFFORT[1]

    def run(self) -> None:
        """Go through all of it, the parts that were appended one after the other."""
        whole, at = len(self.content), HEADER
        end = self._end(at, whole)
        if end and self.content[at + 2] == FLAGS:
            self._flag(self.content[at + 3 : end])
            at = end
        for stop in (*self._appended, whole):
            self._section(at, stop)
            at = max(at, stop)

    def _section(self, at: int, stop: int) -> None:
        """Go through messages up to a place."""
        end = self._end(at, stop)
        while at < stop:
            if end and self.content[at + 2] in (DEFINES, SUBSCRIBES):
                self._take(at, end)
                at, end = end, self._end(end, stop)
            elif end and ((following := self._end(end, stop)) or self._is_end(end, stop)):
                if self.content[at + 2] == DATA:
                    self._known[_NUMBER(self.content, at + 3)[0]].at.append(at + 5)
                at, end = end, following
            elif not end and self._is_end(at, stop):
                self.truncated |= stop == len(self.content)  # before an appended part, a crash cut it
                return
            else:
                going_on = self._next(at + 1, stop)
                self.lost += going_on - at
                at, end = going_on, self._end(going_on, stop)

    def _end(self, at: int, stop: int) -> int:
        """Where the message at a place ends; 0 if there is none, or not a whole one."""
        if at + 3 > stop:
            return 0
        size, kind = _HEAD(self.content, at)
        end: int = at + 3 + size
        if end > stop:
            return 0
        if kind == DATA:
            return end if self._is_data(at, size) else 0
        demand = BODIES.get(kind)
        if demand is None or size > LONGEST.get(kind, LONGEST_OTHER):
            return 0
        return end if demand(self.content[at + 3 : end]) else 0

    def _is_data(self, at: int, size: int) -> bool:
        """Whether data of that size are of a number that is known."""
        if size < 2:
            return False
        known = self._known.get(_NUMBER(self.content, at + 3)[0])
        return known is not None and known.layout.itemsize <= size - 2 <= known.padded

    def _is_cut(self, at: int, stop: int) -> bool:
        """Whether it looks as if the log ended at a place, or within a message that begins there."""
        if at + 5 > stop:
            return True
        size, kind = _HEAD(self.content, at)
        if at + 3 + size <= stop or size > LONGEST.get(kind, LONGEST_OTHER):
            return False
        return self._is_data(at, size) if kind == DATA else kind in BODIES

    def _is_end(self, at: int, stop: int) -> bool:
        """Whether the log ends there: reading goes on nowhere behind."""
        return self._is_cut(at, stop) and self._next(at + 1, stop) == stop

    def _next(self, at: int, stop: int) -> int:
        """Where reading goes on after damage, or the end."""
        self._spend(SEARCH)
        for place in self._candidates(at, stop):
            end = self._end(place, stop)
            strong = end and self.content[place + 2] in (DEFINES, SUBSCRIBES)
            if strong or (end and (self._end(end, stop) or self._is_cut(end, stop))):
                return place
            self._spend(FAILED + _HEAD(self.content, place)[0])
        return stop

    def _spend(self, cost: int) -> None:
        """Give up a log in which reading goes on at too many places, or could but does not."""
        self._effort -= cost
        if self._effort < 0:
            raise ValueError("a ULog that is damaged in too many places to be read")

    def _candidates(self, at: int, stop: int) -> Iterator[int]:
        """Places that look like data of a known number, a definition, a subscription or a mark."""
        least, most = self._sizes
        start, window = at, NEAR
        while start < stop - 5:
            here = np.frombuffer(self.content[start : min(start + window + 5, stop)], np.uint8).astype(np.int64)
            size, kind = here[:-5] | here[1:-4] << 8, here[2:-3]
            number = here[3:-2] | here[4:-1] << 8
            found = (kind == DATA) & (least[number] <= size - 2) & (size - 2 <= most[number])
            found |= (kind == DEFINES) & (size <= LONGEST[DEFINES]) & (size > 3)
            found |= (kind == SUBSCRIBES) & (size <= LONGEST[SUBSCRIBES]) & (size > 3)
            found |= (kind == SYNC) & (size == len(MARK))
            yield from (np.flatnonzero(found) + start).tolist()
            start, window = start + window, min(2 * window, FAR)

    # -- definitions -------------------------------------------------------------------------------------------------

    def _take(self, at: int, end: int) -> None:
        """Take in a definition or a subscription."""
        take = self._define if self.content[at + 2] == DEFINES else self._subscribe
        try:
            take(self.content[at + 3 : end])
        except _UnreadableError:
            self.lost += end - at

    def _define(self, body: bytes) -> None:
        name, _, fields = body.decode("ascii").partition(":")
        self._formats[name] = [(kind, int(count or 0), own) for kind, count, own in FIELD.findall(fields)]
        self._layouts.clear()

    def _flag(self, body: bytes) -> None:
        if body[8] & ~APPENDED or any(body[9:16]):
            raise ValueError("a ULog with flags that tell of what this reader does not know")
        offsets = [int.from_bytes(body[i : i + 8], "little") for i in (16, 24, 32)] if body[8] & APPENDED else []
        self._appended = sorted(offset for offset in offsets if HEADER < offset < len(self.content))

    def _subscribe(self, body: bytes) -> None:
        instance, number, name = body[0], int.from_bytes(body[1:3], "little"), body[3:].decode("ascii")
        layout, padded = self._layout(name)
        known = self._known.get(number)
        if known is not None and known.key == (name, instance) and known.layout == layout:
            return
        if len(self.subscriptions) >= MOST_SUBSCRIPTIONS:
            raise ValueError(f"a ULog of more than {MOST_SUBSCRIPTIONS} subscriptions")
        self._known[number] = _Subscription((name, instance), layout, padded)
        self._sizes[:, number] = layout.itemsize, padded
        self.subscriptions.append(self._known[number])

    def _layout(self, name: str) -> tuple[np.dtype[np.void], int]:
        """Return a format laid out flat without the padding at its end, and its size with it, B."""
        if name not in self._layouts:
            fields = self._flat(name, "", 0)
            whole = sum(np.dtype(kind).itemsize for _, kind in fields)
            while fields and fields[-1][0].startswith("_padding"):
                fields.pop()
            if not fields or len(dict(fields)) < len(fields):
                raise _UnreadableError
            layout = np.dtype(fields)
            self._layouts[name] = layout, min(whole, layout.itemsize + MOST_PADDING)
        return self._layouts[name]

    def _flat(self, name: str, prefix: str, depth: int) -> list[tuple[str, str]]:
        """Fields of a format with their types, formats within it laid out; of an array each element is one."""
        if name not in self._formats or depth > DEEPEST:
            raise _UnreadableError
        flat: list[tuple[str, str]] = []
        for kind, count, own in self._formats[name]:
            if count > MOST_FIELDS:
                raise _UnreadableError
            for element in [f"{own}[{i}]" for i in range(count)] if count else [own]:
                if kind in TYPES:
                    flat.append((prefix + element, TYPES[kind]))
                else:
                    flat += self._flat(kind, f"{prefix}{element}.", depth + 1)
                if len(flat) > MOST_FIELDS:
                    raise _UnreadableError
        return flat
