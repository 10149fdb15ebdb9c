"""The accelerometer's offset, found on the rail and taken off all its readings.

At rest on a rail of elevation θ, with the roll φ, an accelerometer feels

    e = (g sin θ, −g cos θ sin φ, −g cos θ cos φ)

and reads r = e + o. Elevation and offset cannot both be found of r: two readings in the plane, three unknowns. So what
the crew believes of the rail is the authority, with the standard deviation σ_θ (0.5° are 0.085 m/s² of f_x). With the
description's σ_o the offset of each axis is, by the product of the two Gaussian densities,

    o = K (r − e),    K = σ_o²/(σ_o² + σ_e²),    σ² = K σ_e²,    σ_e = (g cos θ σ_θ, g cos θ σ_θ, g sin θ σ_θ)

It is taken off where the readings enter, so that detector, filter and the end of the stroke go by the same.

r is the mean of two blocks of half a second that agree, and in each of which the force stands still. So neither
handling nor a stroke that begins moves the offset. At most four σ_o are taken off: a part that is held upright by hand
would have 10 m/s² otherwise. What is beyond that stays in the standard deviation.

A remainder r − e beyond four standard deviations of what the part's own description and the rail allow is told, and
flown with: the offset is so large, or the rail stands elsewhere.
"""

from math import asin, cos, degrees, hypot, nan, sin, sqrt

from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.plausible import MOST_FORCE

Triple = tuple[float, float, float]

GRAVITY = 9.80665  # m/s², ISO 80000-3
GRAVITY_SD = 0.015  # m/s², of the place: 9.780 at the equator, 9.832 at the poles, less 0.012 at 4000 m
BLOCK = 0.5  # s of a mean: white noise of 1 m/s² at 1 kHz leaves 0.045 m/s². By hand
LONGEST = 0.1  # s without a reading that end a block
FEWEST = 10  # readings of a block; fewer say nothing of its spread
# m/s² rms, up to which an axis stands still, with three times its noise beside it: a motor that runs while waiting
# shakes so, a hand that lifts the aircraft turns it by more. By hand
STILL, NOISY = 2.0, 3.0
# m/s² and standard deviations of a mean, by which two blocks may differ: 0.15 m/s² are a tilt of 0.9°. By hand
AGREE, AGREE_SD = 0.15, 3.0
TOLD = 4.0  # standard deviations beyond which a remainder is told, one in 16 000 of the Gaussian ones
TAKEN = 4.0  # standard deviations of the offset that are taken off at most


def expected(noise: NoiseModel) -> tuple[Triple, Triple] | None:
    """Return what is felt at rest and its standard deviation, m/s²; None where nothing is believed of a rail."""
    if noise.rail_elevation is None:
        return None
    up, level, sd = sin(noise.rail_elevation), cos(noise.rail_elevation), noise.rail_elevation_sd
    sway = GRAVITY * level * sd
    felt = (GRAVITY * up, -GRAVITY * level * sin(noise.rail_roll), -GRAVITY * level * cos(noise.rail_roll))
    return felt, (hypot(sway, GRAVITY_SD * up), sway, hypot(GRAVITY * up * sd, GRAVITY_SD * level))


def known(noise: NoiseModel) -> Triple:
    """Return how well the offsets are known once the rail has been read, m/s²; before, what the description says."""
    of_part = noise.accelerometer_offset_sd, noise.side_offset_sd, noise.lift_offset_sd
    rail = expected(noise)
    if rail is None:
        return of_part
    x, y, z = (
        hypot(sd * felt / hypot(sd, felt), noise.accelerometer_wander_sd) if sd > 0.0 else 0.0
        for sd, felt in zip(of_part, rail[1], strict=True)
    )
    return x, y, z


class RailOffset:
    """Finds the offset while the aircraft waits.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of accelerometer and rail.

    Attributes
    ----------
    offset : (x, y, z)
        What is to be taken off the readings, m/s².
    sd : (x, y, z)
        How well it is known, m/s².
    found : bool
        Whether it has been found.
    odd : tuple of float or None
        A remainder that is beyond what the description allows: of f_x, of f_z, m/s², and by how much the elevation
        would be off, degrees, if it were not the offset. Whoever tells it takes it out.
    """

    __slots__ = (
        "_before", "_count", "_longest", "_most", "_noise", "_rail", "_squares", "_start", "_sums", "_t", "_told",
        "found", "odd", "offset", "sd",
    )  # fmt: skip

    def __init__(self, noise: NoiseModel) -> None:
        self._noise, self._rail = noise, expected(noise)
        self._longest = max(LONGEST, 4.0 / noise.accelerometer_rate)
        self._most = hypot(STILL, NOISY * noise.accelerometer_sd)
        self.offset: Triple = (0.0, 0.0, 0.0)
        self.sd: Triple = (noise.accelerometer_offset_sd, noise.side_offset_sd, noise.lift_offset_sd)
        self.found = self._told = False
        self.odd: Triple | None = None
        self.forget()

    def forget(self) -> None:
        """Begin anew; what has been found stays until it is found again."""
        self._before: tuple[Triple, Triple] | None = None
        self._start = self._t = nan
        self._clear()

    def _clear(self) -> None:
        self._sums, self._squares, self._count = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0

    @property
    def remainder(self) -> Triple | None:
        """What the last block in which the force stood still is off by, m/s², body axes; None without one."""
        if self._before is None or self._rail is None:
            return None
        (x, y, z), (ex, ey, ez) = self._before[0], self._rail[0]
        return x - ex, y - ey, z - ez

    def take_off(self, fx: float, fy: float, fz: float) -> Triple:
        """Return a reading without the offset as it has been found so far."""
        x, y, z = self.offset
        return fx - x, fy - y, fz - z

    def add(self, t: float, fx: float, fy: float, fz: float) -> None:
        """Take a reading as it came, whose time stamp is believed; one that is NaN or implausible ends a block."""
        if self._rail is None:
            return
        plausible = -MOST_FORCE < fx < MOST_FORCE and -MOST_FORCE < fy < MOST_FORCE and -MOST_FORCE < fz < MOST_FORCE
        if not (0.0 < t - self._t <= self._longest and plausible):
            self.forget()
            self._start = self._t = t
            if not plausible:
                return
        self._t = t
        if t - self._start >= BLOCK:
            self._finish()
            self._start = t
            self._clear()
        sums, squares = self._sums, self._squares
        sums[0] += fx
        sums[1] += fy
        sums[2] += fz
        squares[0] += fx * fx
        squares[1] += fy * fy
        squares[2] += fz * fz
        self._count += 1

    def _finish(self) -> None:
        """Judge a block that is over."""
        n, last = self._count, self._before
        self._before = None
        if n < FEWEST:
            return
        x, y, z = (total / n for total in self._sums)
        mean = (x, y, z)
        a, b, c = (sqrt(max(0.0, square / n - m * m)) for square, m in zip(self._squares, mean, strict=True))
        spread = (a, b, c)
        if max(spread) > self._most:
            return
        self._before = mean, spread
        if last is None:
            return
        room = [AGREE + AGREE_SD * sqrt((p * p + q * q) / n) for p, q in zip(spread, last[1], strict=True)]
        if all(abs(m - w) <= most for m, w, most in zip(mean, last[0], room, strict=True)):
            x, y, z = (0.5 * (m + w) for m, w in zip(mean, last[0], strict=True))
            self._find((x, y, z))

    def _find(self, mean: Triple) -> None:
        assert self._rail is not None
        noise, (felt, felt_sd) = self._noise, self._rail
        of_part = noise.accelerometer_offset_sd, noise.side_offset_sd, noise.lift_offset_sd
        left = [m - e for m, e in zip(mean, felt, strict=True)]
        found = [_taken(r, sd, e) for r, sd, e in zip(left, of_part, felt_sd, strict=True)]
        (ox, _), (oy, _), (oz, _) = found
        x, y, z = (hypot(sd, noise.accelerometer_wander_sd) if sd > 0.0 else 0.0 for _, sd in found)
        self.offset, self.sd, self.found = (ox, oy, oz), (x, y, z), True
        own = noise.own_offset_sd, noise.own_side_offset_sd, noise.own_lift_offset_sd
        odd = any(abs(r) > TOLD * hypot(sd, e) for r, sd, e in zip(left, own, felt_sd, strict=True))
        if odd and not self._told:
            assert noise.rail_elevation is not None
            stands = asin(min(1.0, max(-1.0, mean[0] / GRAVITY)))
            self.odd = left[0], left[2], degrees(stands - noise.rail_elevation)
        self._told = odd


def _taken(remainder: float, part: float, rail: float) -> tuple[float, float]:
    """Return what is taken off of a remainder, and the standard deviation that is left, m/s²."""
    if not part > 0.0:
        return 0.0, 0.0
    gain = part * part / (part * part + rail * rail)
    best = gain * remainder
    taken = min(TAKEN * part, max(-TAKEN * part, best))
    return taken, hypot(sqrt(gain) * rail, best - taken)
