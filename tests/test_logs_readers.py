"""The readers of autopilots' logs, held against those of the autopilots' own projects: pyulog and pymavlink.

The logs are made from the formats' descriptions, with every kind of message and field. There is no tolerance, but for
the hundredths and 1e-7 of DataFlash, which pymavlink divides by numbers that are rounded.
"""

import io
import struct
from pathlib import Path

import numpy as np
import pytest

from sensors.files import look
from uavsim.logs.dataflash import LETTERS, read_dataflash
from uavsim.logs.ulog import MARK, TYPES, read_ulog

# -- ULog ------------------------------------------------------------------------------------------------------------

CODES = dict(zip(TYPES, "bBhHiIqQfd?c", strict=True))
FORMATS = {
    "point": [("float", 0, "x"), ("double", 0, "y")],
    "pair": [("point", 2, "p"), ("uint8_t", 0, "n")],
    "every": [("uint64_t", 0, "timestamp"), *((kind, 0, f"of_{kind}") for kind in TYPES)],
    "nested": [("uint64_t", 0, "timestamp"), ("pair", 2, "pairs"), ("int16_t", 3, "ids")],
    "padded": [("uint64_t", 0, "timestamp"), ("float", 3, "f"), ("uint8_t", 4, "_padding0")],
    "late": [("float", 0, "before"), ("uint64_t", 0, "timestamp")],
    "never": [("uint64_t", 0, "timestamp")],
}


def packed(kind: str, content: bytes) -> bytes:
    return struct.pack("<Hc", len(content), kind.encode()) + content


def keyed(text: str, value: bytes) -> bytes:
    return bytes([len(text)]) + text.encode() + value


def codes(name: str) -> str:
    """Return the struct codes of a format laid out flat, without its padding at the end."""
    return "".join(
        (CODES[kind] if kind in CODES else codes(kind)) * (count or 1)
        for kind, count, own in FORMATS[name]
        if not own.startswith("_padding")
    )


def definitions(appended: int = 0) -> bytes:
    flags = bytes(8) + bytes([1 if appended else 0]) + bytes(7) + struct.pack("<3Q", appended, 0, 0)
    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 123) + packed("B", flags)
    log += packed("I", keyed("char[3] sys_name", b"PX4")) + packed("I", keyed("uint32_t ver", b"\1\2\3\4"))
    log += packed("M", b"\0" + keyed("char[2] boot", b"ab")) + packed("M", b"\1" + keyed("char[2] boot", b"cd"))
    log += packed("I", keyed("char[0] none", b""))
    for name, fields in FORMATS.items():
        text = "".join(f"{kind}[{count}] {own};" if count else f"{kind} {own};" for kind, count, own in fields)
        log += packed("F", f"{name}:{text}".encode())
    return (
        log + packed("P", keyed("float KP", struct.pack("<f", 2.0))) + packed("Q", b"\1" + keyed("int32_t N", bytes(4)))
    )


def numbers(code: str, noise: np.random.Generator) -> object:
    if code in "fd":
        return float(noise.normal())
    if code == "?":
        return bool(noise.integers(2))
    if code == "c":
        return bytes([noise.integers(32, 127)])
    bits = 8 * struct.calcsize(code)
    low, high = (0, 2**bits) if code.isupper() else (-(2 ** (bits - 1)), 2 ** (bits - 1))
    return int.from_bytes(noise.bytes(8), "little") % (high - low) + low


def data(seed: int, rows: int = 400) -> bytes:
    """Make subscriptions, data and everything between them."""
    noise = np.random.default_rng(seed)
    under = {7: ("every", 0), 300: ("every", 1), 9: ("nested", 0), 2: ("padded", 0), 11: ("late", 3), 12: ("never", 0)}
    log = b"".join(packed("A", struct.pack("<BH", i, number) + name.encode()) for number, (name, i) in under.items())
    for k in range(rows):
        number = int(noise.choice([7, 300, 9, 2, 11]))
        layout = codes(under[number][0])
        values = [numbers(code, noise) for code in layout]
        values[layout.index("Q")] = 1000 * k
        log += packed("D", struct.pack("<H" + layout, number, *values))
        if k % 7 == 0:
            said = ("L", b"6" + struct.pack("<Q", k) + b"armed"), ("O", struct.pack("<H", 3)), ("S", MARK)
            said += ("C", b"4" + struct.pack("<HQ", 1, k) + b"tagged"), ("P", keyed("float KP", bytes(4)))
            log += packed(*said[k // 7 % len(said)])
    return log + packed("R", struct.pack("<H", 12))


def assert_read_as_by_pyulog(content: bytes) -> None:
    core = pytest.importorskip("pyulog.core")
    theirs = core.ULog(io.BytesIO(content))
    ours = read_ulog(content, set(FORMATS))
    assert not theirs.file_corruption
    assert set(ours.tables) == {(found.name, found.multi_id) for found in theirs.data_list}
    for found in theirs.data_list:
        table = ours.tables[found.name, found.multi_id]
        assert list(table) == list(found.data)
        for name, values in found.data.items():
            assert np.array_equal(table[name], values, equal_nan=True), name
    assert (ours.lost, ours.truncated, ours.damage, ours.silent) == (0, False, "", ("never",))


@pytest.mark.parametrize("seed", range(5))
def test_a_ulog_is_read_as_by_pyulog(seed: int) -> None:
    assert_read_as_by_pyulog(definitions() + data(seed))


def appended(rest: bytes) -> bytes:
    """Make a log whose last message a crash cut, and to which something was appended."""
    cut = packed("D", struct.pack("<H" + codes("padded"), 2, 9_000_000, 1.0, 2.0, 3.0))[:-9]
    before = data(1) + cut
    return definitions(len(definitions(1) + before)) + before + rest


def test_what_a_crash_appended_to_a_ulog_is_read() -> None:
    """A message that is cut there is no damage. PX4 appends a report, for which pyulog is the authority."""
    assert_read_as_by_pyulog(appended(packed("M", b"\0" + keyed("char[5] hardfault_plain", b"oh no"))))
    found = read_ulog(appended(packed("D", struct.pack("<HQ3f", 2, 9_500_000, 4.0, 5.0, 6.0))), {"padded"})
    assert found.tables["padded", 0]["timestamp"][-1] == 9_500_000
    assert found.damage == ""


def test_padding_at_the_end_may_be_logged_or_not() -> None:
    content = definitions() + packed("A", struct.pack("<BH", 0, 2) + b"padded")
    content += packed("D", struct.pack("<HQ3f", 2, 5, 1.0, 2.0, 3.0)) * 2
    content += packed("D", struct.pack("<HQ3f4x", 2, 6, 1.0, 2.0, 3.0)) * 2
    found = read_ulog(content, {"padded"})
    assert found.tables["padded", 0]["timestamp"].tolist() == [5, 5, 6, 6]
    assert found.damage == ""


def test_a_ulog_that_tells_of_what_nobody_knows_is_one_line() -> None:
    content = definitions().replace(bytes(8) + bytes([0]) + bytes(7), bytes(8) + bytes([2]) + bytes(7), 1)
    with pytest.raises(ValueError, match="flags that tell of what this reader does not know"):
        read_ulog(content, set())


# -- DataFlash -------------------------------------------------------------------------------------------------------

LAYOUT = "a=64s b=b B=B c=h C=H d=d e=i E=I f=f g=e h=h H=H i=i I=I L=i M=b n=4s N=16s q=q Q=Q Z=64s"
STRUCT: dict[str, str] = {pair[0]: pair[2:] for pair in LAYOUT.split()}  # M is unsigned, which pymavlink does not know
MESSAGES = {  # number: name, letters, columns
    0x81: ("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
    0x82: ("UNIT", "QbZ", "TimeUS,Id,Label"),
    0x83: ("PARM", "QNf", "TimeUS,Name,Value"),
    0x84: ("MSG", "QZ", "TimeUS,Message"),
    0x90: ("IMU", "QBfff", "TimeUS,I,AccX,AccY,AccZ"),
    0x91: ("ODD", "QbBcCdeEfg", "TimeUS,F0,F1,F2,F3,F4,F5,F6,F7,F8"),
    0x94: ("EVEN", "QhHiILMqQnN", "TimeUS,F0,F1,F2,F3,F4,F5,F6,F7,F8,F9"),
    0x92: ("NUM", "QHf", "TimeUS,Which,V"),
    0x93: ("NONE", "Qf", "TimeUS,V"),
}
OURS = ("IMU", "ODD", "EVEN", "NUM")


def message(number: int, *values: object) -> bytes:
    return b"\xa3\x95" + bytes([number]) + struct.pack("<" + "".join(STRUCT[c] for c in MESSAGES[number][1]), *values)


def formats() -> bytes:
    log = b""
    for number, (name, letters, columns) in {
        0x80: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        **MESSAGES,
    }.items():
        size = 3 + struct.calcsize("<" + "".join(STRUCT[c] for c in letters))
        texts = struct.pack("<4s16s64s", name.encode(), letters.encode(), columns.encode())
        log += b"\xa3\x95\x80" + bytes([number, size]) + texts
    return log


def binary(seed: int, rows: int = 300) -> bytes:
    noise = np.random.default_rng(seed)
    log = formats() + message(0x82, 1, 35, b"instance") + message(0x81, 1, 0x92, b"s#-", b"F--")
    log += message(0x81, 1, 0x90, b"s#ooo", b"F-000") + message(0x83, 2, b"KP", 2.0) + message(0x84, 3, b"Plane, 4.5")
    for k in range(rows):
        number = int(noise.choice([0x90, 0x91, 0x92, 0x94]))
        values: list[object] = []
        for code in "".join(STRUCT[c][-1] for c in MESSAGES[number][1]):
            values.append(
                noise.bytes(4).replace(b"\0", b"x") if code == "s" else numbers(code.replace("e", "f"), noise)
            )
        values[0] = 1000 * k
        if number == 0x94:
            values[6] = k % 100
        if number in {0x90, 0x92}:
            values[1] = k % 3
        log += message(number, *values)
    return log


def by_pymavlink(path: Path, text: bool = False) -> dict[tuple[str, int], list[dict[str, object]]]:
    reader = pytest.importorskip("pymavlink.DFReader")
    log = (reader.DFReader_text if text else reader.DFReader_binary)(str(path))
    rows: dict[tuple[str, int], list[dict[str, object]]] = {}
    while (found := log.recv_match(type=list(OURS))) is not None:
        values = found.to_dict()
        which = values.get(found.fmt.instance_field or "I", 0)
        rows.setdefault((found.get_type(), int(which)), []).append(values)
    log.close()
    return {key: values for key, values in rows.items() if key[0] in OURS}


def assert_equal(ours: dict, theirs: dict) -> None:
    assert set(ours) == set(theirs)
    for key, rows in theirs.items():
        assert list(ours[key]) == [name for name in rows[0] if name != "mavpackettype"]
        for name, values in ours[key].items():
            if values.dtype.kind == "S":
                continue
            assert np.asarray(values, float) == pytest.approx(
                [float(row[name]) for row in rows], rel=1e-15, nan_ok=True
            )


@pytest.mark.parametrize("seed", range(5))
def test_a_binary_dataflash_is_read_as_by_pymavlink(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "log.bin"
    path.write_bytes(binary(seed))
    ours = read_dataflash(look(path), set(OURS))
    assert_equal(ours.tables, by_pymavlink(path))
    assert {("NUM", 0), ("NUM", 1), ("NUM", 2), ("IMU", 2), ("ODD", 0)} <= set(ours.tables)
    assert (ours.lost, ours.truncated, ours.silent) == (0, False, ("NONE",))
    assert ours.names == tuple(
        sorted(["EVEN", "FMTU", "IMU", "IMU[1]", "IMU[2]", "MSG", "NUM", "NUM[1]", "NUM[2]", "ODD", "PARM", "UNIT"])
    )


def test_every_letter_is_read() -> None:
    assert set(LETTERS) == set(STRUCT)
    assert {code: np.dtype(kind).itemsize for code, kind in LETTERS.items()} == {
        code: struct.calcsize("<" + kind) for code, kind in STRUCT.items()
    }
    assert set("".join(letters for _, letters, _ in MESSAGES.values())) >= set(LETTERS) - {"a"}


@pytest.mark.parametrize("comma", [", ", ","])
def test_a_text_dataflash_is_read_as_by_pymavlink(tmp_path: Path, comma: str) -> None:
    noise = np.random.default_rng(1)
    lines = [["FMT", "128", "89", "FMT", "BBnNZ", "Type,Length,Name,Format"]]  # as old logs have it
    lines += [["FMT", str(n), "0", name, letters, columns] for n, (name, letters, columns) in MESSAGES.items()]
    lines += [["MSG", "1", "Plane, 4.5, with commas"], ["PARM", "2", "KP", "2.0"]]
    for k in range(200):
        lines.append(["IMU", str(1000 * k), str(k % 2), *(f"{value:.6f}" for value in noise.normal(size=3))])
    path = tmp_path / "log.log"
    path.write_text("\n".join(comma.join(line) for line in lines) + "\n", encoding="ascii")
    ours = read_dataflash(look(path), set(OURS))
    assert_equal(ours.tables, by_pymavlink(path, text=True))
    assert len(ours.tables["IMU", 1]["AccX"]) == 100
    assert (ours.lost, ours.truncated) == (0, False)


def test_a_page_that_is_filled_up_is_no_damage(tmp_path: Path) -> None:
    for fill in (b"\xff" * 300, bytes(700)):
        path = tmp_path / "log.bin"
        path.write_bytes(binary(0) + fill)
        assert read_dataflash(look(path), {"IMU"}).damage == ""
