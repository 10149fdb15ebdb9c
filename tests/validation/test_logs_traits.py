"""Logs with traits that mislead, drawn by hypothesis: the launch is found where there is one, or a word names them.

Each input is a launch, or none, written with one or more traits of those that people have reported. Misread without a
word is what must not happen: a launch that is missed, or found where there is none, with no remark that names a trait,
and a file that is refused with a line that does not.
"""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from uavsim.logs import read_log, replay_log
from uavsim.truth import STANDARD_GRAVITY as G0

pytestmark = pytest.mark.slow

Array = np.ndarray[Any, np.dtype[np.float64]]
ONSET, LASTING = 3.0, 0.3  # s
COARSE = 0.01  # s, of stamps that are coarse
START = {"reset": -1.5, "jump": 60.0, "wrap": 2**32 / 1e6 - 1.5}  # s, by which the onset is another in the log's time

WORDS = {
    "feet": ("ft/s²",),
    "counts": ("count",),
    "in g": ("looks like g",),
    "gravity removed": ("gravity",),
    "z up": ("z up",),
    "yawed": ("along +y", "along −y", "along −x"),
    "clipped": ("range",),
    "stuck": ("repeat",),
    "held": (),
    "one axis": (),
    "trailing": (),
    "commented": (),
    "units row": (),
    "decimal comma": ("decimal comma",),
    "millis": ("ms", "seconds"),
    "iso": (),
    "no header": ("header", "no names", "--map"),
    "back": ("back",),
    "reset": ("reset",),
    "bom": (),
    "utf-16": (),
    "semicolons": (),
    "spaces": (),
    "gap": (),
    "jump": (),
    "coarse": (),
    "rate": ("rate changes",),
    "wrap": ("wrap",),
}
"""Words that name a trait, of which one must be said if the launch is not found as it is; none: it must be found."""

TRAITS_OF_VALUES = (
    "feet",
    "counts",
    "in g",
    "gravity removed",
    "z up",
    "yawed",
    "clipped",
    "stuck",
    "held",
    "one axis",
)
TRAITS_OF_TEXT = tuple(name for name in WORDS if name not in TRAITS_OF_VALUES)


def made(peak: float, rate: float, sigma: float, seed: int) -> Array:
    """Return six seconds on a rail of 12° with a trapezoid of so many g; columns t, fx, fy, fz."""
    t = np.arange(round(6.0 * rate)) / rate
    push = peak * G0 * np.clip(np.minimum(t - ONSET, ONSET + LASTING - t) / 0.015, 0.0, 1.0)
    force = np.random.default_rng(seed).normal(0.0, sigma, (t.size, 3))
    force += G0 * np.array([0.208, 0.0, -0.978])
    force[:, 0] += push
    return np.column_stack([t, force])


def spoilt(readings: Array, trait: str, rate: float) -> Array:
    """Return readings with a trait of their values."""
    f = readings[:, 1:]
    if trait == "feet":
        f = f * (32.174 / G0)
    elif trait == "counts":
        f = np.round(f * (256.0 / G0))
    elif trait == "in g":
        f = f / G0
    elif trait == "gravity removed":
        f = f - G0 * np.array([0.208, 0.0, -0.978])
    elif trait == "z up":
        f = f * [1.0, -1.0, -1.0]
    elif trait == "yawed":
        f = np.column_stack([-f[:, 1], f[:, 0], f[:, 2]])
    elif trait == "clipped":
        f = np.clip(f, -2.0 * G0, 2.0 * G0)
    elif trait == "stuck":
        first, last = round(2.8 * rate), round(4.0 * rate)
        f = f.copy()
        f[first:last] = f[first]
    elif trait == "held":
        f = np.repeat(f[::3], 3, axis=0)[: len(f)]
    return np.column_stack([readings[:, 0], f])


def written(path: Path, readings: Array, trait: str, axes: int) -> str | None:
    """Write a log with a trait of its text; returns the map that it needs."""
    names, separator, factor = ["t", "fx", "fy", "fz"][: 1 + axes], ",", 1.0
    rows = readings[:, : 1 + axes]
    if trait == "millis":
        names[0], factor = "ms", 1000.0
    if trait == "back":
        rows = rows.copy()
        rows[len(rows) // 4, 0] -= 0.5 * (rows[1, 0] - rows[0, 0]) + (rows[2, 0] - rows[1, 0])
    if trait == "reset":
        rows = rows.copy()
        rows[len(rows) // 4 :, 0] -= rows[len(rows) // 4, 0]
    if trait == "gap":
        rows = np.delete(rows, slice(len(rows) // 4, len(rows) // 4 + 40), axis=0)
    if trait == "jump":
        rows = rows.copy()
        rows[len(rows) // 4 :, 0] += 60.0
    if trait == "coarse":
        rows = rows.copy()
        rows[:, 0] = np.floor(rows[:, 0] / COARSE + 1e-6) * COARSE
    if trait == "rate":
        rows = np.concatenate((rows[: len(rows) // 4 : 4], rows[len(rows) // 4 :]))
    if trait == "wrap":
        names[0], factor = "us", 1e6
        rows = rows.copy()
        rows[:, 0] = ((rows[:, 0] * 1e6 + 2**32 - 1_500_000) % 2**32) / 1e6
    if trait in ("semicolons", "decimal comma"):
        separator = ";"
    text = io.StringIO()
    np.savetxt(text, rows * [factor, *[1.0] * axes], fmt="%.4f", delimiter=separator)
    body, head, encoding = text.getvalue(), separator.join(names) + "\n", "utf-8"
    if trait == "decimal comma":
        body = body.replace(".", ",")
    elif trait == "trailing":
        body = body.replace("\n", ",\n")
    elif trait == "commented":
        head = f"# made by hand\n# {separator.join(names)}\n"
    elif trait == "units row":
        head += ",".join(["s", *["m/s^2"] * axes]) + "\n"
    elif trait == "iso":
        head = head.replace("t,", "time,", 1)
        stamps = np.datetime64("2026-05-01T12:00:00.000000") + (rows[:, 0] * 1e6).round().astype("timedelta64[us]")
        body = "".join(f"{s},{line.partition(',')[2]}\n" for s, line in zip(stamps, body.splitlines(), strict=True))
    elif trait == "no header":
        head = ""
    elif trait == "bom":
        encoding = "utf-8-sig"
    elif trait == "utf-16":
        encoding = "utf-16"
    elif trait == "spaces":
        head, body = head.replace(",", " , "), body.replace(",", " ,  ")
    path.write_text(head + body, encoding=encoding)
    return None


@settings(
    max_examples=60, deadline=None, derandomize=True, print_blob=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)  # fmt: skip
@given(
    peak=st.sampled_from([0.0, 2.3, 6.0, 7.0, 9.0]),
    rate=st.sampled_from([50.0, 100.0, 200.0, 500.0, 1000.0]),
    sigma=st.sampled_from([0.05, 0.3, 1.0]),
    of_values=st.sampled_from(["", *TRAITS_OF_VALUES]),
    of_text=st.sampled_from(["", *TRAITS_OF_TEXT]),
    seed=st.integers(0, 2**32 - 1),
)
def test_none_is_misread_without_a_word(
    tmp_path: Path, peak: float, rate: float, sigma: float, of_values: str, of_text: str, seed: int
) -> None:
    path = tmp_path / "log.csv"
    readings = spoilt(made(peak, rate, sigma, seed), of_values, rate)
    mapping = written(path, readings, of_text, 1 if of_values == "one axis" else 3)
    words = {word for trait in (of_values, of_text) if trait for word in WORDS[trait]}
    refused = ""
    try:
        score = replay_log(read_log([path], mapping)).score["recording"]
    except ValueError as error:
        refused = str(error)
    if refused:
        assert "\n" not in refused
        assert any(word in refused for word in words), refused
        return
    said = " | ".join(score["remarks"])
    launched = peak > 5.0
    onset = ONSET + (score["start"] if of_text == "iso" else START.get(of_text, 0.0))
    late = 0.15 if of_values == "held" or rate < 100.0 else 0.1
    found = [t for t in score["detections"] if onset < t < onset + late]
    right = len(found) == len(score["detections"]) == launched
    assert right or any(word in said for word in words), (score["detections"], said)
