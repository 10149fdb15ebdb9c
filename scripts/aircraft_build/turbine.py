"""Thrust of a small turbojet over Mach number and height, by its cycle.

One shaft at constant speed and turbine inlet temperature, the turbine's nozzle choked, the jet's nozzle expanding to
the air's pressure (Saravanamuttoo, Rogers, Cohen, Gas Turbine Theory, 5th ed., ch. 3 and 8; c_p and γ of cold and
hot gas as there):

    T₂ = T (1 + 0.2 M²),  p₂ = p (1 + η_i 0.2 M²)^3.5
    T₃ = T₂ + ΔT_c,       p₃ = p₂ (1 + η_c ΔT_c/T₂)^3.5        ΔT_c of the design point: it goes with the speed squared
    p₄ = p₃ (1 - 0.05),   T₅ = T₄ - c_pa ΔT_c/(c_pg η_m)       p₅ = p₄ (1 - (T₄ - T₅)/(η_t T₄))^4
    V_j = √(2 η_n c_pg T₅ (1 - (p/p₅)^¼)),  ṁ ~ p₄/√T₄,        F = ṁ (V_j - M a)

The turbine inlet temperature is that at which thrust and mass flow at rest at sea level are those of the geometry.
"""

import math

from .geometry import Geometry

MACHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
HEIGHTS = (-2000.0, 0.0, 2000.0, 5000.0, 10000.0)  # ft of density altitude
FOOT = 0.3048  # m
SEA_LEVEL, SEA_LEVEL_PRESSURE, LAPSE = 288.15, 101325.0, 0.0065  # K, Pa, K/m: ISO 2533
AIR_HEAT, GAS_HEAT = 1005.0, 1148.0  # J/(kg K)
GAS_CONSTANT = 287.05  # J/(kg K)
INTAKE, COMPRESSOR, TURBINE, NOZZLE, SHAFT = 0.95, 0.74, 0.80, 0.95, 0.99  # efficiencies of small radial machines
LOSS = 0.05  # of pressure in the combustor
COLDEST, HOTTEST = 800.0, 1600.0  # K, between which the turbine inlet temperature is looked for


def thrust_ratios(geometry: Geometry) -> list[list[float]]:
    """Thrust at full speed over that at rest at sea level: rows of `MACHS`, columns of `HEIGHTS`."""
    engine = geometry["turbine"]
    hot = _inlet_temperature(engine)
    static = _specific(engine, hot, 0.0, SEA_LEVEL, SEA_LEVEL_PRESSURE)
    return [[_ratio(engine, hot, mach, height) / (static[0] * static[1]) for height in HEIGHTS] for mach in MACHS]


def _ratio(engine: Geometry, hot: float, mach: float, height: float) -> float:
    temperature = SEA_LEVEL - LAPSE * height * FOOT
    pressure = SEA_LEVEL_PRESSURE * (temperature / SEA_LEVEL) ** 5.2559
    flow, jet = _specific(engine, hot, mach, temperature, pressure)
    return flow * (jet - mach * math.sqrt(1.4 * GAS_CONSTANT * temperature))


def _inlet_temperature(engine: Geometry) -> float:
    """T₄, K, at which the jet at rest has the velocity thrust/mass flow, by bisection."""
    wanted, low, high = engine["thrust"] / engine["mass_flow"], COLDEST, HOTTEST
    for _ in range(60):
        middle = (low + high) / 2
        if _specific(engine, middle, 0.0, SEA_LEVEL, SEA_LEVEL_PRESSURE)[1] < wanted:
            low = middle
        else:
            high = middle
    if high > HOTTEST - 1.0 or low < COLDEST + 1.0:
        raise ValueError(f"turbine: no inlet temperature from {COLDEST:g} to {HOTTEST:g} K gives {wanted:.0f} m/s")
    return (low + high) / 2


def _specific(engine: Geometry, hot: float, mach: float, temperature: float, pressure: float) -> tuple[float, float]:
    """Mass flow, up to a constant, and the jet's velocity, m/s."""
    warmer = SEA_LEVEL * (engine["pressure_ratio"] ** (1 / 3.5) - 1.0) / COMPRESSOR  # ΔT_c
    ram = 0.2 * mach * mach
    ahead = temperature * (1.0 + ram)
    compressed = pressure * (1.0 + INTAKE * ram) ** 3.5 * (1.0 + COMPRESSOR * warmer / ahead) ** 3.5
    burnt = compressed * (1.0 - LOSS)
    behind = hot - AIR_HEAT * warmer / (GAS_HEAT * SHAFT)
    expanded = burnt * (1.0 - (hot - behind) / (TURBINE * hot)) ** 4
    if expanded <= pressure:
        return burnt / math.sqrt(hot), 0.0
    jet = math.sqrt(2.0 * NOZZLE * GAS_HEAT * behind * (1.0 - (pressure / expanded) ** 0.25))
    return burnt / math.sqrt(hot), jet
