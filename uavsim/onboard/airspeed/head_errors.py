"""What the ports of the head read that is not their pressure, as far as a calibration knows it.

With the impact pressure q_c = p_t − p_s, and the components of the air's speed past the head over the airspeed, ahead
x, to the right y and down z (x² + y² + z² = 1; θ = acos x; sin β = y, sin α cos β = z),

    total port     p_s + q_c (1 + e_t η) r(θ)                                    r = 1 − 0.01 ((θ − 10°)/(θ_1 − 10°))²
    static port    p_s + q_c (1 + e_s η) (c₀ + c_α z + c_αα z² + c_ββ y² + c_M M²)

r is 1 up to 10°, and never below 0; θ_1 is the probe's quoted limit of 1 %. e_t and e_s are what the propeller adds at
full throttle, η = 1. The same law stands where the head is simulated (`sensors.probe`): a calibration finds its
numbers. What it does not find is a standard deviation, a share of q_c.
"""

from dataclasses import dataclass
from math import acos, cos, hypot, inf, radians

FREE_ANGLE = radians(10.0)  # up to which a probe loses nothing: NACA TN 2530
FREE = cos(FREE_ANGLE)


@dataclass(frozen=True, slots=True)
class HeadErrors:
    """Both ports' errors as they are known.

    Attributes
    ----------
    limit : float
        θ_1 of the total port, rad; infinite of one that reads p_t at any angle.
    error, error_alpha, error_alpha2, error_beta2, error_mach2 : float
        c₀, c_α, c_αα, c_ββ, c_M of the static port.
    total_slipstream, static_slipstream : float
        e_t and e_s.
    position_sd : float
        Standard deviation of the difference of both ports, a share of q_c: what of c₀ and c_M is not known.
    alpha_sd, alpha2_sd, beta2_sd : float
        The same of c_α, c_αα and c_ββ.
    slipstream_sd : float
        What is not known of e_t and e_s, as a share of them.
    """

    limit: float = inf
    error: float = 0.0
    error_alpha: float = 0.0
    error_alpha2: float = 0.0
    error_beta2: float = 0.0
    error_mach2: float = 0.0
    total_slipstream: float = 0.0
    static_slipstream: float = 0.0
    position_sd: float = 0.0
    alpha_sd: float = 0.0
    alpha2_sd: float = 0.0
    beta2_sd: float = 0.0
    slipstream_sd: float = 0.0

    @property
    def none(self) -> bool:
        """Whether both ports read their own pressures at any angle, and that is known."""
        return self == HeadErrors()

    def recovery(self, ahead: float) -> float:
        """Return r for the air's speed from ahead over the airspeed, x."""
        if ahead >= FREE or self.limit == inf:
            return 1.0
        beyond = acos(max(-1.0, ahead)) - FREE_ANGLE
        share = beyond / (self.limit - FREE_ANGLE)
        return max(0.0, 1.0 - 0.01 * share * share)

    def shares(
        self, ahead: float, side: float, down: float, mach2: float, throttle: float = 0.0
    ) -> tuple[float, float]:
        """Return what both ports read above the static pressure, in shares of q_c: total, static.

        Parameters
        ----------
        ahead, side, down : float
            x, y and z.
        mach2, throttle : float
            M², and η.
        """
        static = self.error + self.error_alpha * down + self.error_alpha2 * down * down
        static += self.error_beta2 * side * side + self.error_mach2 * mach2
        return (
            (1.0 + self.total_slipstream * throttle) * self.recovery(ahead),
            (1.0 + self.static_slipstream * throttle) * static,
        )

    def spread(self, side2: float, side2_sd: float, down: float, down_sd: float, throttle: float = 0.0) -> float:
        """Return the standard deviation of what the pair is off by, a share of q_c.

        Parameters
        ----------
        side2, side2_sd : float
            y² and its standard deviation.
        down, down_sd : float
            z and its standard deviation.
        throttle : float
            η.
        """
        of_down = (self.error_alpha + 2.0 * self.error_alpha2 * down) * down_sd
        bent = 1.4 * self.error_alpha2 * down_sd * down_sd  # a square of a normal number has √2 times its variance
        blown = self.slipstream_sd * throttle * (abs(self.total_slipstream) + abs(self.static_slipstream * self.error))
        return hypot(
            self.position_sd, self.alpha_sd * down, self.alpha2_sd * down * down, self.beta2_sd * side2,
            self.error_beta2 * side2_sd, of_down, bent, blown,
        )  # fmt: skip
