"""Ready or not, with reasons, before the launch: what the flight computer says of its sensors on the rail.

The estimator knows of its head (`Estimator.doubts`). The accelerometer is judged here, on its readings as they came:

    silent   no reading for `SILENT`
    invalid  nothing but NaN for so long
    range    f_x at or beyond the ends of its range for so long
    stuck    the same f_x for longer than the part's own noise allows (`uavsim.onboard.repeats`)
    offset   an axis is off what the rail must give by more than `FAR`, and than `FAR_SD` standard deviations of what
             the part's description allows

An offset within that is found on the rail and flown with (`uavsim.onboard.rail_offset`). Not ready stops no launch: it
is told, as an event, whenever it changes.
"""

from math import hypot, inf, isfinite, nan

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.plausible import MOST_FORCE
from uavsim.onboard.rail_offset import RailOffset
from uavsim.onboard.repeats import alike, longest_row

SILENT = 0.25  # s: 250 readings at 1 kHz. By hand; a launch is recognised in a tenth of that
PERIODS = 10.0  # the same of a slow accelerometer
SETTLED = 1.0  # s of readings before anything is said. By hand
PACE = 0.25  # s between two looks
FAR, FAR_SD = 6.0, 4.0  # m/s² (more than the rail can hide at any elevation that is off by 30°), standard deviations

WORDS = {
    "silent": "no reading comes",
    "invalid": "its readings are no numbers",
    "range": "its readings are at or beyond the ends of its range",
    "stuck": "it repeats one number for longer than its noise allows",
}


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

    __slots__ = (
        "_came", "_first", "_good", "_high", "_last", "_low", "_nan", "_noise", "_pause", "_rail", "_row", "_same",
        "due",
    )  # fmt: skip

    def __init__(self, noise: NoiseModel, rail: RailOffset | None = None) -> None:
        self._noise, self._rail = noise, rail
        low, high = noise.accelerometer_range
        self._low, self._high = max(low, -MOST_FORCE), min(high, MOST_FORCE)
        rate = noise.accelerometer_rate
        self._pause = max(SILENT, PERIODS / rate)
        p = alike(hypot(noise.accelerometer_white_sd, noise.accelerometer_step / 12.0**0.5), noise.accelerometer_step)
        self._row = max(longest_row(p), rate * SILENT)
        self.due = -inf
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self._first, self._came, self._good = inf, -inf, -inf
        self._last, self._same, self._nan = nan, 0, False

    def add(self, t: float, fx: float) -> None:
        """Take f_x as it came, m/s², whose stamp is believed, s."""
        self._came = t
        if self._first == inf:
            self._first = t
        if self._low < fx < self._high:
            self._good = t
            self._same = self._same + 1 if fx == self._last else 0
            self._last = fx
        else:
            self._nan = not isfinite(fx)

    def wrong(self, t: float) -> str:
        """Return what is wrong with the accelerometer at `t`, s; "" for nothing, or for too little time to tell."""
        since = t - self._pause
        if self._first > since:
            return ""
        if self._came < since:
            return "silent"
        if self._good < since:
            return "invalid" if self._nan else "range"
        return "stuck" if self._same >= self._row else ""

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
        wrong = self.wrong(t) if self._first < inf else "silent"
        reasons = [f"accelerometer: {WORDS[wrong]}"] if wrong else []
        remainder = None if self._rail is None or wrong else self._rail.remainder
        if remainder is not None:
            noise = self._noise
            own = noise.own_offset_sd, noise.own_side_offset_sd, noise.own_lift_offset_sd
            for axis, off, sd in zip("xyz", remainder, own, strict=True):
                if abs(off) > max(FAR, FAR_SD * sd):
                    reasons.append(f"accelerometer: f_{axis} is {off:.1f} m/s² off what the rail gives")
        return (*reasons, *doubts)
