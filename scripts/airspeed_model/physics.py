"""The aided airspeed filter's model: states, dynamics, process noise, measurements and their derivatives, in symbols.

This is the one place where the model stands. `scripts/derive_airspeed.py` writes the code from it.

States x, with their units:

    v  airspeed along the path                                        m/s
    b  what f_x is off by: the part's bias and the angle of attack     m/s²
    p  static pressure                                                Pa
    s  the climb's share of gravity, g sin γ                          m/s²
    d  difference of the two pressure sensors since their tare        Pa
    k  what is not known of the pressure error per specific force     Pa/(m/s²)

Dynamics (energy-rate relation; no attitude is needed), with f_x the specific force along body x and ρ = p/(R T):

    v̇ = f_x − b − s + gust      ḃ = −b/τ_b + noise      ṗ = −ρ v s + noise
    ṡ = −s/τ_s + noise          ḋ = noise               k̇ = 0

From the first and the third follows v v̇ + g ḣ = v (f_x − b) with ḣ = −ṗ/(ρ g): what the force does to the aircraft's
energy. The slope s is a state in place of ṗ because v̇ would hold ṗ/(ρ v), which is 0/0 at rest.

Measurements: the static pressure p, which a time Δ before the filter's own was higher by ρ v s Δ (`ahead` = ρ v Δ), and
the total pressure by the isentropic relation with γ = 1.4 (Liepmann & Roshko, Elements of Gasdynamics, 1957, 2.24):

    z_s = p + ahead s + noise
    z_t = p [(1 + v²/(7 R T))^(7/2) − r] + d + k · pushed + noise

with `pushed` the specific force less that at rest, m/s², and `heat` = 7 R T, m²/s². r, `relative`, is 0 of an absolute
sensor, which reads the total pressure, and 1 of a differential one, which reads it relative to the static pressure: an
error of p then hardly counts.
"""

import sympy as sp

# The order in which symbols are declared is the order in which factors and terms are printed: it fixes the rounding.
ORDER = sp.symbols(
    "density middle force gained curvature v b p heat power y relative s d pushed k ahead c dt bias slope variance "
    "walk drift bias_time slope_time keep stay speed_sd bias_sd rest_sd static_sd difference_sd acceleration_sd",
    positive=True,
)
(
    density, middle, force, gained, curvature, v, b, p, heat, power, y, relative, s, d, pushed, k, ahead, c, dt, bias,
    slope, variance, walk, drift, bias_time, slope_time, keep, stay, speed_sd, bias_sd, rest_sd, static_sd,
    difference_sd, acceleration_sd,
) = ORDER  # fmt: skip
STATES = (v, b, p, s, d, k)
UNIT = sp.eye(6)

# -- dynamics ----------------------------------------------------------------------------------------------------------

RATES = sp.Matrix([force - b - s, -b / bias_time, -density * v * s, -s / slope_time, 0, 0])
A = RATES.jacobian(STATES)

# One step of length dt: Euler's, but with the integral of the force as it was read (`gained` = ∫ f_x dt) and with the
# airspeed of the middle of the interval in ṗ. F is the Jacobian to first order in dt, at the same middle.
CHANGE = sp.expand(dt * RATES[0]).subs(dt * force, gained)
MIDDLE = v + CHANGE / 2
STEP = sp.Matrix(STATES) + dt * RATES.subs(v, middle)
STEP[0] = v + CHANGE
F = UNIT + dt * A.subs(v, middle)

# On the rail neither the elevation nor the angle of attack changes: b and s stay as they are, τ_b and τ_s are infinite.
DECAY = {keep: F[1, 1], stay: F[3, 3]}

# -- process noise -----------------------------------------------------------------------------------------------------

# Over the interval the noise of b and s reaches v and p: Q = ∫ Φ(t) W Φ(t)ᵀ dt from 0 to dt with Φ(t) = I + A₀ t. In A₀
# only what carries noise on within a step is kept: the decays 1/τ and what the noise of v makes of p, ρ s dt, are of
# higher order. bias, slope, walk and drift are what b, s, p and d gain in variance in dt; `variance` is what gust and
# accelerometer give to v.
_t = sp.Symbol("t", positive=True)
_A0 = A.subs({v: middle, s: 0, 1 / bias_time: 0, 1 / slope_time: 0})
_GAINED = sp.diag(variance, bias, walk, slope, drift, 0)
_PHI = UNIT + _A0 * _t
Q = (_PHI * (_GAINED / dt) * _PHI.T).applyfunc(lambda entry: sp.integrate(sp.expand(entry), (_t, 0, dt)))

# On the rail b and s gain no variance but `RAIL_SHARE` of it, for a regular matrix; what it would make of v and p is
# left out.
Q_RAIL = _GAINED

# -- measurements ------------------------------------------------------------------------------------------------------

Y = 1 + v**2 / heat
STATIC = p + ahead * s
TOTAL = p * (Y ** sp.Rational(7, 2) - relative) + d + pushed * k
H_STATIC = sp.Matrix([STATIC]).jacobian(STATES)
H_TOTAL = sp.Matrix([TOTAL]).jacobian(STATES)
# h'' of the total pressure in v near rest, where its bend counts. The next term, 1 + 5 M²/5 …, is below 1e-2 to Mach
# 0.1.
CURVATURE = H_TOTAL[0] / v
if sp.simplify((sp.diff(TOTAL, v, 2) - CURVATURE).subs(v, 0)) != 0:
    raise ArithmeticError("the curvature is not the second derivative at rest")

# -- start -------------------------------------------------------------------------------------------------------------

# At rest f_x reads r = b + s, known to rest_sd from the tare; b alone is known to bias_sd. So s = r − b.
_AT_REST = UNIT.as_mutable()
_AT_REST[3, 1] = -1
START = (
    _AT_REST
    * sp.diag(speed_sd**2, bias_sd**2, static_sd**2, rest_sd**2, difference_sd**2, acceleration_sd**2)
    * _AT_REST.T
)
