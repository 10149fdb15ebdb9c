"""What onboard code takes and gives: readings, an estimate, commands, a launch detector, an airspeed estimator.

Axes and units
    Body axes forward-right-down, SI, radians, kelvin. A reading of specific force is (t, f_x, f_y, f_z), m/s². It is
    what an accelerometer feels and holds gravity: at rest on a rail of elevation θ it is (g sin θ, 0, -g cos θ). A
    reading of the air-data head is (t, p_total, p_static, temperature, t_total, t_static): absolute pressures, not
    tared, Pa; K; and the ends of the two conversions that it carries, s.

Time
    Times are the device's own stamps, s, whatever their origin. Readings of each sensor come in the order in which they
    arrive, those of both in the order of their stamps, and at one instant specific force comes first.

What may be wrong with readings
    Before a sensor's first conversion its values are NaN. Samples are lost, late, doubled and jittered; a stamp may be
    absurd, and a clock may take a step. A conversion that is polled again has the same end. A value may be NaN,
    infinite or beyond all physics. A part of the aircraft's own meets all of this without raising; of a part of
    somebody else's an exception ends the flight (`uavsim.failure`).

What is asked for
    Scalar steps, memory that does not grow, no wall clock, no randomness, and a state that `reset` or a new object has
    from the start: the same readings give the same answers, bit for bit.
"""

from collections.abc import Callable
from typing import Any, Protocol, cast

Reading = tuple[float, float, float, float]
"""Specific force: t s, f_x, f_y, f_z m/s²."""
AirReading = tuple[float, float, float, float, float, float]
"""Of the head: t s, p_total, p_static Pa, temperature K, t_total, t_static s."""
Estimate = tuple[float, float, float, float, float, float, bool, float, float]
"""t s, airspeed, airspeed_sd, airspeed_raw m/s, p_total (tared), p_static Pa, valid, nis_total, nis_static."""
Commands = tuple[float, float, float, float, float]
"""Wing (0, 1), throttle (0 … 1), pitch, roll (rad), stabiliser engaged (0, 1)."""
Feel = Callable[[float, float, float, float], None]
"""Takes a reading of specific force."""
TareWindow = tuple[float, float]
"""Readings with start < t ≤ end, s, are under the cover."""
News = list[tuple[float, str, str, str]]
"""What an estimator has found of its sensors, to be told and taken out: t s, event, channel, kind of fault."""


class Detector(Protocol):
    """A launch detector.

    It may have the attributes `level`, `count`, `total` (numbers) and `triggered` (whether something speaks for a
    launch); what it has of them is recorded at each sample.
    """

    def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
        """Take one sample; True on the one at which the launch is recognised, then False until `reset`.

        Parameters
        ----------
        t : float
            Time of the sample, s.
        fx, fy, fz : float
            Specific force in body axes, m/s².
        """

    def reset(self) -> None:
        """Forget everything: ready for the first sample, whatever its time."""


class _NoNews:
    """An empty list for each that asks, which an attribute of an object's own takes the place of."""

    def __get__(self, estimator: object, owner: type | None = None) -> News:
        return []


class Estimator:
    """An airspeed estimator; all but `step` may be left as it is here, where it does nothing.

    One is made with its settings, what may be believed of the sensors (`airspeed.NoiseModel`), and when the head is
    under its cover, `TareWindow` or None.
    """

    __slots__ = ()

    news: News = cast(Any, _NoNews())
    """What it has found of its sensors since this was last emptied; an attribute of its own where it has some."""

    def step(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> Estimate | None:
        """Take one reading of the head and say what is known after it; None if it is left out for its stamp."""
        raise NotImplementedError

    @property
    def aided(self) -> bool:
        """Whether it wants the readings of specific force: if it has an `accelerometer` of its own."""
        return type(self).accelerometer is not Estimator.accelerometer

    def accelerometer(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take a reading of specific force.

        It is asked for anew after each estimate, so a property may return what takes readings at present, as long as
        what it returned before a launch was recognised serves afterwards, too.
        """

    def tidy(self) -> None:
        """Do what can wait until the estimate has been told; without it, it is done at the next reading of the head."""

    def launched(self, t: float) -> None:
        """Be told that a launch has been recognised at `t`, s, with the reading of specific force taken last."""

    def airborne(self, t: float) -> None:
        """Be told that the aircraft is in flight at `t`, s, without a launch that was recognised."""

    def doubts(self, t: float) -> tuple[str, ...] | None:
        """Say why it is not ready to be launched at `t`, s, in a sentence each: "total port: no reading comes".

        Nothing, (), is ready; None: it is too early to say. It is asked on the rail, some times a second.
        """
        return ()

    def rested(self, offset: tuple[float, float, float], sd: tuple[float, float, float]) -> None:
        """Be told of the accelerometer's offset as it was found on the rail, m/s², body axes, before `launched`.

        Parameters
        ----------
        offset : (x, y, z)
            What has been taken off the readings.
        sd : (x, y, z)
            How well the rest is known to be 0.
        """

    def rearmed(self, t: float) -> None:
        """Be told that it was none and that the aircraft sits on its rail again."""

    def throttle(self, t: float, value: float) -> None:
        """Be told that the motor is commanded to `value`, 0 … 1, from `t`, s, on."""

    def unfolding(self, t: float) -> None:
        """Be told that the wings have been commanded out at `t`, s: masses that move push the accelerometer about."""
