"""What a launch detector and the flight computer behind it do together: when the wings are commanded out.

A detector alone takes most soft drops along the launch axis for launches. What opens the wings is the function of both:
the flight computer follows what was recognised to the end of its stroke, and commands the wings only where the speed
gained until then is that of a launch (`uavsim.onboard.stroke`); else it rearms after a delay, in which it is deaf.
Decisions are those of `FlightComputer`, bit for bit, at the times k / rate, where no offset of the accelerometer has
been found on the rail: disturbances have none.

In hours of disturbances, after a command it goes on as after a knock: an aircraft whose wings have opened on the rail
is put back.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from uavsim.compiled import jit
from uavsim.onboard.flight_computer import FlightComputerSettings, stroke_settings
from uavsim.onboard.launch import DetectorSettings
from uavsim.onboard.launch.compiled import Forces
from uavsim.onboard.stroke import follow, samples_of
from uavsim.studies.detections import BatchDetector


@dataclass(frozen=True, slots=True)
class Decision:
    """One recognition: its sample, that at which the stroke is over, and whether the wings are then commanded."""

    recognised: int
    over: int
    launch: bool


def launch_axis(settings: DetectorSettings) -> str:
    """Signed body axis that the flight computer integrates along: the detector's where it has one, else +x."""
    return settings.axes[0] if not isinstance(settings.axes, str) and len(settings.axes) == 1 else "+x"


def along(force: Forces, axis: str) -> Forces:
    """Specific force along a signed body axis, m/s²; of a record of one axis that is the one."""
    column = force if force.ndim == 1 else force[:, "xyz".index(axis[1])]
    return cast(Forces, np.ascontiguousarray(column if axis[0] == "+" else -column))


def decide(
    detector: BatchDetector,
    force: Forces,
    computer: FlightComputerSettings,
    *,
    first: int,
    rate: float | None = None,
) -> Iterator[Decision]:
    """Follow a detector and the flight computer through a record.

    Parameters
    ----------
    detector
        As new at its first sample.
    force
        Specific force, m/s²: shape (n, 3), or (n,) along the body axis that is read.
    computer
        How it tells a launch.
    first
        Sample of the detector's first alarm, which its caller has looked for; -1: none.
    rate
        Samples a second that the clock really gave, Hz; the detector's nominal rate without it.

    Yields
    ------
    Decision
        As long as the stroke's end is in the record.
    """
    if first < 0:
        return
    rate = detector.rate if rate is None else rate
    level, mean, hold = stroke_settings(computer)
    axial = along(force, launch_axis(detector.settings))
    state, recent = np.array([0.0, np.nan, 0.0]), np.zeros(2 * samples_of(mean, detector.rate))
    record: Any = axial if jit() else axial.tolist()
    read = None
    alarm, rest = first, 0
    while alarm >= 0:
        over = int(follow(record, rest, alarm, rate, level, hold, recent, state))
        if over < 0:
            return
        yield Decision(alarm, over, bool(state[2] >= computer.speed_gain_min))
        rest = _first_at(over, computer.rearm_delay, rate) + 1
        if rest >= len(axial):
            return
        read = detector.read(force) if read is None else read
        alarm = detector.next_alarm(read, rest, rate)


def _first_at(over: int, delay: float, rate: float) -> int:
    """Sample with which the computer rearms: the first after `over` whose time is not before the delay's end."""
    until, k = over / rate + delay, over + max(1, ceil(delay * rate) - 1)
    while k / rate < until:
        k += 1
    return k


def commands(
    detector: BatchDetector, force: Forces, computer: FlightComputerSettings, *, first: int, rate: float | None = None
) -> NDArray[np.int64]:
    """Samples of a record at which the stroke is over and the wings are commanded; see `decide`."""
    decisions = decide(detector, force, computer, first=first, rate=rate)
    return np.array([one.over for one in decisions if one.launch], np.int64)
