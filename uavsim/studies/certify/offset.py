"""An accelerometer whose offset is far beyond its datasheet's: what is lost by it, and whether it is said.

Three parts of 200 flights of `catapult`:

    0 … 199     an offset drawn evenly within ±5 m/s² on each axis
    200 … 399   the same flights without it, by the same index under the seed
    400 … 599   one within ±20 m/s² on each axis

Within ±5 m/s² every flight ends in cruise, with a cruise RMSE of at most 1.2 times that without, and its launch is
recognised once, never before the release and as soon: the 95th percentile within 32 ms of the crossing of 4.5 g, as is
promised of the detector at this vibration (docs/detection.md). Within ±20 m/s² a flight is flown to cruise, or it is
not ready and the accelerometer is named.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sensors import Streams
from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.tasks import Task, numbers
from uavsim.studies.certify.verdict import Check, Verdict

PART = 200
SIZE = 3 * PART
SMALL, LARGE = 5.0, 20.0  # m/s²
TIMES = 1.2
LATE = 0.032  # s after the crossing of 4.5 g
SHOWN = 24


def task(number: int, seed: int) -> Task:
    """Return a flight of the set."""
    part, flight = divmod(number, PART)
    index = number if part == 2 else flight
    size = LARGE if part == 2 else SMALL
    drawn = [round(float(one), 3) for one in Streams(seed, index)("certify.offset").uniform(-size, size, 3)]
    bias = [0.0, 0.0, 0.0] if part == 1 else drawn
    overrides = () if part == 1 else (f"accelerometer.bias=[{','.join(map(str, bias))}]",)
    levels: dict[str, Any] = {"part": ("small", "without", "large")[part], "flight": flight}
    levels |= dict(zip(("bias_x", "bias_y", "bias_z"), bias, strict=True))
    return Task(number, "catapult", overrides, seed, levels, index=index)


def tasks(seed: int, count: int | None = None) -> list[Task]:
    """Return the set, or as many flights of each part as a part of it holds."""
    return [task(number, seed) for number in numbers(3, PART, PART, count)]


def judge(rows: Sequence[Row], seed: int, before: dict[str, Any] | None = None) -> Verdict:
    """Hold the set against what is asked of it."""
    del before
    parts = {name: [row for row in rows if row["part"] == name] for name in ("small", "without", "large")}
    small, without, large = parts.values()
    cruise = sum(row["outcome"] == "cruise" for row in small)
    ours, theirs = rmse(small), rmse(without)
    flagged = sum((row.get("flags") or 0) > 0 for row in small)
    right = [flown_or_named(row) for row in large]
    checks = [
        Check("±5 m/s²: ends in cruise", f"{len(small)} of {len(small)}", str(cruise), cruise == len(small)),
        Check("±5 m/s²: cruise RMSE over that without", f"≤ {TIMES:g}",
              f"{ours:.4f}/{theirs:.4f} = {ours / theirs:.3f}", ours <= TIMES * theirs),
        _detected(small, without),
        Check("±5 m/s²: false flags", "0", str(flagged), flagged == 0),
        Check("±20 m/s²: cruise, or not ready with the accelerometer named", f"{len(large)} of {len(large)}",
              f"{sum(right)}, of them {sum(row['outcome'] == 'cruise' for row in large)} in cruise", all(right)),
        _farthest(rows),
    ]  # fmt: skip
    return Verdict(tuple(checks), {"parts": [_part(name, some) for name, some in parts.items()]}, worst(rows, seed))


def rmse(rows: Sequence[Row]) -> float:
    """Cruise RMSE of some flights together, m/s."""
    square = sum(row.get("cruise.square") or 0.0 for row in rows)
    count = sum(row.get("cruise.counted") or 0 for row in rows)
    return float(np.sqrt(square / count)) if count else float("nan")


def flown_or_named(row: Row) -> bool:
    """Whether a flight ended in cruise, or was not ready before the release because of its accelerometer."""
    return row["outcome"] == "cruise" or (row.get("ready") is False and "accelerometer" in row["not_ready"])


def _detected(small: Sequence[Row], without: Sequence[Row]) -> Check:
    bad = sum(row.get("detections") != 1 or bool(row.get("false_detections")) for row in small)
    late, normal = (_late(some) for some in (small, without))
    found = f"{len(small) - bad} once; p95 {1e3 * late:.1f} ms, without {1e3 * normal:.1f} ms"
    wanted = f"once in {len(small)} of {len(small)}; p95 ≤ {1e3 * LATE:g} ms from 4.5 g"
    return Check("±5 m/s²: launch recognised", wanted, found, bad == 0 and late <= LATE)


def _late(rows: Sequence[Row]) -> float:
    delays = [row["since_crossing"] for row in rows if row.get("since_crossing") is not None]
    return float(np.quantile(delays, 0.95)) if delays else float("inf")


def _farthest(rows: Sequence[Row]) -> Check:
    over = sum((row.get("worst_ratio") or 0.0) > 6.0 for row in rows)
    most = max((row.get("worst_ratio") or 0.0 for row in rows), default=0.0)
    return Check("a valid airspeed off by more than 6 sd", "none", f"{over} flights; greatest {most:.3g}", over == 0)


def _part(name: str, rows: Sequence[Row]) -> dict[str, Any]:
    outcomes = sorted({row["outcome"] for row in rows})
    return {
        "part": name,
        "flights": len(rows),
        "outcomes": ", ".join(f"{one} {sum(row['outcome'] == one for row in rows)}" for one in outcomes),
        "not ready": sum(row.get("ready") is False for row in rows),
        "flagged": sum((row.get("flags") or 0) > 0 for row in rows),
        "cruise RMSE, m/s": rmse(rows),
        "off by 6 sd": sum((row.get("worst_ratio") or 0.0) > 6.0 for row in rows),
    }


def worst(rows: Sequence[Row], seed: int) -> list[dict[str, Any]]:
    """Return flights that are not as asked."""
    found = []
    for row in rows:
        good = flown_or_named(row) if row["part"] == "large" else row["outcome"] == "cruise" and not row["flags"]
        if not good or (row.get("worst_ratio") or 0.0) > 6.0:
            wrong = f"{row['outcome']}, {row.get('flag_channel') or 'no flag'} {row.get('flag_kind') or ''}".strip()
            command = task(int(row["number"]), seed).command()
            found.append({"number": row["number"], "part": row["part"], "wrong": wrong, "command": command})
    return found[:SHOWN]
