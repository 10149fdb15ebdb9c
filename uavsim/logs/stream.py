"""A log's readings of specific force in chunks, for logs that do not fit into memory."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from uavsim.logs.mapping import read_log
from uavsim.logs.recording import Array

CHUNK = 200_000  # readings


def chunks(paths: Sequence[Path], mapping: str | None = None) -> Iterator[Array]:
    """Yield readings, shape (m, 4), in the order of the log; see `read_log`."""
    readings = read_log(paths, mapping).readings
    for first in range(0, len(readings), CHUNK):
        yield readings[first : first + CHUNK]
