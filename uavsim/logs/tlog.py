"""A telemetry log of a ground station read: MAVLink frames, each behind the time at which it came.

A record is eight bytes, µs since 1970, the most significant first, and a frame: version 1 begins with FE and has six
bytes before its payload, version 2 with FD and ten, zeros at the end of its payload left out, a signature of 13 bytes
if it says so. Two bytes of check sum (CRC-16/MCRF4XX over all but the first byte, and a byte of the message's form)
close it. Frames of kinds that are wanted count only if that is right; others are passed over by their length. Where no
frame stands, reading goes on at the next record that is followed by another.

Source: MAVLink developer guide, "Packet Serialization"; message_definitions/v1.0/common.xml.
"""

from dataclasses import dataclass
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from uavsim.logs.logged import Key, Logged, check_rows
from uavsim.logs.mavlink_names import name_of

STAMP = Struct(">Q")
V1, V2 = 0xFE, 0xFD
HEADS = {V1: 6, V2: 10}  # B before the payload
SIGNATURE = 13  # B
ENOUGH = 700  # B, in which two records stand
LATEST = 4_102_444_800_000_000  # µs: the year 2100
SINCE_1970 = 1e8  # s; a clock that is beyond counts from 1970, for no aircraft runs three years


@dataclass(frozen=True, slots=True)
class Message:
    """A kind of message: its name, the byte of its form, its fields as they are laid out."""

    name: str
    extra: int
    layout: "np.dtype[np.void]"


def _message(name: str, extra: int, *fields: tuple[str, str]) -> Message:
    return Message(name, extra, np.dtype([(field, kind) for kind, names in fields for field in names.split()]))


IMU = "xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag"
MESSAGES = {
    24: _message(
        "GPS_RAW_INT", 24, ("<u8", "time_usec"), ("<i4", "lat lon alt"), ("<u2", "eph epv vel cog"),
        ("u1", "fix_type satellites_visible"),
    ),
    26: _message("SCALED_IMU", 170, ("<u4", "time_boot_ms"), ("<i2", IMU)),
    27: _message("RAW_IMU", 144, ("<u8", "time_usec"), ("<i2", IMU)),
    29: _message(
        "SCALED_PRESSURE", 115, ("<u4", "time_boot_ms"), ("<f4", "press_abs press_diff"), ("<i2", "temperature")
    ),
    30: _message("ATTITUDE", 39, ("<u4", "time_boot_ms"), ("<f4", "roll pitch yaw rollspeed pitchspeed yawspeed")),
    33: _message(
        "GLOBAL_POSITION_INT", 104, ("<u4", "time_boot_ms"), ("<i4", "lat lon alt relative_alt"), ("<i2", "vx vy vz"),
        ("<u2", "hdg"),
    ),
    74: _message("VFR_HUD", 20, ("<f4", "airspeed groundspeed alt climb"), ("<i2", "heading"), ("<u2", "throttle")),
    116: _message("SCALED_IMU2", 76, ("<u4", "time_boot_ms"), ("<i2", IMU)),
    129: _message("SCALED_IMU3", 46, ("<u4", "time_boot_ms"), ("<i2", IMU)),
    105: _message(
        "HIGHRES_IMU", 93, ("<u8", "time_usec"),
        ("<f4", f"{IMU} abs_pressure diff_pressure pressure_alt temperature"),
        ("<u2", "fields_updated"),
    ),
}  # fmt: skip
"""Messages that hold something of ours, by their numbers; later extensions at their ends are passed over."""


def _table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x8408 if crc & 1 else 0)
        table.append(crc)
    return table


CRC = _table()


def _check(body: bytes, extra: int) -> int:
    crc = 0xFFFF
    for byte in (*body, extra):
        crc = (crc >> 8) ^ CRC[(crc ^ byte) & 0xFF]
    return crc


def _end(content: bytes, at: int) -> int:
    """Where the record at a place ends; 0 if there is none, or not a whole one."""
    frame = at + STAMP.size
    if frame + 12 > len(content) or content[frame] not in HEADS or STAMP.unpack_from(content, at)[0] > LATEST:
        return 0
    signed = SIGNATURE if content[frame] == V2 and content[frame + 2] & 1 else 0
    end = frame + HEADS[content[frame]] + content[frame + 1] + 2 + signed
    return end if end <= len(content) else 0


def is_tlog(head: bytes) -> bool:
    """Whether a file begins as a telemetry log does: with two records, or one that is all of it."""
    end = _end(head, 0)
    return bool(end) and (end == len(head) or bool(_end(head, end)))


def read_tlog(content: bytes, wanted: set[str]) -> Logged:
    """Read a telemetry log.

    Parameters
    ----------
    content
        Of the file.
    wanted
        Names of the messages whose fields are returned.

    Raises
    ------
    ValueError
        One line, if it has too many messages.
    """
    rows: dict[tuple[int, int], list[bytes]] = {}  # by system and number
    stamps: dict[tuple[int, int], list[int]] = {}
    other: set[int] = set()
    lost, at, stop = 0, 0, len(content)
    while at < stop:
        end = _end(content, at)
        if not end or (end < stop and not _end(content, end) and not _is_cut(content, end)):
            going_on = _next(content, at + 1)
            if going_on == stop and _is_cut(content, at):
                break
            lost += going_on - at
            at = going_on
            continue
        system, number, payload = _payload(content, at + STAMP.size)
        message = MESSAGES.get(number)
        if message is None:
            other.add(number)
        elif payload is None:
            lost += end - at
        else:
            rows.setdefault((system, number), []).append(payload)
            stamps.setdefault((system, number), []).append(STAMP.unpack_from(content, at)[0])
        at = end
    return _logged(rows, stamps, other, wanted, lost=lost, truncated=at < stop)


def _payload(content: bytes, frame: int) -> tuple[int, int, bytes | None]:
    """Return system, number and payload of a frame; no payload if the check sum is wrong."""
    head = HEADS[content[frame]]
    system = content[frame + (3 if head == HEADS[V1] else 5)]
    number = int.from_bytes(content[frame + head - (1 if head == HEADS[V1] else 3) : frame + head], "little")
    message = MESSAGES.get(number)
    if message is None:
        return system, number, None
    end = frame + head + content[frame + 1]
    right = _check(content[frame + 1 : end], message.extra) == int.from_bytes(content[end : end + 2], "little")
    size = message.layout.itemsize
    return system, number, content[frame + head : end].ljust(size, b"\0")[:size] if right else None


def _is_cut(content: bytes, at: int) -> bool:
    """Whether the file ends within a record that may begin at a place."""
    frame = at + STAMP.size
    return len(content) - at < STAMP.size + 12 + 255 + SIGNATURE and (frame >= len(content) or content[frame] in HEADS)


def _next(content: bytes, at: int) -> int:
    """Where reading goes on after damage, or the end."""
    while True:
        places = [place for place in (content.find(bytes([mark]), at + STAMP.size) for mark in HEADS) if place >= 0]
        if not places:
            return len(content)
        at = min(places) - STAMP.size
        end = _end(content, at)
        if end and (end == len(content) or _end(content, end)):
            return at
        at += 1


def _logged(
    rows: dict[tuple[int, int], list[bytes]],
    stamps: dict[tuple[int, int], list[int]],
    other: set[int],
    wanted: set[str],
    *,
    lost: int,
    truncated: bool,
) -> Logged:
    """Put messages into tables, those of the system that sent most, by the time since its boot."""
    sent: dict[int, int] = {}
    for (system, _), payloads in rows.items():
        sent[system] = sent.get(system, 0) + len(payloads)
    system = max(sent, key=lambda each: sent[each], default=0)
    tables: dict[Key, dict[str, NDArray[np.generic]]] = {}
    for (of, number), payloads in rows.items():
        if of == system:
            message = MESSAGES[number]
            check_rows(message.name, len(payloads))
            table = np.frombuffer(b"".join(payloads), message.layout)
            tables[message.name, 0] = {name: table[name] for name in message.layout.names or ()}
            tables[message.name, 0]["received"] = 1e-6 * np.array(stamps[of, number], float)
    _add_times(tables)
    names = tuple(sorted(name for name, _ in tables)) + tuple(map(name_of, sorted(other)))
    chosen = {key: table for key, table in tables.items() if key[0] in wanted}
    return Logged(chosen, names, (), lost, truncated)


def _add_times(tables: dict[Key, dict[str, NDArray[np.generic]]]) -> None:
    """Give each message a time since boot, s; what has none of its own has it by when it came."""
    since = []
    for table in tables.values():
        own = _own_time(table)
        if own is not None and own[0] < SINCE_1970:
            table["time"] = own
            since.append(float(np.median(table["received"].astype(float) - own)))
    boot = min(since, default=0.0)
    for table in tables.values():
        if "time" not in table:
            own = _own_time(table)
            table["time"] = (table["received"].astype(float) if own is None else own) - boot


def _own_time(table: dict[str, NDArray[np.generic]]) -> NDArray[np.float64] | None:
    if "time_boot_ms" in table:
        return 1e-3 * table["time_boot_ms"].astype(float)
    if "time_usec" in table:
        return 1e-6 * table["time_usec"].astype(float)
    return None
