"""Ready or not, with reasons, before the launch: what the flight computer says of its sensors on the rail.

The estimator knows of its head (`Estimator.doubts`). The accelerometer is judged here, on its readings as they came:
f_x is `silent`, `invalid`, out of `range` or `stuck` as `uavsim.onboard.life` has it, and

    offset   an axis is off what the rail must give by more than `FAR`, and than `FAR_SD` standard deviations of what
             the part's description allows

An offset within that is found on the rail and flown with (`uavsim.onboard.rail_offset`). Not ready stops no launch: it
is told, as an event, whenever it changes.
"""

from math import inf

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.life import WORDS, SensorLife
from uavsim.onboard.plausible import MOST_FORCE
from uavsim.onboard.rail_offset import RailOffset
from uavsim.onboard.repeats import force_row

SILENT = 0.25  # s: 250 readings at 1 kHz. By hand; a launch is recognised in a tenth of that
PERIODS = 10.0  # the same of a slow accelerometer
SETTLED = 1.0  # s of readings before anything is said. By hand
PACE = 0.25  # s between two looks
FAR, FAR_SD = 6.0, 4.0  # m/s² (more than the rail can hide at any elevation that is off by 30°), standard deviations


class Readiness:
    """The accelerometer's check, and the pace at which all are asked.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of the accelerometer.
    rail : RailOffset or None
        What finds its offset.

    Attributes
    ----------
    due : float
        When the next look is due, s.
    """

    __slots__ = ("_begun", "_life", "_noise", "_rail", "due")

    def __init__(self, noise: NoiseModel, rail: RailOffset | None = None) -> None:
        self._noise, self._rail = noise, rail
        low, high = noise.accelerometer_range
        rate = noise.accelerometer_rate
        self._life = SensorLife(
            (max(low, -MOST_FORCE), min(high, MOST_FORCE)),
            max(SILENT, PERIODS / rate),
            max(force_row(noise), rate * SILENT),
        )
        self.due = -inf
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._life.forget()
        self._begun = False

    def add(self, t: float, fx: float) -> None:
        """Take f_x as it came, m/s², whose stamp is believed, s."""
        self._begun = True
        self._life.add(t, fx)

    def look(self, t: float, doubts: tuple[str, ...] | None, begun: float) -> tuple[str, ...] | None:
        """Return all reasons at `t`, s, with those of the estimator; None while it is too early to say.

        Parameters
        ----------
        t : float
            s.
        doubts : tuple of str or None
            Of the estimator.
        begun : float
            When the first reading of any sensor came, s.
        """
        self.due = t + PACE
        if doubts is None or t - begun < SETTLED:
            return None
        wrong = self._life.wrong(t) if self._begun else "silent"
        reasons = [f"accelerometer: {WORDS[wrong]}"] if wrong else []
        remainder = None if self._rail is None or wrong else self._rail.remainder
        if remainder is not None:
            noise = self._noise
            own = noise.own_offset_sd, noise.own_side_offset_sd, noise.own_lift_offset_sd
            for axis, off, sd in zip("xyz", remainder, own, strict=True):
                if abs(off) > max(FAR, FAR_SD * sd):
                    reasons.append(f"accelerometer: f_{axis} is {off:.1f} m/s² off what the rail gives")
        return (*reasons, *doubts)
