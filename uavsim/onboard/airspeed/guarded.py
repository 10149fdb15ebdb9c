"""Airspeed estimators that are not ours: their answers are made whole, and what is no answer ends the flight.

An answer is a whole `Estimate`, or (airspeed, sd, valid), or None. A valid airspeed is a number from 0 on, and so is
its standard deviation; without `valid` both may be NaN. The raw airspeed is never theirs: it is that of the tared
readings, whatever an estimator makes of them.
"""

from math import isfinite, nan
from numbers import Real
from typing import Any, NoReturn

from uavsim.failure import PartError, blamed, shown
from uavsim.onboard.airspeed.paper import PaperFilter
from uavsim.onboard.interface import Estimate, Estimator, Feel, News

SHORT, WHOLE = 3, 9  # values of an answer
BEYOND = 1e9  # of any unit: what a number of an estimate never is
OWN = "airspeed_"  # what an estimator's events begin with


class GuardedEstimator(Estimator):
    """An airspeed estimator of somebody else's, whose answers are made whole.

    Parameters
    ----------
    name : str
        As registered.
    estimator : object
        With `step`, and what it has of the other methods of `Estimator`.
    pressures : PaperFilter
        Reads the same, tares the pair and gives the raw airspeed.
    """

    __slots__ = ("_aided", "_estimator", "_part", "_pressures", "_t", "news")

    def __init__(self, name: str, estimator: Any, pressures: PaperFilter) -> None:
        self._part, self._estimator, self._t = f"estimator {name!r}", estimator, nan
        taken = getattr(type(estimator), "accelerometer", None)
        self._aided = taken is not None and taken is not Estimator.accelerometer
        self._pressures = pressures
        self.news: News = []

    @property
    def aided(self) -> bool:
        """Whether it has an `accelerometer` of its own."""
        return self._aided

    def doubts(self, t: float) -> tuple[str, ...] | None:
        """Say why it is not ready; an estimator without `doubts` is."""
        told = getattr(self._estimator, "doubts", None)
        if told is None:
            return ()
        with blamed(self._part, t):
            reasons = told(t)
        if reasons is None or (isinstance(reasons, tuple) and all(isinstance(reason, str) for reason in reasons)):
            return reasons
        raise PartError(f"{self._part} doubts {shown(reasons)} at {t:.4f} s; it must be None or a tuple of sentences")

    def accelerometer(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take a reading of specific force."""
        self._t = t
        self._tell("accelerometer", t, fx, fy, fz)

    def tidy(self) -> None:
        """Do what can wait."""
        self._tell("tidy")

    def launched(self, t: float) -> None:
        """Be told of a launch."""
        self._tell("launched", t)

    def airborne(self, t: float) -> None:
        """Be told of a flight whose launch nobody has seen."""
        self._tell("airborne", t)

    def rearmed(self, t: float) -> None:
        """Be told that it was none."""
        self._tell("rearmed", t)

    def unfolding(self, t: float) -> None:
        """Be told of the wings."""
        self._tell("unfolding", t)

    def _tell(self, name: str, *values: float) -> None:
        told: Feel | None = getattr(self._estimator, name, None)
        if told is not None:
            with blamed(self._part, self._t):
                told(*values)

    def step(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head; see `Estimator`."""
        self._t = t
        with blamed(self._part, self._t):
            answer = self._estimator.step(t, p_total, p_static, temperature, t_total, t_static)
        self._collect()
        read = self._pressures.step(t, p_total, p_static, temperature, t_total, t_static)
        if answer is None:
            return None
        values = _numbers(answer)
        total, static, nis = p_total - self._pressures.tare()[0], p_static, (nan, nan)
        if len(values) == WHOLE:
            _, speed, sd, _, total, static, valid, *both = values
            nis = both[0], both[1]
        elif len(values) == SHORT:
            speed, sd, valid = values
        else:
            self._refuse(answer, "it must be None, (airspeed, sd, valid) or a whole estimate")
        self._check(answer, speed, sd, valid)
        if any(abs(value) > BEYOND for value in (speed, sd, total, static, *nis)):
            self._refuse(answer, f"no number of it is beyond {BEYOND:g}")
        return t, speed, sd, nan if read is None else read[3], total, static, valid == 1.0, nis[0], nis[1]

    def _collect(self) -> None:
        """Take over its news, and empty them."""
        with blamed(self._part, self._t):
            told = getattr(self._estimator, "news", None)
            if told is None or (isinstance(told, list) and not told):
                return
        try:
            news = [(float(t), event, channel, kind) for t, event, channel, kind in told]
            right = all(isfinite(t) and all(isinstance(word, str) for word in words) for t, *words in news)
            told.clear()
        except (TypeError, ValueError, AttributeError, OverflowError):
            right = False
        if not right or not all(event.startswith(OWN) for _, event, _, _ in news):
            raise PartError(
                f"{self._part} has news {shown(told)} at {self._t:.4f} s; it is a list of (t, event, channel, kind), "
                f"whose events begin with {OWN!r}"
            )
        self.news += news

    def _check(self, answer: Any, speed: float, sd: float, valid: float) -> None:
        if valid not in (0.0, 1.0):
            wrong = "valid must be True or False"
        elif valid and not (speed >= 0.0 and isfinite(speed)):
            wrong = "a valid airspeed is a number from 0 on"
        elif valid and not (sd >= 0.0 and isfinite(sd)):
            wrong = "the standard deviation of a valid airspeed is a number from 0 on"
        elif speed < 0.0 or sd < 0.0:
            wrong = "neither airspeed nor standard deviation is below 0"
        else:
            return
        self._refuse(answer, wrong)

    def _refuse(self, answer: Any, wrong: str) -> NoReturn:
        raise PartError(f"{self._part} answered {shown(answer)} at {self._t:.4f} s; {wrong}")


def _numbers(answer: Any) -> tuple[float, ...]:
    """Return an answer's values; none if it is no row of numbers and flags."""
    if not isinstance(answer, tuple | list):
        return ()
    if not all(isinstance(value, Real) or type(value).__name__ in ("bool", "bool_") for value in answer):
        return ()
    try:
        return tuple(map(float, answer))
    except (TypeError, ValueError, OverflowError):
        return ()
