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
        for name in COPIED:
            skipped = shutil.ignore_patterns("__pycache__", "*.so")
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, folder / name, ignore=skipped)
            elif (ROOT / name).is_file():
                shutil.copy2(ROOT / name, folder / name)

    def run(
        self, tests: tuple[str, ...], mutant: Mutant | None = None, limit: float | None = None
    ) -> tuple[str, float]:
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
            process = subprocess.Popen(  # noqa: S603 - ours
                command, cwd=self.folder, env=os.environ | kept, stdout=log, stderr=log, start_new_session=True
            )
            try:
                status = process.wait(limit)
            except subprocess.TimeoutExpired:
                return "time", time.monotonic() - began
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
        return ("passed" if status == 0 else "failed"), time.monotonic() - began


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
    """Run the sound code, then all mutants; a line for each on standard error."""
    copies = [Copy(folder / str(i)) for i in range(workers)]
    limits = {}
    for stratum in dict.fromkeys(stratum for stratum, _ in todo):
        ended, seconds = copies[0].run(STRATA[stratum][1])
        if ended != "passed":
            tail = (copies[0].folder / "tests.log").read_text(encoding="utf-8").splitlines()[-5:]
            raise RuntimeError("\n".join([f"the tests of {stratum!r} fail on the sound code", *tail]))
        limits[stratum] = 2.0 * seconds + 10.0
        sys.stderr.write(f"{stratum}: sound in {seconds:.1f} s\n")
    queue: Queue[tuple[str, Mutant]] = Queue()
    for item in todo:
        queue.put(item)
    results: list[Result] = []
    failed: list[BaseException] = []

    def work(own: Copy) -> None:
        try:
            while not failed:
                stratum, mutant = queue.get_nowait()
                ended, seconds = own.run(STRATA[stratum][1], mutant, limits[stratum])
                results.append(Result(stratum, mutant, ended, seconds))
                text = f"{len(results)}/{len(todo)} {ended} {seconds:.0f} s  {mutant.file}:{mutant.line} {mutant.what}"
                sys.stderr.write(text + "\n")
        except Empty:
            pass
        except BaseException as error:  # noqa: BLE001 - handed on below
            failed.append(error)

    threads = [threading.Thread(target=work, args=(own,), daemon=True) for own in copies]
    for thread in threads:
        thread.start()
    try:
        for thread in threads:
            thread.join()
    except KeyboardInterrupt:
        failed.append(KeyboardInterrupt())
        for thread in threads:
            thread.join()
    if failed and not isinstance(failed[0], KeyboardInterrupt):
        raise failed[0]
    return results
