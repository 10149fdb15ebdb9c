"""What a pull or a turn makes of f_x: lift takes an angle of attack, and that turns the axis x from the path.

With the lift n = −f_z and m n = ½ρV²S C_Lα (α − α₀), f_x is n α more than the acceleration along the path: n²/V² times
c = 2m/(ρ S C_Lα), some metres, different for each aircraft (Etkin 1972, 5.1). In level flight it is a constant, and b
holds it. What is more than that,

    Δ = c (n² − g²)/V²,

is taken off f_x with a middling c. What is not known of c, and of the axis's direction α₀ (a share of n − g), widens V
as if it lasted for `LASTS`.
"""

from uavsim.onboard.airspeed.gust import GRAVITY

# m, c and its standard deviation: 160 N/m² of wing loading at a lift slope of 5.3, and none to 300 N/m², as in `frozen`
TURN, TURN_SD = 5.0, 5.0
DIRECTION_SD = 0.04  # rad, α₀: 2°, the wing's incidence and zero lift and the accelerometer's mounting. By hand
LASTS = 0.5  # s, that an error of c acts with one sign: the pull of a manoeuvre. By hand
# s over which n − g is averaged; m/s² of it up to which flight is straight: a gust's, and the offset's. By hand
PULLS, STRAIGHT = 0.3, 0.7
# m/s², n − g of a gust, up to which f_x is taken as it is: so leaks are not hidden in gusts. A turn at 34° has it
GUSTY = 2.0
SLOWEST = 10.0  # m/s, below which no wing flies, and lift says nothing of the angle of attack


def pulled(lift: float, speed: float) -> tuple[float, float]:
    """Return Δ, m/s², and what it adds to the variance of V a second, m²/s³; of n, m/s², and V, m/s."""
    change = lift - GRAVITY
    if -GUSTY < change < GUSTY:
        return 0.0, 0.0
    change += -GUSTY if change > 0.0 else GUSTY
    v = speed if speed > SLOWEST else SLOWEST
    more = change * (change + 2.0 * GRAVITY) / (v * v)
    doubt, tilt = TURN_SD * more, DIRECTION_SD * change
    return TURN * more, (doubt * doubt + tilt * tilt) * LASTS


class Pull:
    """A pull or a turn by the mean of n − g, and what it does to V by α₀.

    Attributes
    ----------
    mean : float
        m/s².
    size : float
        Its size beyond `STRAIGHT`, m/s²; 0 in straight flight.
    """

    __slots__ = ("mean", "size")

    def __init__(self) -> None:
        self.mean = self.size = 0.0

    def add(self, lift: float, dt: float) -> float:
        """Take n, m/s², over a time, s; return what α₀ adds to the variance of V meanwhile, m²/s²."""
        self.mean += (lift - GRAVITY - self.mean) * (dt / PULLS if dt < PULLS else 1.0)
        size = (self.mean if self.mean > 0.0 else -self.mean) - STRAIGHT
        self.size = size = size if size > 0.0 else 0.0
        tilt = DIRECTION_SD * size
        return tilt * tilt * LASTS * dt
