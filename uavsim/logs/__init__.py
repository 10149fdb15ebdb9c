"""Somebody's log turned into readings, and the launch detector run over them.

A log is one file or several: a table (CSV, Parquet), a PX4 ULog or an ArduPilot DataFlash log. A map says which of its
columns are time t, s, and specific force fx, fy, fz, m/s² in body axes forward-right-down (what an accelerometer feels:
at rest, level, fz = -9.81 m/s²). Sign and factor stand in the map: ``fx=-Ay``, ``fx=ax*9.80665``. Time stays that of
the log, wherever it starts.

The detector is that of the packaged scenarios, built for the log's median rate 1/median(Δt), or another. What is true
is not known of a recording: the score holds the detections, and null for whatever needs the truth.
"""

from uavsim.logs.long import LongReplay, replay_long
from uavsim.logs.mapping import read_log
from uavsim.logs.recording import SERIES, Clipping, Gap, Recording, Series
from uavsim.logs.replay import replay_log
from uavsim.logs.stream import Stream, chunks, is_long
from uavsim.logs.watch import PAUSE

__all__ = [
    "PAUSE",
    "SERIES",
    "Clipping",
    "Gap",
    "LongReplay",
    "Recording",
    "Series",
    "Stream",
    "chunks",
    "is_long",
    "read_log",
    "replay_log",
    "replay_long",
]
