"""The map that is advised for a log of other axes is one that mends it: taken as it stands, nothing is left to say."""

import re
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from uavsim.logs import read_log, replay_log
from uavsim.logs.mounting import turned
from uavsim.onboard.launch import DetectorSettings
from uavsim.truth import STANDARD_GRAVITY as G0

Axes = tuple[str, str, str]


def vector(axis: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return (1.0 if axis[0] == "+" else -1.0) * np.eye(3)["xyz".index(axis[1])]


SIGNED = tuple(sign + letter for letter in "xyz" for sign in "+-")
MOUNTS: list[Axes] = [
    (x, y, z)
    for x, y, z in product(SIGNED, repeat=3)
    if np.isclose(np.linalg.det(np.array([vector(a) for a in (x, y, z)])), 1.0)
]
"""Which of ours each axis of a sensor is: all rotations by quarters of a turn."""


def forces(pitch: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Three seconds on a rail and a stroke of 7 g from 2 s on, at 200 Hz; ours."""
    t = np.arange(600) / 200.0
    rest = G0 * np.array([np.sin(np.radians(pitch)), 0.0, -np.cos(np.radians(pitch))])
    force = np.random.default_rng(3).normal(0.0, 0.5, (t.size, 3)) + rest
    force[:, 0] += 7.0 * G0 * np.clip(np.minimum(t - 2.0, 2.3 - t) / 0.015, 0.0, 1.0)
    return np.column_stack([t, force])


def write(path: Path, pitch: float, mount: Axes, names: tuple[str, ...], scale: float = 1.0) -> Path:
    table = forces(pitch)
    table[:, 1:] = table[:, 1:] @ np.array([vector(axis) for axis in mount]).T / scale
    pd.DataFrame(table.round(6), columns=list(names)).to_csv(path, index=False)
    return path


def replayed(path: Path, mapping: str | None, kind: str = "adaptive-cusum") -> tuple[list[float], str]:
    score = replay_log(read_log([path], mapping), DetectorSettings(kind=kind)).score["recording"]
    return score["detections"], " | ".join(score["remarks"])


AXIS_DOUBTS = re.compile(r"lies along|points up|z up|nose")


def test_a_mount_is_a_rotation() -> None:
    assert len(MOUNTS) == 24
    for forward, up in product(SIGNED, (*SIGNED, None)):
        ours = np.array([vector(axis) for axis in turned(forward, up).values()])
        assert np.isclose(np.linalg.det(ours), 1.0)
        assert (ours[0] == vector(forward)).all()
        if up is not None and up[1] != forward[1]:
            assert (ours[2] == -vector(up)).all()


@pytest.mark.parametrize(("mount", "pitch"), [*((m, 12.0) for m in MOUNTS), *((m, 90.0) for m in MOUNTS[::4])])
def test_the_advice_for_any_mount_mends_it(tmp_path: Path, mount: Axes, pitch: float) -> None:
    path = write(tmp_path / "log.csv", pitch, mount, ("t", "fx", "fy", "fz"))
    found, said = replayed(path, None)
    maps = set(re.findall(r'--map "([^"]*)"', said))
    if mount[0] != "+x":
        assert not found
    if not maps:
        assert len(found) == 1
        return
    assert len(maps) == 1
    found, said = replayed(path, maps.pop())
    assert len(found) == 1
    assert not AXIS_DOUBTS.search(said), said


@pytest.mark.parametrize(
    ("names", "mapping", "scale"),
    [
        (("time", "ax", "ay", "az"), None, 1.0),
        (("Time (ms)", "ax (g)", "ay (g)", "az (g)"), None, G0),
        (("t", "fx", "fy", "fz"), None, 0.3048),
        (("at", "a 1", "a-2", "-a3"), "t=at,fx=-a 1,fy=-a-2,fz=--a3", -1.0),
        (("at", "a 1", "a-2", "-a3"), "fx=a 1*9.80665,fy=a-2*9.80665,fz=-a3*9.80665-0.2,t=at", G0),
    ],
)
def test_the_advice_is_of_the_logs_own_columns(
    tmp_path: Path, names: tuple[str, ...], mapping: str | None, scale: float
) -> None:
    path = write(tmp_path / "log.csv", 10.0, ("-z", "-y", "-x"), names, scale)
    if "ms" in names[0]:
        table = pd.read_csv(path)
        table[names[0]] *= 1e3
        table.to_csv(path, index=False)
    found, said = replayed(path, mapping)
    maps = set(re.findall(r'--map "([^"]*)"', said))
    assert (len(found), len(maps)) == (0, 1)
    found, said = replayed(path, maps.pop())
    assert len(found) == 1
    assert not AXIS_DOUBTS.search(said), said


def test_columns_without_names_are_turned_by_their_numbers(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", 10.0, ("-y", "+x", "+z"), ("t", "fx", "fy", "fz"))
    path.write_text(path.read_text().split("\n", 1)[1])
    _, said = replayed(path, None)
    mapping = re.findall(r'--map "([^"]*)"', said)[0]
    assert mapping == "t=1,fx=3,fy=-2,fz=4"
    assert len(replayed(path, mapping)[0]) == 1


@pytest.mark.parametrize("kind", ["px4", "ardupilot", "inav"])
def test_a_rule_that_reads_x_alone_is_told_of_the_other_axis(tmp_path: Path, kind: str) -> None:
    path = write(tmp_path / "log.csv", 10.0, ("-y", "+x", "+z"), ("t", "fx", "fy", "fz"))
    found, said = replayed(path, None, kind)
    assert not found
    assert "lies along +y" in said
    assert len(replayed(path, "fx=fy,fy=-fx,fz=fz", kind)[0]) >= 1
