"""Constants of air, each with its unit and source."""

GAMMA = 1.4  # –, ratio of specific heats of air (ISO 2533:1975)
GAS_CONSTANT_DRY_AIR = 287.05287  # J/(kg·K) (ISO 2533:1975)
STANDARD_GRAVITY = 9.80665  # m/s² (ISO 80000-3)
MOLAR_GAS_CONSTANT = 8.314472  # J/(mol·K) (CODATA 2006, as in CIPM-2007)
MOLAR_MASS_DRY_AIR = 28.96546e-3  # kg/mol (CIPM-2007, 400 µmol/mol of CO₂)
MOLAR_MASS_WATER = 18.01528e-3  # kg/mol (CIPM-2007)
ZERO_CELSIUS = 273.15  # K
STANDARD_PRESSURE = 101_325.0  # Pa, p₀ at sea level (ISO 2533:1975)
STANDARD_TEMPERATURE = 288.15  # K, T₀ at sea level (ISO 2533:1975)
STANDARD_LAPSE = -6.5e-3  # K/m of geopotential height, below the tropopause (ISO 2533:1975)
TROPOPAUSE = 11_000.0  # m, geopotential (ISO 2533:1975)
LOWEST_STANDARD_HEIGHT, HIGHEST_STANDARD_HEIGHT = -5_000.0, 20_000.0  # m, geopotential; what `standard` covers

MIN_TEMPERATURE, MAX_TEMPERATURE = 150.0, 400.0  # K; outside is no air that anything here flies in
MACH_ROUNDING = 1e-6  # –; a Mach number this far outside 0…1 is taken for rounding

VAPOUR_DEFICIT = 1.0 - MOLAR_MASS_WATER / MOLAR_MASS_DRY_AIR  # –, 1 − M_v/M_a
EXPONENT = (GAMMA - 1.0) / GAMMA  # –, 2/7
HALF_EXCESS = 0.5 * (GAMMA - 1.0)  # –, 0.2
LIMIT_RATIO = (1.0 + HALF_EXCESS * (1.0 + MACH_ROUNDING) ** 2) ** (1.0 / EXPONENT)  # –, p_t/p_s at Mach 1
