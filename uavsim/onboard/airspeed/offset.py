"""What f_x is off by: the accelerometer's offset, and in flight the angle of attack, as one process.

The offset is a constant of standard deviation σ_o. What the angle of attack makes of f_x wanders, with the standard
deviation σ_a and the correlation time τ_a. The filter has one state b for the sum. A Gauss-Markov process of the
variance and of the short-time density 2σ_a²/τ_a that the sum has, has the correlation time

    τ = τ_a (σ_a² + σ_o²)/σ_a²

so a large offset is remembered for long, as a constant is, and without an offset nothing changes.
"""

from dataclasses import replace
from math import hypot

from uavsim.onboard.airspeed.settings import AidedSettings


def with_offset(aided: AidedSettings, offset_sd: float) -> AidedSettings:
    """Return settings whose `bias_sd` and `bias_time` hold for the sum with an offset of this deviation, m/s²."""
    sd = hypot(aided.bias_sd, offset_sd)
    return replace(aided, bias_sd=sd, bias_time=aided.bias_time * (sd / aided.bias_sd) ** 2)
