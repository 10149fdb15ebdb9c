"""What a place costs: the airspeed error that its reading makes over an envelope, as it is and calibrated.

With the share c_t of a total place and c_s of a static one (1 and 0 are perfect), the impact pressure read is q_c·(c_t
− c_s); the airspeed follows by the isentropic relation, clipped at 0. A total place is judged with a perfect static one
and the other way round. Calibrated once: c_t/⟨c_t⟩ or (1 − c_s)/(1 − ⟨c_s⟩), with one mean over the envelope, as a K
that a user finds on a calibration flight. Calibrated over angles: less the polynomial in α, β, M that the probe model
has; that takes vanes, or an estimate of the angles, in the air.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uavsim.airdata.constants import EXPONENT, HALF_EXCESS
from uavsim.airdata.surfaces import Polynomial
from uavsim.studies.survey.envelope import Envelope
from uavsim.studies.survey.places import Place, Role

Array = NDArray[np.float64]

EQUAL = 0.02  # m/s; errors calibrated once that differ by less are taken for equal
POWERS = ((0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 0, 2), (2, 0, 0))
"""Of Mach number, alpha, beta: c₀, c_α, c_αα, c_ββ, c_MM, as `sensors.settings.StaticPortSettings` has them."""


@dataclass(frozen=True, slots=True)
class Rank:
    """A place in one role.

    Attributes
    ----------
    place : Place
    role : str
    mean, least, most : float
        Share read, (p − p_s)/q_c, over the envelope.
    raw, constant, angles : float
        Rms airspeed error, m/s: as it is, calibrated once, calibrated over angles.
    worst_phase : float
        Largest rms error of a phase calibrated once, m/s.
    available : float
        Share of the envelope's weight in which the place is in the stream.
    slope : float or None
        Of the share, 1/mm, along the surface, at the envelope's mean.
    """

    place: Place
    role: Role
    mean: float
    least: float
    most: float
    raw: float
    constant: float
    angles: float
    worst_phase: float
    available: float
    slope: float | None

    @property
    def sound(self) -> bool:
        """Whether it is in the stream all the time and nothing that is left out speaks against it."""
        return self.available > 1.0 - 1e-9 and not self.place.caveat


def airspeed_ratio(share: Array, mach: Array) -> Array:
    """Airspeed read over the true one where the share c_t − c_s of q_c is read; 0 where that is below 0."""
    loss = HALF_EXCESS * mach * mach
    impact = np.expm1(np.log1p(loss) / EXPONENT)
    return np.asarray(np.sqrt(np.expm1(EXPONENT * np.log1p(impact * np.maximum(share, 0.0))) / loss))


def rank(place: Place, role: Role, envelope: Envelope) -> Rank | None:
    """Judge a place in a role; None if it is never in the stream."""
    used = envelope.wing_out if place.folds else np.ones(envelope.mach.size, dtype=bool)
    available = float(envelope.weight[used].sum())
    if available == 0.0:
        return None
    at = envelope.alpha[used], envelope.beta[used], envelope.mach[used]
    weight = envelope.weight[used] / available
    share = place.share(*at, envelope.wing_out[used])
    kept = share if role == "total" else 1.0 - share  # of q_c, where the other place is perfect
    fitted = Polynomial.fit(kept, POWERS, alpha=at[0], beta=at[1], mach=at[2], weights=weight)
    speed, mach = envelope.airspeed[used], at[2]

    def rms(left: Array, among: Array) -> float:
        error = speed * (airspeed_ratio(left, mach) - 1.0)
        return float(np.sqrt(np.sum(among * error**2) / np.sum(among)))

    mean = float(np.sum(weight * kept))
    constant = kept / mean if mean > 0.0 else kept
    phases = [weight * (envelope.phase[used] == name) for name in np.unique(envelope.phase[used])]
    return Rank(
        place, role, float(np.sum(weight * share)), float(share.min()), float(share.max()),
        rms(kept, weight), rms(constant, weight), rms(kept - fitted(mach, at[0], at[1]) + 1.0, weight),
        max(rms(constant, phase) for phase in phases), available,
        place.slope(*(float(np.sum(weight * column)) for column in at)),
    )  # fmt: skip


def ranked(candidates: list[Place], role: Role, envelope: Envelope) -> list[Rank]:
    """Judge all places that can serve in a role, the best first."""
    judged = [rank(place, role, envelope) for place in candidates if role in place.roles]
    return sorted((each for each in judged if each is not None), key=lambda each: (each.constant, each.raw))


def choose(ranks: list[Rank], *kinds: str) -> Rank:
    """Name a place of these kinds (of any, if none is given).

    Of the sound ones whose error calibrated once is within `EQUAL` of the least, that with the least error as it is: it
    needs the least calibration. If none is sound, of all.
    """
    among = [each for each in ranks if not kinds or each.place.kind in kinds]
    among = [each for each in among if each.sound] or among
    least = min(each.constant for each in among)
    return min((each for each in among if each.constant <= least + EQUAL), key=lambda each: each.raw)


def pair_error(total: Place, static: Place, envelope: Envelope) -> tuple[float, float]:
    """Rms airspeed error of two places together, m/s: as they are, and calibrated once."""
    used = envelope.wing_out if total.folds or static.folds else np.ones(envelope.mach.size, dtype=bool)
    at = envelope.alpha[used], envelope.beta[used], envelope.mach[used]
    weight = envelope.weight[used] / envelope.weight[used].sum()
    out = envelope.wing_out[used]
    kept = total.share(*at, out) - static.share(*at, out)
    errors = []
    for left in (kept, kept / np.sum(weight * kept)):
        error = envelope.airspeed[used] * (airspeed_ratio(left, at[2]) - 1.0)
        errors.append(float(np.sqrt(np.sum(weight * error**2))))
    return errors[0], errors[1]


def probe_polynomial(place: Place, envelope: Envelope, *, margin: float = np.radians(2.0)) -> tuple[Polynomial, float]:
    """Fit the probe model's polynomial to a static place over the envelope's box of angles and Mach numbers.

    The box reaches `margin`, rad, beyond the envelope and at least to ±5°.

    Returns
    -------
    tuple
        The polynomial, and the largest difference from the flow's share within the box.
    """
    alpha, beta, mach = box(envelope, margin)
    a, b, m = np.meshgrid(alpha, beta, mach, indexing="ij")
    share = place.share(a, b, m)
    fitted = Polynomial.fit(share, POWERS, alpha=a, beta=b, mach=m)
    return fitted, float(np.max(np.abs(fitted(m, a, b) - share)))


def box(envelope: Envelope, margin: float = np.radians(2.0)) -> tuple[Array, Array, Array]:
    """Grid of alpha, beta, rad, and Mach number over an envelope."""
    least = np.radians(5.0)
    axes = []
    for name in ("alpha", "beta"):
        low, high = envelope.range(name)
        axes.append(np.linspace(min(low - margin, -least), max(high + margin, least), 13))
    low, high = envelope.range("mach")
    return axes[0], axes[1], np.linspace(0.0, max(high, 0.1), 4)
