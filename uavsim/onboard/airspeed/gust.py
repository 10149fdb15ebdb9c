"""How fast the gust along the flight path wanders, at a height above the place of launch.

Dryden's longitudinal gust of standard deviation σ and length L is, over less than its correlation time L/V, a random
walk of density 2 σ² V/L. At low altitude (MIL-F-8785C, h in feet)

    σ_u = σ_w/(0.177 + 0.000823 h)^0.4,    L_u = h/(0.177 + 0.000823 h)^1.2,    2 σ_u²/L_u ∝ (0.177 + 0.000823 h)^0.4/h

So the filter believes σ and L at one height, and takes the density to go as the last of these from 10 ft to 1000 ft,
where the law ends, and to stay beyond. (As 1/h alone, from 15 m on, it is 0.7 of that at 170 m and half of it at 400 m:
too little for fast flight, whose readings were then left out.)

In a climb the mean wind changes with the height, too: dW/dh = w/h where it goes with ln h. What is declared of it along
the path makes the airspeed grow by w ḣ/h, with ḣ = V s/g and s = g sin γ. What is not known of w, from which side the
aircraft flies into it and how the wind grows in this place, makes the airspeed wander by a variance of w² |ḣ|/h a
second, which comes to w² while the height doubles about: a density of w² |s|/(g h) beside that of the turbulence; none
in level flight.
"""

from uavsim.onboard.airspeed.settings import AidedSettings

GRAVITY = 9.80665  # m/s², ISO 80000-3

LOWEST_CLIMB = 1.0  # m above the ground, below which no aircraft climbs
LOWEST, HIGHEST = 3.05, 304.8  # m: 10 and 1000 ft, MIL-F-8785C; beyond either the turbulence is as there
GROUND, GROWS = 0.177, 0.0027  # 0.177 + 0.000823 h, h in feet


def gust_density(aided: AidedSettings, height: float) -> float:
    """2 σ²/L, m/s², at a height, m; never less than that of calm air."""
    calm = 2.0 * aided.gust_floor**2 / aided.gust_length
    declared = 2.0 * aided.gust_sd**2 / aided.gust_length
    if aided.gust_height > 0.0:
        declared *= _thinner(height) / _thinner(aided.gust_height)
    return declared if declared > calm else calm


def _thinner(height: float) -> float:
    """(0.177 + 0.0027 h)^0.4/h, h in m: how the density of the turbulence goes with the height."""
    h = LOWEST if height < LOWEST else HIGHEST if height > HIGHEST else height
    falls: float = (GROUND + GROWS * h) ** 0.4 / h
    return falls


def shear_density(aided: AidedSettings, height: float, slope: float) -> float:
    """Density that the mean wind's growth has in a climb of g sin γ = `slope`, m/s², at a height, m; in m/s²."""
    return aided.shear * aided.shear * abs(slope) / (GRAVITY * (height if height > LOWEST else LOWEST))


def growth(aided: AidedSettings, height: float, slope: float) -> float:
    """How fast the airspeed grows in a climb of g sin γ = `slope`, m/s², at a height above the launch, m: V̇/V, 1/s."""
    height += aided.launch_height
    return aided.shear_along * slope / (GRAVITY * (height if height > LOWEST_CLIMB else LOWEST_CLIMB))
