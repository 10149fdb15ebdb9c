"""Files that a user hands over: only regular ones are opened, none that is too large, packed ones within a bound.

A pipe or a device may never end, and a few packed bytes may unpack to any number. What is wrong is said without the
file's name, which the caller puts before it.
"""

import bz2
import gzip
import io
import lzma
import os
import stat
import struct
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

LARGEST = 1_000_000_000  # B, of a file that is read as a whole
LONGEST = 1_000_000_000_000  # B, of one that is read in parts
UNPACKED = 500_000_000  # B, of what a packed one holds; it is kept in memory
DICTIONARY = 128 * 2**20  # B, that unpacking xz may take; its strongest setting takes 65 MB
HEAD = 512  # B by which formats are told apart
BINARY = 0.01  # share of control characters beyond which a file is no text


@dataclass(frozen=True, slots=True)
class Held:
    """What a file holds: the file itself, or in memory if it was packed.

    Attributes
    ----------
    path : Path
    unpacked : bytes or None
        None if it is read from the file.
    head : bytes
        The first `HEAD`, or fewer.
    """

    path: Path
    unpacked: bytes | None
    head: bytes

    def open(self) -> BinaryIO:
        """Open it for reading, from its first byte."""
        return self.path.open("rb") if self.unpacked is None else io.BytesIO(self.unpacked)

    def content(self) -> bytes:
        """All of it; ValueError, one line, if that is too much."""
        _check_whole(self.size)
        return self.path.read_bytes() if self.unpacked is None else self.unpacked

    @property
    def size(self) -> int:
        """B, unpacked."""
        return self.path.stat().st_size if self.unpacked is None else len(self.unpacked)

    def first(self, size: int) -> bytes:
        """Return the first bytes, not more than `size`."""
        with self.open() as file:
            return file.read(size)


def look(path: Path) -> Held:
    """Look at a file without reading it, unpacking it if it is packed.

    Raises
    ------
    ValueError
        One line: there is none, it is no regular file, cannot be opened, is too large, or cannot be unpacked.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        leads = "is a link that leads nowhere" if path.is_symlink() else "there is no such file"
        raise ValueError(leads) from None
    except IsADirectoryError:
        raise ValueError("there is no such file, but a folder of that name") from None
    except OSError as error:
        raise ValueError(f"cannot be opened: {error.strerror}") from None
    try:
        found = os.fstat(descriptor)
        _check(found)
        head = os.read(descriptor, HEAD)
        if head and not found.st_size:
            raise ValueError("is a file of the system, of no size: write what it gives to a file, and name that")
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror}") from None
    finally:
        os.close(descriptor)
    unpack = _packing(head)
    if unpack is None:
        return Held(path, None, head)
    unpacked = _unpacked(path, unpack)
    if not unpacked:
        raise ValueError("is empty when unpacked")
    if _packing(unpacked[:HEAD]) is not None:
        raise ValueError("is packed twice: unpack it first")
    return Held(path, unpacked, unpacked[:HEAD])


def _check(found: os.stat_result) -> None:
    """Refuse what is no regular file, or too large."""
    if stat.S_ISDIR(found.st_mode):
        raise ValueError("there is no such file, but a folder of that name")
    if not stat.S_ISREG(found.st_mode):
        raise ValueError("is a pipe, a device or a socket: write what it gives to a file, and name that")
    if found.st_size > LONGEST:
        raise ValueError(f"has {found.st_size / 1e9:.3g} GB; at most {LONGEST / 1e9:g} GB are read")


def _check_whole(size: int) -> None:
    if size > LARGEST:
        raise ValueError(
            f"has {size / 1e9:.3g} GB; of its kind at most {LARGEST / 1e9:g} GB are read (text, Parquet and Feather "
            "may have more, for they are read in parts)"
        )


def is_binary(head: bytes) -> bool:
    """Whether the beginning of a file is no text, in an encoding without zeros."""
    control = sum(byte < 0x20 and byte not in b"\t\n\r\x0b\x0c\x1a" for byte in head)
    return 0 in head or control > BINARY * len(head)


# -- unpacking -------------------------------------------------------------------------------------------------------

Unpack = Callable[[BinaryIO], bytes]


def _gzip(file: BinaryIO) -> bytes:
    with gzip.GzipFile(fileobj=file) as packed:
        return packed.read(UNPACKED + 1)


def _bzip2(file: BinaryIO) -> bytes:
    with bz2.BZ2File(file) as packed:
        return packed.read(UNPACKED + 1)


def _xz(file: BinaryIO) -> bytes:
    packed = lzma.LZMADecompressor(memlimit=DICTIONARY)
    content = packed.decompress(file.read(), UNPACKED + 1)
    if len(content) <= UNPACKED and not packed.eof:
        raise EOFError("it ends before its end")
    return content


def _zip(file: BinaryIO) -> bytes:
    with zipfile.ZipFile(file) as packed:
        inside = [one for one in packed.infolist() if not one.is_dir() and not one.filename.startswith("__MACOSX/")]
        if len(inside) != 1:
            raise ValueError(f"is a zip archive of {len(inside)} files, not of one: unpack it, and name the file")
        with packed.open(inside[0]) as member:
            return member.read(UNPACKED + 1)


def _other(name: str) -> Unpack:
    def refuse(_: BinaryIO) -> bytes:
        raise ValueError(f"is packed by {name}: unpack it first (gzip, bzip2, xz and zip are read)")

    return refuse


PACKED: dict[bytes, Unpack] = {
    b"\x1f\x8b\x08": _gzip,
    b"PK\x03\x04": _zip,
    b"PK\x05\x06": _zip,
    b"\xfd7zXZ\x00": _xz,
    **{b"BZh%d" % level: _bzip2 for level in range(1, 10)},
    b"\x28\xb5\x2f\xfd": _other("zstd"),
    b"7z\xbc\xaf\x27\x1c": _other("7-Zip"),
    b"Rar!\x1a\x07": _other("RAR"),
}
"""Ways to unpack, by the first bytes of a file."""


def _packing(head: bytes) -> Unpack | None:
    if head[257:262] == b"ustar":
        return _other("tar")
    return next((unpack for magic, unpack in PACKED.items() if head.startswith(magic)), None)


def _unpacked(path: Path, unpack: Unpack) -> bytes:
    _check_whole(path.stat().st_size)
    try:
        with path.open("rb") as file:
            content = unpack(file)
    except (
        OSError,
        EOFError,
        zlib.error,
        lzma.LZMAError,
        zipfile.BadZipFile,
        RuntimeError,
        NotImplementedError,
        struct.error,
        UnicodeError,
        OverflowError,
        LookupError,
    ) as error:
        raise ValueError(f"is packed and cannot be unpacked ({' '.join(str(error).split())[:200]})") from None
    if len(content) > UNPACKED:
        raise ValueError(f"unpacks to more than {UNPACKED / 1e6:g} MB: unpack it first, and take out what is needed")
    return content
