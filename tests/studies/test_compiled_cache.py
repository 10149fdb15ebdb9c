"""Machine code that is kept from run to run: whatever is wrong with it, the loop is compiled anew and says the same."""

import errno
import importlib.util
import os
import pickle
import stat
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import pandas as pd
import pytest

from uavsim import machine_code
from uavsim.compiled import compiled, jit
from uavsim.onboard.launch import KINDS, DetectorSettings
from uavsim.studies import reach

pytestmark = pytest.mark.skipif(not jit(), reason="NUMBA_DISABLE_JIT is set")

ROOT = os.geteuid() == 0 if hasattr(os, "geteuid") else False
NOBODY = 65534  # user id of nobody, who is not us


class Kept:
    """A module with one function, in a folder of its own, and what numba keeps beside it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "__pycache__"
        self.name = f"loops_{folder.name}"
        self.module = folder / f"{self.name}.py"
        self.module.write_text("def double(x):\n    return 2 * x\n", encoding="utf-8")

    def run(self) -> int:
        """Compile or load as a new process would; how often it was loaded."""
        spec = importlib.util.spec_from_file_location(self.name, self.module)
        assert spec is not None
        assert spec.loader is not None
        module: ModuleType = importlib.util.module_from_spec(spec)
        sys.modules[self.name] = module  # where numba looks for it
        spec.loader.exec_module(module)
        made: Any = compiled(module.double)
        assert made(21) == 42
        return sum(made.code.stats.cache_hits.values())

    def files(self) -> list[Path]:
        return sorted(path for path in self.folder.iterdir() if path.suffix in {".nbi", ".nbc"})


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kept]:
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(machine_code._Private, "from_function", classmethod(lambda *_: None))
    made = Kept(tmp_path)
    assert made.run() == 0
    assert made.run() == 1
    assert len(made.files()) == 2
    yield made
    del sys.modules[made.name]


class Calling(Kept):
    """The same, whose function calls one of another module, with a number and an array of that."""

    OTHER = """
import numpy as np
from uavsim.compiled import compiled
FACTOR = 2
ROW = np.array([1.0, 0.0])
@compiled
def times(x):
    return FACTOR * x + ROW[1]
"""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.other = folder / f"other_{folder.name}.py"
        self.other.write_text(self.OTHER, encoding="utf-8")
        source = f"from {self.other.stem} import times\ndef double(x):\n    return times(x)\n"
        self.module.write_text(source, encoding="utf-8")

    def load(self) -> tuple[float, int]:
        """What a new process finds for 21, and how often that was loaded."""
        sys.modules.pop(self.other.stem, None)
        for path in (self.other, self.module):
            spec = importlib.util.spec_from_file_location(path.stem, path)
            assert spec is not None
            assert spec.loader is not None
            module = importlib.util.module_from_spec(spec)
            sys.modules[path.stem] = module
            exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), module.__dict__)
        made: Any = compiled(module.double)
        return made(21), sum(made.code.stats.cache_hits.values())


@pytest.mark.parametrize(
    ("old", "new", "asked"),
    [("FACTOR * x", "x * x", 441), ("FACTOR = 2", "FACTOR = 3", 63), ("[1.0, 0.0]", "[1.0, 4.0]", 46)],
)
def test_what_a_loop_takes_from_another_module_is_compiled_into_it(
    old: str, new: str, asked: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So a change there compiles it anew, though its own module has not changed."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(machine_code._Private, "from_function", classmethod(lambda *_: None))
    made = Calling(tmp_path)
    assert made.load() == (42, 0)
    assert made.load() == (42, 1)
    made.other.write_text(Calling.OTHER.replace(old, new), encoding="utf-8")
    assert made.load() == (asked, 0)
    assert made.load() == (asked, 1)
    for path in (made.other, made.module):
        del sys.modules[path.stem]


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1])


def halved(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) * 2 // 3] ^= 0x10
    path.write_bytes(content)


def garbage(path: Path) -> None:
    path.write_bytes(b"\x80\x04\x95" + bytes(range(256)))


def of_another_version(path: Path) -> None:
    path.write_bytes(pickle.dumps("0.0.1", protocol=-1) + path.read_bytes()[20:])


def longer(path: Path) -> None:
    path.write_bytes(path.read_bytes() + b"x")


def huge(path: Path) -> None:
    with path.open("ab") as file:
        file.truncate(machine_code.LARGEST + 1)


def gone(path: Path) -> None:
    path.unlink()


def a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def a_link(path: Path) -> None:
    path.rename(path.with_suffix(".away"))
    path.symlink_to(path.with_suffix(".away"))


def for_everybody(path: Path) -> None:
    path.chmod(0o666)


WAYS = [emptied, cut, halved, flipped, garbage, of_another_version, longer, huge, gone, a_pipe, a_link, for_everybody]


@pytest.mark.parametrize("which", [".nbi", ".nbc"])
@pytest.mark.parametrize("spoil", WAYS)
def test_a_damaged_file_is_compiled_anew_and_kept_again(kept: Kept, spoil: Callable[[Path], None], which: str) -> None:
    (path,) = (file for file in kept.files() if file.suffix == which)
    spoil(path)
    assert kept.run() == 0
    assert kept.run() == 1


def test_a_folder_in_a_files_place_is_no_error(kept: Kept) -> None:
    for path in kept.files():
        path.unlink()
        path.mkdir()
    assert kept.run() == 0
    assert kept.run() == 0


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_what_cannot_be_written_is_no_error(kept: Kept, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    for path in kept.files():
        path.unlink()
    monkeypatch.setattr(machine_code._Files, "_open_for_write", fail)
    assert kept.run() == 0
    assert kept.files() == []


class Attack:
    """Makes a file when it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Any, ...]:
        return (Path.touch, (self.mark,))


@pytest.mark.parametrize("which", [".nbi", ".nbc"])
def test_a_strangers_pickle_is_not_read(kept: Kept, tmp_path: Path, which: str) -> None:
    """Even where it is as numba itself writes it, and lies in our own folder."""
    mark = tmp_path / "run"
    (path,) = (file for file in kept.files() if file.suffix == which)
    version = pickle.dumps(numba.__version__, protocol=-1) if which == ".nbi" else b""
    path.write_bytes(version + pickle.dumps(Attack(mark)))
    assert kept.run() == 0
    assert not mark.exists()
    pickle.loads(pickle.dumps(Attack(mark)))
    assert mark.exists()  # or the test would say nothing


@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o757])
def test_a_folder_that_everybody_may_write_is_not_read(kept: Kept, mode: int) -> None:
    kept.folder.chmod(mode)
    assert kept.run() == 0
    kept.folder.chmod(0o755)
    assert kept.run() == 1


def test_a_folder_below_one_that_everybody_may_write_is_not_read(kept: Kept) -> None:
    kept.module.parent.chmod(0o777)
    assert kept.run() == 0
    kept.module.parent.chmod(0o755)
    assert kept.run() == 1


def test_those_who_may_write_the_module_may_write_its_machine_code(kept: Kept) -> None:
    """Where a group shares a checkout; the group alone is not enough."""
    for path in (kept.folder, *kept.files()):
        path.chmod(path.stat().st_mode | stat.S_IWGRP)
    assert kept.run() == 0
    kept.module.parent.chmod(0o775)
    assert kept.run() == 1


@pytest.mark.skipif(not ROOT, reason="only root gives files away")
def test_what_somebody_else_owns_is_not_read(kept: Kept) -> None:
    for path in kept.files():
        os.chown(path, NOBODY, -1)
    assert kept.run() == 0
    assert kept.run() == 1  # ours took its place
    os.chown(kept.folder, NOBODY, -1)
    assert kept.run() == 0


def test_the_folder_that_is_asked_for_is_made_for_the_user_alone(
    kept: Kept, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "asked"
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(place))
    assert kept.run() == 0
    assert kept.run() == 1
    (folder,) = place.iterdir()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    folder.chmod(0o777)
    assert kept.run() == 1  # from beside the module
    for path in folder.iterdir():
        path.unlink()
    kept.run()
    assert list(folder.iterdir()) == []


# -- the command line ------------------------------------------------------------------------------------------------


def roc(folder: Path, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    command = [
        sys.executable,
        "-m",
        "uavsim.cli",
        "roc",
        "--cells",
        "0",
        "--no-plots",
        "--out",
        str(folder),
        *arguments,
    ]
    return subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=600, env={**os.environ, **environment}
    )


@pytest.mark.parametrize("jit", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_roc_says_the_same_with_a_damaged_cache_or_without_the_jit(tmp_path: Path, jit: bool) -> None:
    small = ("--detectors", "cusum", "--hours", "0.02", "--trials", "10")
    cache = str(tmp_path / "cache")
    first = roc(tmp_path / "first", *small, NUMBA_CACHE_DIR=cache)
    assert first.returncode == 0, first.stderr
    files = [path for path in Path(cache).rglob("*") if path.suffix in {".nbi", ".nbc"}]
    assert {path.suffix for path in files} == {".nbi", ".nbc"}
    for path in files:
        emptied(path) if path.suffix == ".nbi" else halved(path)
    run = roc(tmp_path / "again", *small, **({"NUMBA_CACHE_DIR": cache} if jit else {"NUMBA_DISABLE_JIT": "1"}))
    assert (run.returncode, run.stderr) == (0, "")
    assert (tmp_path / "again" / "roc.csv").read_bytes() == (tmp_path / "first" / "roc.csv").read_bytes()


@pytest.mark.slow
def test_roc_ends_without_the_jit_for_rules_that_look_at_every_sample(tmp_path: Path) -> None:
    run = roc(
        tmp_path / "out",
        "--detectors",
        "cusum,adaptive-cusum",
        "--hours",
        "0.05",
        "--trials",
        "20",
        NUMBA_DISABLE_JIT="1",
    )
    assert (run.returncode, run.stderr) == (0, "")
    assert len(pd.read_csv(tmp_path / "out" / "roc.csv")) == 22


# -- what is left out without a JIT ----------------------------------------------------------------------------------


def test_with_loops_nothing_is_left_out() -> None:
    asked = reach.Work(1e5, 10_000_000, 1_000_000)
    assert reach.plain([DetectorSettings(kind=kind) for kind in KINDS], 1000.0) == []
    assert reach.within_reach(asked, detectors=0, compared=0, rate=1000.0) == asked
    assert reach.told(asked, asked, "") == ""


@pytest.mark.parametrize("detectors", [1, 11, 161])
@pytest.mark.parametrize("rate", [100.0, 1000.0, 4000.0])
def test_without_it_the_work_is_bounded_and_told(detectors: int, rate: float) -> None:
    """Samples times detectors stay within the bound, or are the least that can be counted: a piece of each class."""
    asked = reach.Work(1e5, 10_000_000, 1_000_000)
    done = reach.within_reach(asked, detectors=detectors, compared=30 * detectors, rate=rate)
    hours = done.hours * (1.0 + 3.0 * 0.25)
    least = 4 * reach.PIECE * rate * detectors
    assert hours * 3600.0 * rate * detectors <= max(reach.MOST, least)
    assert done.trials * reach.LAUNCH * rate * detectors <= reach.MOST_TRIED
    assert done.cells * reach.LAUNCH * rate * 30 * detectors <= max(
        reach.MOST_TRIED, reach.LAUNCH * rate * 30 * detectors
    )
    said = reach.told(asked, done, reach.OFF)
    assert said.startswith("numba's JIT is off (NUMBA_DISABLE_JIT): so that it ends in about ten minutes, ")
    assert "h of the mix instead of 100000" in said
    assert f"{done.trials} launches instead of 10000000" in said


def test_without_it_little_work_is_done_as_asked() -> None:
    asked = reach.Work(0.05, 20, 0)
    assert reach.within_reach(asked, detectors=22, compared=60, rate=1000.0) == asked


def test_a_budget_that_takes_too_long_without_the_jit_is_one_line() -> None:
    command = [sys.executable, "-m", "uavsim.cli", "tune", "catapult", "--false-alarms", "0.01"]
    run = subprocess.run(
        command, check=False, capture_output=True, text=True, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}
    )
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert "at most 100 h are run where numba's JIT is off; 0.0671 an hour can be shown" in run.stderr
    assert reach.tuning_told(72.0, 1000.0, reach.OFF).startswith(f"{reach.OFF}: this takes about 207 min")
