"""From where the air comes past the head, as far as it is known on board, which has no vane.

**Angle of attack.** With the wings out lift is −f_z, and with n the mean of −f_z

    α = a n/(ρ V²) + α₀

a and α₀ are the aircraft's, of a lift curve that is straight, each with what is not known of it. A gust from below
turns the flow and lifts the aircraft; of a course that gusts do not move (`lift_gust_sd`) the lift does not tell it.
Folded wings lift little, and α is small and not known. While they unfold it is anywhere between 0 and what carries the
weight: at 16 m/s from behind fw8 has 11 m/s then and 13°.

**Sideslip.** The rail is left with that of the side wind, β₀. The aircraft then swings into the wind: y = sin β
is counted as a normal number of mean 0 and of the variance y_g², y_g being what turbulence makes, σ/V. So y² has that
for its mean and √2 times it for its standard deviation. To it comes y₀² e^(−2 t/τ), of which two thirds are unsure.
"""

from math import exp, hypot

from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.lift import LASTS
from uavsim.onboard.airspeed.settings import AidedSettings

# s, τ: fw8 swings to a third of the first sideslip in 1.5 s (10 m/s from the side). By hand, of three flights
SWING = 1.5
OVER = 6.0  # τ in which it has died away
FOLDED = 0.0, 0.05  # rad, α and its standard deviation with the wings folded and while they unfold. By hand
STEADY_SD = 0.01  # rad, of β beside turbulence: an aircraft that is not trimmed to the last
LEAST_SPEED = 10.0  # m/s, below which no wing flies
SWUNG = 0.67  # share of the swing's square that is not known: it is anywhere between 0 and twice its mean. By hand
SQUARE = 1.41  # standard deviation of the square of a normal number of mean 0, over its variance
EVEN = 0.29  # standard deviation of what is anywhere within an interval, over its length
USUAL = 0.06  # rad, of α that `bias_sd` covers: that of fw8 at 24 m/s. By hand
# rad, up to which a lift curve is straight, and share of what is beyond by which α may be more: fw8 has 13.8° where the
# line says 10.7. By hand
STRAIGHT, BENT = 0.1, 0.5
STEEPEST = 0.35  # rad, beyond which no wing lifts as the curve says


class FlowAngles:
    """Both angles in flight.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of aircraft and air.

    Attributes
    ----------
    lift : float
        n, m/s², that has been seen last with the wings out; NaN before.
    """

    __slots__ = ("_blown", "_gust", "_left", "_opening", "_side2", "_slope", "_slope_sd", "_zero", "_zero_sd", "lift")

    def __init__(self, aided: AidedSettings) -> None:
        slope, zero = aided.lift_slope, aided.lift_zero
        self._slope, self._zero = 0.0 if slope is None else slope, 0.0 if zero is None else zero
        self._slope_sd, self._zero_sd, self._blown = aided.lift_slope_sd, aided.lift_zero_sd, aided.lift_gust_sd
        self._gust = aided.gust_sd if aided.gust_sd > aided.gust_floor else 0.0
        self.forget()

    def forget(self) -> None:
        """Know nothing of the past."""
        self.lift, self._left, self._side2, self._opening = float("nan"), 0.0, 0.0, False

    def leave(self, t: float, side: float) -> None:
        """Be told that the rail has been left at `t`, s, with a sideslip of this sine."""
        self._left, self._side2 = t, side * side

    def unfold(self, v: float, density: float) -> float:
        """Be told that the wings unfold; return by how much α has to be beyond a usual one, rad (`needed`)."""
        self._opening = True
        return self.needed(v, density)

    def side(self, t: float, v: float) -> tuple[float, float]:
        """Return the mean of y² and its standard deviation at `t`, s, and an airspeed, m/s."""
        y = self._gust / v if v > LEAST_SPEED else self._gust / LEAST_SPEED
        mean = y * y + STEADY_SD * STEADY_SD
        swing = 0.0
        if self._side2 > 0.0:
            since = (t - self._left) / SWING
            if since < OVER:
                swing = self._side2 * exp(-2.0 * since) if since > 0.0 else self._side2
            else:
                self._side2 = 0.0
        return mean + swing, hypot(SQUARE * mean, SWUNG * swing)

    def needed(self, v: float, density: float) -> float:
        """Return by how much the angle of attack that carries the weight is beyond a usual one, rad; 0 if it is not."""
        if not (self._slope > 0.0 and density > 0.0):
            return 0.0
        alpha = self._slope * GRAVITY / (density * (v * v if v > LEAST_SPEED else LEAST_SPEED**2)) + self._zero
        return min(max(0.0, alpha - USUAL), STEEPEST)

    def _unfolding(self, v: float, density: float) -> tuple[float, float]:
        """Return z and its standard deviation while the wings unfold."""
        most = self.needed(v, density)
        if not most > 0.0:
            return FOLDED
        most += USUAL
        return 0.5 * most, hypot(FOLDED[1], EVEN * most)

    def pitching(self, v: float, density: float) -> float:
        """Return what slow flight adds to the variance of V a second, m²/s³: f_x is turned by half of α, or by all.

        b holds it while it lasts, and not while the aircraft pitches up into it and down again as it gains speed.
        """
        doubt = 0.5 * GRAVITY * self.needed(v, density)
        return doubt * doubt * LASTS

    def down(self, v: float, density: float) -> tuple[float, float]:
        """Return z, the sine of α, and its standard deviation at an airspeed, m/s, in air of a density, kg/m³."""
        lift = self.lift
        if not (lift == lift and self._slope > 0.0 and v > LEAST_SPEED):
            return self._unfolding(v, density) if self._opening else FOLDED
        loaded = lift / (density * v * v)
        alpha = self._slope * loaded + self._zero
        if alpha > STEEPEST:
            return STEEPEST, 0.5 * STEEPEST
        if alpha < -STEEPEST:
            return -STEEPEST, 0.5 * STEEPEST
        bent = BENT * (alpha - STRAIGHT) if alpha > STRAIGHT else 0.0
        return alpha, hypot(self._zero_sd, self._slope_sd * loaded, self._blown / v, bent)
