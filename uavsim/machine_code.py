"""Machine code of the compiled loops, kept from run to run in a folder that nobody else can write.

What is kept is read again as a pickle, and whoever writes a pickle says what is run. A folder is therefore used only if
nobody can write into it but the user, root, and, beside the module, those who can write the module itself. A folder
that everybody may write is never used. The first that serves is taken:

    NUMBA_CACHE_DIR/FOLDER_…                   if that is set; FOLDER: that of the module
    __pycache__                                beside the module
    uavsim/compiled/FOLDER_…                   in the user's cache, made for the user alone

What is kept counts as long as the module, and all that the loop takes from elsewhere (`uavsim.compiled`), are as they
were: machine code holds within it that of the functions that it calls, and the numbers of their modules.

Every file begins with the SHA-256 of what follows, an index with numba's version before it. A file that is cut,
damaged, unreadable or of another version counts as none: the loop is compiled anew. That a file cannot be written is no
error either.
"""

# mypy: disable-error-code="no-untyped-call, no-any-return"
# numba tells no types of what keeps its machine code.

import hashlib
import os
import pickle
import stat
import tempfile
from contextlib import suppress
from typing import Any

from numba import njit
from numba.core import caching
from numba.misc.appdirs import AppDirs

LARGEST = 64 * 2**20  # B, of a kept file; ours have up to 100 kB
DIGEST = hashlib.sha256().digest_size
_OPENED = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


def _writers(found: os.stat_result) -> set[str]:
    """Who may write a file or folder."""
    may = {f"user {found.st_uid}"}
    if found.st_mode & stat.S_IWGRP:
        may.add(f"group {found.st_gid}")
    if found.st_mode & stat.S_IWOTH:
        may.add("everybody")
    return may


def _trusted(folder: str, source: str) -> set[str]:
    """Who may write what is kept in a folder for a module."""
    if os.name == "nt":  # pragma: no cover (no such modes; a user's folders are closed there)
        return {f"user {os.stat(folder).st_uid}"}
    may = {"user 0", f"user {os.geteuid()}"}
    beside = os.path.dirname(os.path.realpath(source))
    if os.path.dirname(folder) == beside:
        may |= _writers(os.stat(beside)) - {"everybody"}
    return may


def _check(folder: str, source: str) -> None:
    """Refuse a folder that others may write, or whose place they may take."""
    if not _writers(os.stat(folder)) <= _trusted(folder, source):
        raise PermissionError(f"{folder}: others may write there")
    above = os.path.dirname(folder)
    while above != os.path.dirname(above):
        mode = os.stat(above).st_mode
        if mode & stat.S_IWOTH and not mode & stat.S_ISVTX:
            raise PermissionError(f"{above}: everybody may write there")
        above = os.path.dirname(above)


class _Closed:
    """A place of numba's that is used only if it is closed to others."""

    mode = 0o700
    _py_file: str

    def get_cache_path(self) -> str:
        return os.path.realpath(super().get_cache_path())  # type: ignore[misc]  # numba's locator

    def ensure_cache_path(self) -> None:
        """Make the folder; OSError if it cannot be used."""
        folder = self.get_cache_path()
        os.makedirs(folder, mode=self.mode, exist_ok=True)
        _check(folder, self._py_file)
        tempfile.TemporaryFile(dir=folder).close()


class _Asked(_Closed, caching.UserProvidedCacheLocator):
    """NUMBA_CACHE_DIR."""


class _Beside(_Closed, caching.InTreeCacheLocator):
    """Beside the module, as Python's own compiled files."""

    mode = 0o777


class _Private(_Closed, caching.UserWideCacheLocator):
    """In the user's cache."""

    def __init__(self, py_func: Any, py_file: str) -> None:
        super().__init__(py_func, py_file)
        home = AppDirs(appname="uavsim", appauthor=False).user_cache_dir
        self._cache_path = os.path.join(home, "compiled", self.get_suitable_cache_subpath(py_file))


class _Places(caching.CompileResultCacheImpl):
    _locator_classes = [_Asked, _Beside, _Private]  # noqa: RUF012 (numba's own name)


class _Files(caching.IndexDataCacheFile):
    """A function's files, each with the digest of what it holds before it."""

    def __init__(self, folder: str, base: str, stamp: Any, source: str) -> None:
        super().__init__(cache_path=folder, filename_base=base, source_stamp=stamp)
        self._source = source

    def _dump(self, obj: Any) -> bytes:
        data = super()._dump(obj)
        return hashlib.sha256(data).digest() + data

    def _load_index(self) -> dict[Any, Any]:
        version = pickle.dumps(self._version, protocol=-1)  # as `_save_index` writes it; it is compared, not read
        try:
            content = self._content(self._index_path)
            if not content.startswith(version):
                return {}
            stamp, overloads = pickle.loads(_sound(content[len(version) :]))  # noqa: S301 (only we wrote it)
        except OSError:
            return {}
        return overloads if stamp == self._source_stamp else {}

    def _load_data(self, name: str) -> Any:
        return pickle.loads(_sound(self._content(self._data_path(name))))  # noqa: S301 (only we wrote it)

    def _content(self, path: str) -> bytes:
        """Bytes of a file that only those wrote who may; OSError if it is none."""
        _check(self._cache_path, self._source)
        with open(os.open(path, _OPENED), "rb") as file:
            found = os.fstat(file.fileno())
            if not stat.S_ISREG(found.st_mode) or found.st_size > LARGEST:
                raise OSError(f"{path}: not a kept file")
            if not _writers(found) <= _trusted(self._cache_path, self._source):
                raise PermissionError(f"{path}: others may write it")
            return file.read(LARGEST)


def _sound(content: bytes) -> bytes:
    """Return what follows the digest; OSError if that is not of it."""
    data = content[DIGEST:]
    if hashlib.sha256(data).digest() != content[:DIGEST]:
        raise OSError("a kept file is damaged")
    return data


class Kept(caching.FunctionCache):
    """A function's machine code from earlier runs; none where anything is wrong with it."""

    _impl_class = _Places

    def __init__(self, function: Any, digest: str) -> None:
        super().__init__(function)
        place = self._impl.locator
        stamp = (place.get_source_stamp(), digest)
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp, place._py_file)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what is kept for a signature, or None."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # noqa: BLE001 (what a pickle of another version raises is not known)
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, if that can be."""
        with suppress(Exception):  # a full disk, a folder that has gone: compiled anew next time
            super().save_overload(sig, data)


def compile_function(function: Any, digest: str) -> Any:
    """Return what compiles a function at its first call, without the interpreter's lock, and keeps the machine code.

    `digest` is that of all that the function is made of.
    """
    made: Any = njit(nogil=True, error_model="numpy")(function)
    with suppress(RuntimeError, OSError, AttributeError, TypeError):  # nowhere to keep it, or another numba's insides
        made._cache = Kept(function, digest)
    return made
