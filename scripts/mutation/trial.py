"""Try mutants: each in a copy of the tree of its worker's own, so that nothing else is touched."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, Queue

from mutation.changes import Mutant
from mutation.strata import ROOT, STRATA

COPIED = ("aircraft", "docs", "pyproject.toml", "README.md", "scripts", "sensors", "tests", "uavsim")

Tests = tuple[str, ...]
"""Files of tests, in the order in which they run."""


class Copy:
    """A copy of the tree that one worker changes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._changes = 0
        self._process: subprocess.Popen[bytes] | None = None
        for name in COPIED:
            skipped = shutil.ignore_patterns("__pycache__", "*.so")
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, folder / name, ignore=skipped)
            elif (ROOT / name).is_file():
                shutil.copy2(ROOT / name, folder / name)

    def run(self, tests: Tests, mutant: Mutant | None = None, limit: float | None = None) -> tuple[str, float]:
        """Run tests against a mutant; return how they ended, 'passed', 'failed' or 'time', and how long it took, s."""
        if mutant is None:
            return self._tests(tests, limit, "sound")
        path = self.folder / mutant.file
        sound = path.read_text(encoding="utf-8")
        cache = f"mutant{self._changes}" if "compiled" in sound else "sound"
        self._write(path, mutant.applied(sound))
        try:
            return self._tests(tests, limit, cache)
        finally:
            self._write(path, sound)
            if cache != "sound":
                shutil.rmtree(self.folder / cache, ignore_errors=True)

    def _write(self, path: Path, text: str) -> None:
        """Write with a time of its own: by time and size Python and numba tell whether what they keep still holds."""
        path.write_text(text, encoding="utf-8")
        self._changes += 1
        stamp = 1_000_000_000 + self._changes
        os.utime(path, (stamp, stamp))

    def _tests(self, tests: Tests, limit: float | None, cache: str) -> tuple[str, float]:
        plain = ["-x", "-q", "--no-header", "-p", "no:cacheprovider", "-p", "no:xdist", "-m", "not slow"]
        command = [sys.executable, "-m", "pytest", *plain, *tests]
        kept = {"PYTHONPATH": str(self.folder), "NUMBA_CACHE_DIR": str(self.folder / cache)}
        began = time.monotonic()
        with (self.folder / "tests.log").open("wb") as log:
            process = subprocess.Popen(
                command, cwd=self.folder, env=os.environ | kept, stdout=log, stderr=log, start_new_session=True
            )
            self._process = process
            try:
                status = process.wait(limit)
            except subprocess.TimeoutExpired:
                return "time", time.monotonic() - began
            finally:
                self.stop()
                process.wait()
        return ("passed" if status == 0 else "failed"), time.monotonic() - began

    def stop(self) -> None:
        """End the tests that run, and all that they have started."""
        if self._process is not None and self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)


@dataclass(frozen=True)
class Result:
    """What became of a mutant."""

    stratum: str
    mutant: Mutant
    ended: str
    seconds: float

    @property
    def killed(self) -> bool:
        """Whether a test saw it."""
        return self.ended != "passed"


def run(todo: list[tuple[str, Mutant]], workers: int, folder: Path) -> list[Result]:
    """Run the sound code, then all mutants; a line for each on standard error.

    Returns
    -------
    list of Result
        Of all; after an interrupt of those that were finished.

    Raises
    ------
    RuntimeError
        If a test fails on the sound code.
    """
    copies = [Copy(folder / str(i)) for i in range(workers)]
    limits = {stratum: _limit(copies[0], stratum) for stratum in dict.fromkeys(stratum for stratum, _ in todo)}
    queue: Queue[tuple[str, Mutant]] = Queue()
    for item in todo:
        queue.put(item)
    results: list[Result] = []
    ended: list[BaseException] = []

    def work(own: Copy) -> None:
        try:
            while True:
                stratum, mutant = queue.get_nowait()
                result = Result(stratum, mutant, *own.run(STRATA[stratum][1], mutant, limits[stratum]))
                if ended:
                    return
                results.append(result)
                where = f"{mutant.file}:{mutant.line} {mutant.what}"
                sys.stderr.write(f"{len(results)}/{len(todo)} {result.ended} {result.seconds:.0f} s  {where}\n")
        except Empty:
            pass
        except BaseException as error:  # noqa: BLE001 - handed on below
            ended.append(error)

    threads = [threading.Thread(target=work, args=(own,), daemon=True) for own in copies]
    for thread in threads:
        thread.start()
    try:
        for thread in threads:
            thread.join()
    except KeyboardInterrupt as interrupt:
        ended.append(interrupt)
        for own, thread in zip(copies, threads, strict=True):
            own.stop()
            thread.join()
    if ended and not isinstance(ended[0], KeyboardInterrupt):
        raise ended[0]
    return results


def _limit(own: Copy, stratum: str) -> float:
    """Return how long the tests of a stratum may take, s, from how long they take on the sound code."""
    ended, seconds = own.run(STRATA[stratum][1])
    if ended != "passed":
        tail = (own.folder / "tests.log").read_text(encoding="utf-8").splitlines()[-5:]
        raise RuntimeError("\n".join([f"the tests of {stratum!r} fail on the sound code", *tail]))
    sys.stderr.write(f"{stratum}: sound in {seconds:.1f} s\n")
    return 2.0 * seconds + 10.0
