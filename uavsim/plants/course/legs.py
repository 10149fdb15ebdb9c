"""How fast and where to a point flies through the air: leg after leg.

In the air, which may move at the mean wind, with airspeed V, flight-path angle γ, direction χ, bank μ and normal load n
of a flight that is coordinated (no force to the side),

    V γ' = g (n cos μ - cos γ)          V χ' cos γ = g n sin μ

A leg takes T. Airspeed, climb and bank go from what they were to what it says with e(s) = ½ (1 - cos πs), s = t/T; then
n follows from γ'. A leg that says a load instead lets n go there and back, and γ follows:

    n = n₀ + (n_leg - n₀) ½ (1 - cos 2πs),   n₀ = cos γ/cos μ

So V', γ', μ' and n are continuous from leg to leg, and every force is finite. After the last leg all stays as it is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, pi, radians
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from uavsim.truth import STANDARD_GRAVITY

Array = NDArray[np.float64]

STEEPEST = radians(85.0)  # of the path: at 90° there is no direction χ


@dataclass(frozen=True, slots=True)
class LegSettings:
    """One leg; what it does not say stays as it was.

    Attributes
    ----------
    duration
        s.
    airspeed
        True airspeed at its end, m/s.
    climb_deg
        Flight-path angle at its end, in the air, degrees; positive climbs.
    bank_deg
        At its end, degrees; positive turns right.
    load_g
        Normal load that it reaches in its middle and gives back, standard g; not with `climb_deg`.
    throttle
        At its end, 0 … 1: what a slipstream is made of. It moves nothing.
    """

    duration: Annotated[float, Interval(ge=0.1, le=3600)] = 5.0
    airspeed: Annotated[float, Interval(ge=5, le=250)] | None = None
    climb_deg: Annotated[float, Interval(ge=-80, le=80)] | None = None
    bank_deg: Annotated[float, Interval(ge=-75, le=75)] | None = None
    load_g: Annotated[float, Interval(ge=-3, le=10)] | None = None
    throttle: Annotated[float, Interval(ge=0, le=1)] | None = None


class Flown(NamedTuple):
    """A path through the air, one value a row: V, m/s, γ, χ, μ, rad, and V', γ', χ' by the time; throttle."""

    airspeed: Array
    climb: Array
    direction: Array
    bank: Array
    airspeed_rate: Array
    climb_rate: Array
    direction_rate: Array
    throttle: Array


class Now(NamedTuple):
    """What a leg begins from."""

    airspeed: float
    climb: float
    bank: float
    throttle: float


def check(legs: Sequence[LegSettings]) -> None:
    """Refuse a leg that asks for two paths at once.

    Raises
    ------
    ValueError
        One line that names it.
    """
    for i, leg in enumerate(legs):
        if leg.load_g is not None and leg.climb_deg is not None:
            raise ValueError(
                f"plant.flight_path.legs[{i}]: must have load_g or climb_deg, not both: one follows from the other"
            )


def fly(
    legs: Sequence[LegSettings], begin: Now, direction: float, pushed: tuple[Array, Array], rows: int, rate: float
) -> tuple[Flown, int]:
    """Fly through the air.

    Parameters
    ----------
    legs : sequence of LegSettings
    begin : Now
        At the end of the rail; its airspeed is not read.
    direction : float
        χ there, rad.
    pushed : tuple of ndarray
        V and V' from that row to the one at which the push ends: climb and direction stay. There the first leg begins.
    rows : int
        How many are wanted.
    rate : float
        Rows a second.

    Returns
    -------
    Flown
    int
        How many legs are begun.

    Raises
    ------
    ValueError
        One line that names the leg: its path gets too steep.
    """
    dt = 1.0 / rate
    speed, gain = (values[:-1][:rows] for values in pushed)
    still, on = np.zeros_like(speed), np.ones_like(speed)
    pieces: list[tuple[Array, ...]] = [(speed, gain, begin.climb * on, still, begin.bank * on, begin.throttle * on)]
    done, left, begun, now = speed.size, 0.0, 0, begin._replace(airspeed=float(pushed[0][-1]))
    for leg in legs:
        if done >= rows:
            break
        # a leg begins where the former ended, within a row: `left` is how far the next row is beyond that
        count = min(max(int((leg.duration - left) * rate - 1e-6) + 1, 0), rows - done)
        piece, now = _leg(leg, now, left + np.arange(count) / rate, f"plant.flight_path.legs[{begun}]")
        left += count * dt - leg.duration
        pieces.append(piece)
        done += count
        begun += 1
    if done < rows:
        on = np.ones(rows - done)
        pieces.append((now.airspeed * on, 0.0 * on, now.climb * on, 0.0 * on, now.bank * on, now.throttle * on))
    v, v_rate, climb, climb_rate, bank, throttle = (np.concatenate(part) for part in zip(*pieces, strict=True))
    turn = (v * climb_rate + STANDARD_GRAVITY * np.cos(climb)) * np.tan(bank) / (v * np.cos(climb))
    heading = direction + np.concatenate([[0.0], np.cumsum(0.5 * dt * (turn[1:] + turn[:-1]))])
    return Flown(v, climb, heading, bank, v_rate, climb_rate, turn, throttle), begun


def _leg(leg: LegSettings, now: Now, since: Array, key: str) -> tuple[tuple[Array, ...], Now]:
    """Return a leg's V, V', γ, γ', μ, throttle at times since its start, s, and what it ends with."""
    share = since / leg.duration
    eased, rate = 0.5 * (1.0 - np.cos(pi * share)), 0.5 * pi / leg.duration * np.sin(pi * share)

    def to(wanted: float | None, was: float) -> float:
        return was if wanted is None else wanted

    airspeed, throttle = to(leg.airspeed, now.airspeed), to(leg.throttle, now.throttle)
    bank = now.bank if leg.bank_deg is None else radians(leg.bank_deg)
    v, v_rate = now.airspeed + (airspeed - now.airspeed) * eased, (airspeed - now.airspeed) * rate
    banked = now.bank + (bank - now.bank) * eased
    if leg.load_g is None:
        climb = now.climb if leg.climb_deg is None else radians(leg.climb_deg)
        path, path_rate = now.climb + (climb - now.climb) * eased, (climb - now.climb) * rate
    else:
        path, path_rate, climb = _loaded(leg, leg.load_g, now, (airspeed, bank), since)
    if np.abs(path).max(initial=abs(climb)) > STEEPEST:
        raise ValueError(
            f"{key}: its path gets steeper than {np.degrees(STEEPEST):.0f}°; a load of {to(leg.load_g, 1.0):g} g for "
            f"{leg.duration:g} s turns it by that"
        )
    thrust = now.throttle + (throttle - now.throttle) * eased
    return (v, v_rate, path, path_rate, banked, thrust), Now(airspeed, climb, bank, throttle)


def _loaded(
    leg: LegSettings, load: float, now: Now, ends: tuple[float, float], since: Array
) -> tuple[Array, Array, float]:
    """Return γ and γ' at times since the leg's start, s, and γ at its end, for a load, by the method of Runge-Kutta."""
    airspeed, bank = ends

    def turning(time: float, climb: float) -> float:
        share = min(time / leg.duration, 1.0)
        eased = 0.5 * (1.0 - cos(pi * share))
        v, banked = now.airspeed + (airspeed - now.airspeed) * eased, now.bank + (bank - now.bank) * eased
        more = (load * cos(banked) - cos(climb)) * 0.5 * (1.0 - cos(2.0 * pi * share))
        return STANDARD_GRAVITY * more / v

    reached = float(since[-1])  # where the record ends within the leg, there is no more of it
    end = leg.duration if since.size < 2 or leg.duration - reached < 2.0 * (since[-1] - since[-2]) else reached

    def solved() -> Iterator[tuple[float, float]]:
        time, climb = 0.0, now.climb
        for following in [*since.tolist(), end]:
            step = following - time
            k1 = turning(time, climb)
            k2 = turning(time + 0.5 * step, climb + 0.5 * step * k1)
            k3 = turning(time + 0.5 * step, climb + 0.5 * step * k2)
            k4 = turning(following, climb + step * k3)
            climb += step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            time = following
            yield climb, turning(time, climb)

    rows = np.array(list(solved()))
    return rows[:-1, 0], rows[:-1, 1], float(rows[-1, 0])
