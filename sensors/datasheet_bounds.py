"""What each number of a preset may be: its type, its sign, and the bounds beyond which no sensor of its kind is.

A bound says where a number stops to be one of a part that could fly here, with room around everything that is sold. It
is not a judgement of quality: three times the worst part on the market passes. Here are what a part can be set to, and
the modes of a pressure sensor; the terms of its errors say theirs where they are declared, in the descriptions.
"""

from sensors.accelerometer_description import AccelerometerDescription
from sensors.differential_description import DifferentialDescription
from sensors.pressure_description import PressureDescription
from sensors.rules import Rule, listed, number, text, whole
from sensors.term import rules

NAME, SENTENCE = 100, 2000  # characters of a name, and of where a number was read

NAMES = text(NAME)
RANGE_G = number(0.1, 1e5)  # g: from seismic parts of ±0.5 g to shock accelerometers of ±100 000 g
RATE_HZ = number(0.1, 40_000.0)  # Hz: the fastest parts give 32 000; a tenth of a launch fits between two at 0.1 Hz
DENSITY = listed(number(0.0, 1e6), count=3)  # µg/√Hz: 1 g/√Hz; the coarsest part of ±400 g has 15 000

ACCELEROMETER: dict[str, Rule] = {
    "ranges_g": listed(RANGE_G, rising=True),
    "default_range_g": RANGE_G,
    "rates": listed(RATE_HZ, rising=True),
    "default_rate": RATE_HZ,
    "bits": listed(whole(2, 32)),  # a sign and a digit; no converter has more than 32
    "filters": listed(NAMES),
    "default_filter": NAMES,
    "bandwidth_hz": listed(listed(number(0.0, 20_000.0))),  # Hz: half of the highest rate; 0 is no such setting
    "poles": whole(0, 2),  # 0 is the mean over one output interval
    "noise_density_ug": listed(DENSITY),
    **rules(AccelerometerDescription),
}

PRESSURE_PA = number(0.0, 1e7)  # Pa: a vacuum to 100 bar, of which barometers use the first 1.3

PRESSURE: dict[str, Rule] = {
    "default_mode": NAMES,
    "range_pa": listed(PRESSURE_PA, count=2, rising=True),
    "iir_coefficients": listed(whole(0, 10**6), rising=True),
    "iir_weights": listed(number(1e-4, 1.0, above=0.0)),  # 1e-4 takes 10 000 readings to follow; parts have 1/128
    "reference_pressure_pa": PRESSURE_PA,
    **rules(PressureDescription),
}

DIFFERENCE_PA = number(-1e6, 1e6)  # Pa: 10 bar, fifty times what Mach 1 gives at sea level

DIFFERENTIAL: dict[str, Rule] = {
    "default_mode": NAMES,
    "range_pa": listed(DIFFERENCE_PA, count=2, rising=True),
    **rules(DifferentialDescription),
}

MODE: dict[str, Rule] = {
    "name": NAMES,
    "noise_pa": number(0.0, 1e4),  # Pa: a tenth of the atmosphere, 130 m/s of airspeed; parts have below 100
    "resolution_pa": number(1e-6, 1e4),  # Pa: 43 bits of the largest range, to ten steps up to the ground's pressure
    "temperature_noise_k": number(0.0, 10.0),  # K: parts have below 0.1
    "conversion_ms": number(1e-2, 1e4),  # ms: the fastest converters take 0.1 ms; at 10 s a flight is half over
    "rate": number(0.1, 10_000.0),  # Hz: the fastest barometer gives 1800; below 0.1 a flight has three readings
}
