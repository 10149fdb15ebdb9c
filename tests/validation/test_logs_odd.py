"""Logs that are hostile or odd in ways that people have met: none is misread without a word.

A log has a launch of 7 g or none, and traits drawn from those below. It is read right if the launch is found within
60 ms of its time, or none where there is none; else a remark must name the trait, or it must be refused in one line
that does. That is what "not misread without a word" means here.
"""

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from uavsim.logs import read_log, replay_log

pytestmark = pytest.mark.slow

ONSET, END = 3.0, 6.0  # s
WITHIN = 0.06  # s, of the launch at the lowest rate that is drawn
PUSH = 68.6  # m/s²: 7 g
G0 = 9.80665  # m/s²
AXES = ["fx", "fy", "fz"]


@dataclass(frozen=True)
class Odd:
    """A table, how it is written, and by which words its trait is told."""

    table: pd.DataFrame
    text: Callable[[str], str | bytes] = str
    mapping: str | None = None
    words: tuple[str, ...] = ()
    at: float = ONSET
    told: bool = False  # whether one of the words must be said even if the launch is found, or there is none


def flight(rate: float, seed: int, *, launch: bool) -> pd.DataFrame:
    noise = np.random.default_rng(seed)
    t = np.arange(round(END * rate)) / rate
    push = PUSH * np.clip(np.minimum((t - ONSET) / 0.01, (ONSET + 0.3 - t) / 0.02), 0.0, 1.0)
    force = noise.normal(0.0, 0.5, (t.size, 3)) + np.array([2.0, 0.0, -9.6])
    force[:, 0] += push * launch
    return pd.DataFrame({"t": t, "fx": force[:, 0], "fy": force[:, 1], "fz": force[:, 2]}).round(6)


def rows(change: Callable[[str], str], names: Callable[[str], str] = str) -> Callable[[str], str]:
    def text(whole: str) -> str:
        first, *others = whole.strip().split("\n")
        return "\n".join((names(first), *map(change, others))) + "\n"

    return text


def between(line: str, share: float) -> Callable[[str], str]:
    def text(whole: str) -> str:
        found = whole.strip().split("\n")
        found.insert(1 + int(share * (len(found) - 1)), line)
        return "\n".join(found) + "\n"

    return text


def stamp(table: pd.DataFrame, row: int, value: float) -> pd.DataFrame:
    return table.assign(t=table["t"].where(table.index != row, value))


def held(table: pd.DataFrame, many: int) -> pd.DataFrame:
    return table.iloc[table.index // many * many].assign(t=table["t"].to_numpy())


def iso(table: pd.DataFrame, zone: str, separator: str) -> pd.DataFrame:
    stamps = (
        pd.to_datetime(1_700_000_000.0 + table["t"], unit="s").dt.strftime(f"%Y-%m-%d{separator}%H:%M:%S.%f") + zone
    )
    return table.assign(t=stamps).rename(columns={"t": "time"})


def scaled(table: pd.DataFrame, factor: float) -> pd.DataFrame:
    return table.assign(**{axis: table[axis] * factor for axis in AXES})


def clipped(table: pd.DataFrame, level: float) -> pd.DataFrame:
    return table.assign(**{axis: table[axis].clip(-level, level) for axis in AXES})


def stopped(table: pd.DataFrame, start: float, end: float) -> pd.DataFrame:
    inside = (table["t"] > start) & (table["t"] < end)
    return table.assign(**{axis: table[axis].where(~inside, 1.25) for axis in AXES})


def wrapped(table: pd.DataFrame, reach: float) -> pd.DataFrame:
    return table.assign(fx=(table["fx"] + reach) % (2.0 * reach) - reach)


TRAITS: dict[str, Callable[[pd.DataFrame, np.random.Generator], Odd]] = {
    "plain": lambda f, _: Odd(f),
    "preamble": lambda f, n: Odd(
        f, lambda s: "".join(f"key {i}: {n.integers(99)}\n" for i in range(n.integers(1, 40))) + s
    ),
    "preamble with values": lambda f, n: Odd(f, lambda s: "".join(f"k{i},{i}\n" for i in range(n.integers(1, 40))) + s),
    "names in a comment": lambda f, _: Odd(f, lambda s: f"# made by hand\n# Serial: 1\n#{s}"),
    "no names": lambda f, _: Odd(f, lambda s: s.split("\n", 1)[1], words=("names",)),
    "units": lambda f, _: Odd(f, between("s,m/s^2,m/s^2,m/s^2", 0.0)),
    "trailing comma": lambda f, _: Odd(
        f.assign(host=f["t"] + 1e3)[["host", "t", "fx", "fy", "fz"]], rows(lambda r: r + ","), "t=host", at=ONSET + 1e3
    ),
    "trailing commas": lambda f, _: Odd(f, rows(lambda r: r + ",,,")),
    "semicolons": lambda f, _: Odd(f, lambda s: s.replace(",", ";")),
    "decimal comma": lambda f, _: Odd(f, lambda s: s.replace(",", ";").replace(".", ",")),
    "decimal comma and commas": lambda f, _: Odd(
        f, rows(lambda r: r.replace(".", ",")), words=("decimal comma", "lines of")
    ),
    "blanks": lambda f, _: Odd(f, lambda s: s.replace(",", "   ")),
    "blanks around": lambda f, _: Odd(f, lambda s: s.replace(",", " , ")),
    "quotes": lambda f, _: Odd(f, rows(lambda r: ",".join(f'"{c}"' for c in r.split(",")))),
    "names again": lambda f, n: Odd(f, between("t,fx,fy,fz", n.uniform())),
    "a comment": lambda f, n: Odd(f, between("# armed", n.uniform())),
    "a text": lambda f, n: Odd(f, between("armed", n.uniform())),
    "zeros": lambda f, n: Odd(f, between("\0" * 5000, n.uniform())),
    "cut": lambda f, _: Odd(f, lambda s: s[:-7]),
    "a longer line": lambda f, n: Odd(f, between("1,2,3,4,5,6,7", n.uniform())),
    "a column of text": lambda f, _: Odd(f.assign(mode="FBWA")),
    "a cell of 1e5": lambda f, n: Odd(f.assign(mode=["x" * 100_000 if i == 9 else "" for i in f.index])),
    "utf-16": lambda f, _: Odd(f, lambda s: s.encode("utf-16")),
    "utf-16 without a mark": lambda f, _: Odd(f, lambda s: s.encode("utf-16-be")),
    "a mark": lambda f, _: Odd(f, lambda s: b"\xef\xbb\xbf" + s.encode()),
    "old mac": lambda f, _: Odd(f, lambda s: s.replace("\n", "\r")),
    "iso": lambda f, n: Odd(iso(f, str(n.choice(["", "Z", "+00:00"])), str(n.choice(["T", " "]))), at=ONSET + 1.7e9),
    "named otherwise": lambda f, _: Odd(f.set_axis(["timestamp", "ax", "ay", "az"], axis=1)),
    "milliseconds": lambda f, _: Odd(f.assign(t=f["t"] * 1e3).rename(columns={"t": "ms"})),
    "microseconds unsaid": lambda f, _: Odd(f.assign(t=f["t"] * 1e6), words=("microseconds",)),
    "one back": lambda f, n: Odd(
        stamp(f, k := int(n.integers(20, len(f) - 20)), f["t"][k] - n.uniform(0.02, 0.9)), words=("out of order",)
    ),
    "one at 0": lambda f, n: Odd(stamp(f, int(n.integers(20, len(f) - 20)), 0.0), words=("out of order",)),
    "one far ahead": lambda f, n: Odd(stamp(f, int(n.integers(20, len(f) - 20)), 1e9), words=("out of order",)),
    "wrap of 16 bits": lambda f, _: Odd(
        f.assign(t=(np.round(f["t"] * 1e3).astype(int) + 64_000) % 65_536), mapping="t=t*1e-3", at=ONSET + 64.0
    ),
    "wrap of 32 bits": lambda f, _: Odd(
        f.assign(t=(np.round(f["t"] * 1e6).astype(int) + 2**32 - 10**6) % 2**32),
        mapping="t=t*1e-6",
        at=ONSET + (2**32 - 1e6) * 1e-6,
    ),
    "midnight": lambda f, _: Odd(f.assign(t=(f["t"] + 86_399.0) % 86_400.0), at=ONSET + 86_399.0),
    "reset": lambda f, n: Odd(
        f.assign(t=f["t"] - float(f["t"][len(f) // 3]) * (f.index >= len(f) // 3)), words=("reset",), at=ONSET - 2.0
    ),
    "coarse": lambda f, _: Odd(f.assign(t=np.floor(f["t"] * 20.0 + 1e-6) / 20.0)),
    "held": lambda f, _: Odd(held(f, 4), words=("repeat",)),
    "twice": lambda f, _: Odd(f.loc[f.index.repeat(2)]),
    "set forward": lambda f, _: Odd(f.assign(t=f["t"] + 1.7e9 * (f["t"] > 1.0)), at=ONSET + 1.7e9),
    "a gap": lambda f, _: Odd(f[(f["t"] < 1.0) | (f["t"] > 2.5)]),
    "rate rises": lambda f, _: Odd(f[(f["t"] > 2.0) | (f.index % 5 == 0)]),
    "rate falls": lambda f, _: Odd(f[(f["t"] < 2.5) | (f.index % 2 == 0)]),
    "jitter": lambda f, n: Odd(f.assign(t=f["t"] + n.uniform(-0.3, 0.3, len(f)) * f["t"][1])),
    "one axis": lambda f, _: Odd(f[["t", "fx"]]),
    "an axis is lost": lambda f, n: Odd(f.assign(fz=f["fz"].where(n.uniform(size=len(f)) > 0.02))),
    "beyond all": lambda f, n: Odd(f.assign(fy=f["fy"].where(n.uniform(size=len(f)) > 0.01, 1e300))),
    "g": lambda f, _: Odd(f.assign(**{a: f[a] / 9.80665 for a in ("fx", "fy", "fz")}), words=("looks like g",)),
    "counts": lambda f, _: Odd(f.assign(**{a: (f[a] * 208.8).round() for a in ("fx", "fy", "fz")}), words=("counts",)),
    "units in names": lambda f, _: Odd(
        f.assign(**{a: f[a] / 9.80665 for a in ("fx", "fy", "fz")}).set_axis(
            ["Time (s)", "ax (g)", "ay (g)", "az (g)"], axis=1
        )
    ),
    "ten thousand columns": lambda f, _: Odd(
        pd.concat([f, pd.DataFrame(0, index=f.index[:], columns=[f"c{i}" for i in range(2000)])], axis=1)
    ),
    "hostile names": lambda f, _: Odd(f.assign(**{"\x1b[31m": 1, "=cmd()": 2, "../../x": 3, "$\\frac{a}$": 4})),
    "negative start": lambda f, _: Odd(f.assign(t=f["t"] - 100.0), at=ONSET - 100.0),
    "nanoseconds": lambda f, _: Odd(
        f.assign(t=1_700_000_000 * 10**9 + (f["t"] * 1e9).astype(np.int64)).rename(columns={"t": "time_ns"}),
        at=ONSET + 1.7e9,
    ),
    "minutes": lambda f, _: Odd(f.assign(t=f["t"] / 60.0), words=("minutes", "readings a second"), told=True),
    "wrap of a signed counter": lambda f, _: Odd(
        f.assign(t=(np.round(f["t"] * 1e6).astype(np.int64) - 10**6) % 2**32 - 2**31).rename(columns={"t": "us"}),
        words=("wrap", "reset"),
        at=ONSET - 1.0 - 2**31 * 1e-6,
    ),
    "two resets": lambda f, _: Odd(pd.concat([f[f["t"] < 2.0], f[f["t"] < 1.5], f]), words=("reset",), told=True),
    "jumps forward": lambda f, n: Odd(
        f.assign(t=f["t"] + n.uniform(0.3, 30.0) * (f["t"] > 4.0)), words=("jump",), told=True
    ),
    "25 Hz": lambda f, _: Odd(f[f.index % round(0.04 / f["t"][1]) == 0], words=("range", "few"), at=ONSET + 0.03),
    "few a second": lambda f, _: Odd(f[f.index % round(0.1 / f["t"][1]) == 0], words=("few",), told=True),
    "types": lambda f, _: Odd(f, between("float,double,float32,float64", 0.0)),
    "hard blanks": lambda f, _: Odd(f, rows(lambda r: r.replace(",", "\u00a0,"))),
    "decimal comma in quotes": lambda f, _: Odd(
        f, rows(lambda r: ",".join('"' + c.replace(".", ",") + '"' for c in r.split(",")))
    ),
    "one name twice": lambda f, _: Odd(pd.concat([f, f[["fx"]] * 0.0], axis=1), words=("same name",), told=True),
    "feet": lambda f, _: Odd(scaled(f, 1.0 / 0.3048), words=("ft/s²",), told=True),
    "20 counts to 1 g": lambda f, _: Odd(scaled(f, 20.0 / G0), words=("count",), told=True),
    "gravity is off": lambda f, _: Odd(f.assign(fx=f["fx"] - 2.0, fz=f["fz"] + 9.6), words=("gravity",), told=True),
    "z up": lambda f, _: Odd(f.assign(fy=-f["fy"], fz=-f["fz"]), words=("z up",), told=True),
    "turned by 90": lambda f, _: Odd(f.assign(fx=-f["fy"], fy=f["fx"]), words=("lies along +y",)),
    "on its tail": lambda f, _: Odd(f.assign(fx=f["fz"], fz=-f["fx"]), words=("lies along −z",)),
    "askew": lambda f, _: Odd(
        f.assign(fx=0.6 * f["fx"] - 0.8 * f["fy"], fy=0.8 * f["fx"] + 0.6 * f["fy"]), words=("askew", "+y")
    ),
    "range of 3 g": lambda f, _: Odd(clipped(f, 3.0 * G0), words=("range",)),
    "stopped": lambda f, _: Odd(stopped(f, 2.5, 4.0), words=("repeat",), told=True),
    "a dead axis": lambda f, _: Odd(f.assign(fx=0.0), words=("fx repeats",), told=True),
    "integer of 6 g": lambda f, _: Odd(wrapped(f, 6.0 * G0), words=("wrap", "lies along −x")),
    "integer of 5 g": lambda f, _: Odd(wrapped(f, 5.0 * G0), words=("wrap", "lies along −x")),
    "offset and sign": lambda f, _: Odd(
        f.assign(ax=-(f["fx"] - 0.3) / 9.80665, fy=f["fy"] / 9.80665, fz=f["fz"] / 9.80665).drop(columns="fx"),
        mapping="fx=-ax*9.80665+0.3,fy=fy*9.80665,fz=fz*9.80665",
    ),
}


@pytest.mark.parametrize("trait", TRAITS)
@settings(deadline=None, derandomize=True, max_examples=6, suppress_health_check=list(HealthCheck))
@given(rate=st.sampled_from([100.0, 200.0, 500.0]), seed=st.integers(0, 10_000), launch=st.booleans())
def test_none_is_misread_without_a_word(tmp_path_factory, trait: str, rate: float, seed: int, launch: bool) -> None:
    odd = TRAITS[trait](flight(rate, seed, launch=launch), np.random.default_rng(seed))
    written = io.StringIO()
    odd.table.to_csv(written, index=False)
    text = odd.text(written.getvalue())
    path: Path = tmp_path_factory.getbasetemp() / "odd.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    try:
        score = replay_log(read_log([path], odd.mapping)).score["recording"]
    except ValueError as refused:
        said = str(refused)
        assert len(said.splitlines()) == 1
        assert any(word in said for word in odd.words), said
        return
    found, said = score["detections"], " | ".join(score["remarks"])
    right = len(found) == launch and all(0.0 < t - odd.at < WITHIN for t in found)
    assert right or any(word in said for word in odd.words), (found, said)
    if odd.told or any(word in ("out of order", "reset", "repeat") for word in odd.words):
        assert any(word in said for word in odd.words), said


PIECES = (
    b",",
    b";",
    b'"',
    b"\n",
    b"#",
    b"\t",
    b"1e400",
    b"nan",
    b"-",
    b"\r",
    b"\0" * 40,
    b"2026-01-01 00:00:00",
    b"\x85",
)


def spoiled(content: bytes, noise: np.random.Generator) -> bytes:
    """Change, take out and put in some bytes, more of them at the beginning."""
    found = bytearray(content)
    for _ in range(int(noise.integers(1, 12))):
        at = int(noise.integers(len(found) if noise.random() < 0.6 else 300))
        kind = noise.integers(4)
        if kind == 0:
            found[at] = int(noise.integers(256))
        elif kind == 1:
            del found[at : at + int(noise.integers(1, 200))]
        else:
            found[at:at] = noise.bytes(20) if kind == 2 else PIECES[int(noise.integers(len(PIECES)))]
    return bytes(found)


@pytest.mark.parametrize("form", ["comma", "semicolon", "feather"])
def test_spoiled_tables_are_read_or_one_line(tmp_path: Path, form: str) -> None:
    table, written = flight(100.0, 1, launch=True), io.BytesIO()
    if form == "feather":
        table.to_feather(written)
    else:
        table.to_csv(written, index=False, sep=",;"[form == "semicolon"], decimal=".,"[form == "semicolon"])
    path, noise = tmp_path / "odd.csv", np.random.default_rng(16)
    for _ in range(150):
        path.write_bytes(spoiled(written.getvalue(), noise))
        try:
            replay_log(read_log([path]))
        except ValueError as refused:
            said = str(refused)
            assert len(said.splitlines()) == 1
            assert len(said) < 1500
