"""Files that are whole or not there: each is written under another name, forced to the disk, and renamed.

Whatever ends the process, a file with its name is a whole one. A system's error (a full disk, a folder that has become
read-only) is one line that names the file.
"""

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Give the path to write to; it becomes `path` when the block ends well, and vanishes if not.

    Raises
    ------
    OSError
        It cannot be written; one line that names it.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        yield part
        force(part)
        part.replace(path)
    except OSError as error:
        raise OSError(f"{path} cannot be written: {reason(error)}") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def force(path: Path) -> None:
    """Have the system write a file to the disk now; a full one tells it then at the latest."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def reason(error: OSError) -> str:
    """The system's words for what went wrong, without number and path."""
    return os.strerror(error.errno) if error.errno else error.strerror or str(error)


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8."""
    with whole(path) as part:
        part.write_text(text, encoding="utf-8", errors="replace")  # a file's name may hold bytes that are no text


def write_bytes(path: Path, content: bytes) -> None:
    """Write bytes."""
    with whole(path) as part:
        part.write_bytes(content)


def write_json(path: Path, value: object) -> None:
    """Write JSON with numbers or null; a value that is not finite is an error of the caller."""
    write_text(path, json.dumps(value, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def write_toml(path: Path, value: Mapping[str, Any]) -> None:
    """Write TOML; keys whose value is None are left out, as TOML has no null."""
    import tomli_w

    write_text(path, tomli_w.dumps(without_none(value)))


def without_none(value: Any) -> Any:
    """The same nested value without the keys that hold None."""
    if isinstance(value, Mapping):
        return {key: without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [without_none(item) for item in value]
    return value
