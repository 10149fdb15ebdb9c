"""Every error that the simulator can make is in the knowledge, by its value, or on a list of those that are not.

Authority: sums of the variances of independent errors (GUM 2008, 5.1.2), kinematics, the tables of the presets. A new
key of the settings or of a description that is on neither list fails here; the list says why each of its keys is on it.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, make_dataclass, replace
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest

from sensors import (
    Accelerometer,
    AccelerometerDescription,
    AccelerometerErrors,
    AccelerometerSettings,
    AirDataSettings,
    DifferentialDescription,
    DifferentialSettings,
    PressureDescription,
    PressureMode,
    PressureSettings,
    Streams,
    VibrationSettings,
    known_of_accelerometer,
    known_of_head,
)
from sensors.settings import StaticPortSettings, ThermalSettings, TotalPortSettings, TubeSettings
from sensors.unit import G0

WARMTH = 15.0  # K, of a die about 25 °C
TUBE = TubeSettings(length=0.3)


@dataclass(frozen=True)
class Chosen:
    """What a scenario chooses of its sensors."""

    accelerometer: AccelerometerSettings
    vibration: VibrationSettings
    air_data: AirDataSettings


BASE = Chosen(
    AccelerometerSettings(preset="mpu-6050", filter="184 Hz"),  # its axes differ, and no term of it is 0
    VibrationSettings(),
    AirDataSettings(
        static=PressureSettings(normal=(1.0, 0.0, 1.0)),
        total_port=TotalPortSettings(tube=TUBE),
        static_port=StaticPortSettings(tube=replace(TUBE, direction=(1.0, 0.0, 1.0))),
        acceleration_sensitivity=True,
    ),
)
RELATIVE = replace(BASE.air_data, kind="differential")
THERMAL = replace(RELATIVE, differential=DifferentialSettings(preset="sdp33"))
PART, BAROMETER = BASE.accelerometer.description(), BASE.air_data.total.description()


def known(of: Chosen) -> dict[str, float]:
    """All numbers of the knowledge, by their path."""
    return dict(_numbers(known_of_accelerometer(of.accelerometer, of.vibration), "accelerometer")) | dict(
        _numbers(known_of_head(of.air_data), "head")
    )


def _numbers(value: Any, path: str) -> Iterator[tuple[str, float]]:
    for field in fields(value):
        inner = getattr(value, field.name)
        if is_dataclass(inner):
            yield from _numbers(inner, f"{path}.{field.name}")
        else:
            yield f"{path}.{field.name}", inner


def put(settings: Any, path: str, value: Any) -> Any:
    """Return settings with one of their keys changed."""
    name, _, rest = path.partition(".")
    return replace(settings, **{name: put(getattr(settings, name), rest, value) if rest else value})


def keys(kind: type, path: str) -> Iterator[str]:
    """All keys of settings: those of groups, and of the items of lists of groups."""
    hints = get_type_hints(kind)
    for field in fields(kind):
        hint, inner = hints[field.name], f"{path}.{field.name}"
        item = next((a for a in (hint, *get_args(hint)) if isinstance(a, type) and is_dataclass(a)), None)
        yield from [inner] if item is None else keys(item, inner)


# -- what is named ---------------------------------------------------------------------------------------------------

Before = dict[str, float]
Named = tuple[Any, str, Callable[[Before], float]]
"""A key's value, the number of the knowledge that it changes, and what that becomes."""


def more(name: str, variance: float) -> tuple[str, Callable[[Before], float]]:
    """A standard deviation whose variance grows by so much."""
    return name, lambda before: math.sqrt(before[name] ** 2 + variance)


def times(name: str, factor: float) -> tuple[str, Callable[[Before], float]]:
    return name, lambda before: factor * before[name]


def is_(name: str, value: float) -> tuple[str, Callable[[Before], float]]:
    return name, lambda _: value


OFFSET, SCALE = "accelerometer.offset_sd", "accelerometer.scale_sd"
NOISE, LAG = "accelerometer.noise_sd", "accelerometer.lag"
SHAKING = 0.05 * G0  # m/s², rms in flight
STEP = 16.0 * G0 / 2**15  # m/s²
COLUMN = 101325.0 / (287.05287 * 288.15) * 0.3  # Pa/(m/s²), ρ L
LOW_PASS = 1.0 / (2.0 * math.pi * PART.bandwidth)  # s
POISEUILLE = 128.0 * 1.7894e-5 * 0.3 / (math.pi * 2e-3**4 * 101325.0)  # s/m³, ISO 2533's viscosity at 15 °C
INSIDE = 0.25 * math.pi * 2e-3**2 * 0.3  # m³


def lag_of_tube(volume: float, section: float = 1.0) -> float:
    """Poiseuille's, s, of a cavity and a share of the tube's own section."""
    return POISEUILLE * (volume / 1.4 + 0.5 * INSIDE * section)


def drawn(part: AccelerometerDescription, name: str, factor: float) -> float:
    """By how much the variance of an error of the x axis grows that becomes `factor` times as large."""
    sd = getattr(part, name)
    return (factor**2 - 1.0) * (sd[0] if isinstance(sd, tuple) else sd) ** 2


Z_OVER_X = PART.bias_sd[2] ** 2 - PART.bias_sd[0] ** 2 + (PART.bias_tc_sd[2] ** 2 - PART.bias_tc_sd[0] ** 2) * WARMTH**2

ACCELEROMETER: dict[str, Named] = {
    "preset": ("lsm6dso32", *is_("accelerometer.rate", 833.0)),
    "range_g": (2.0, *more(NOISE, ((2.0 / 16.0) ** 2 - 1.0) * STEP**2 / 12.0)),
    "rate": (500.0, *is_("accelerometer.rate", 500.0)),
    "filter": ("5 Hz", *is_(LAG, 1.0 / (2.0 * math.pi * 5.0))),
    "noise_scale": (3.0, *more(NOISE, 8.0 * PART.noise_sd[0] ** 2)),
    "bias": (2.0, *more(OFFSET, 4.0)),
    "vibration_scale": (2.0, *more(NOISE, 3.0 * SHAKING**2 * 500.0 / 195.0)),
    "errors.bias": (3.0, *more(OFFSET, drawn(PART, "bias_sd", 3.0))),
    "errors.scale": (3.0, *more(SCALE, drawn(PART, "scale_sd", 3.0))),
    "errors.cross_axis": (3.0, *more(OFFSET, drawn(PART, "cross_axis_sd", 3.0) * G0**2)),
    "errors.nonlinearity": (1000.0, *more(OFFSET, drawn(PART, "rectification_sd", 1000.0) * SHAKING**4)),
    "errors.temperature": (3.0, *more(OFFSET, drawn(PART, "bias_tc_sd", 3.0) * WARMTH**2)),
    "errors.drift": (100.0, *more(OFFSET, drawn(PART, "drift_sd", 100.0))),
    "errors.random_walk": (100.0, *more(OFFSET, drawn(PART, "random_walk", 100.0) * 60.0)),
    "errors.bandwidth": (False, *is_(LAG, 0.0)),
    "errors.quantisation": (False, *more(NOISE, -(STEP**2) / 12.0)),
    "errors.saturation": (False, *is_("accelerometer.range", math.inf)),
    "mounting_deg": ((0.0, 90.0, 0.0), *more(OFFSET, Z_OVER_X)),  # nose up: body x is the axis z of the case
    "mounting_error_deg": ((0.0, 5.0, 0.0), *more(OFFSET, (G0 * math.sin(math.radians(5.0))) ** 2)),
    "delay": (0.01, LAG, lambda before: before[LAG] + 0.01),
    "thermal.self_heating": (20.0, *more(OFFSET, PART.bias_tc_sd[0] ** 2 * 400.0)),
}
VIBRATION: dict[str, Named] = {
    "flight_rms_g": (0.1, *more(NOISE, 3.0 * SHAKING**2 * 500.0 / 195.0)),
    "band_hz": ((100.0, 200.0), *more(NOISE, SHAKING**2 * (5.0 - 500.0 / 195.0))),
}


CLIMBING = (BAROMETER.offset_tc_sd * 0.0065 * 3.0) ** 2 * 30.0  # Pa²/s, of a climb of 3 m/s, until 30 s
WARMING = BAROMETER.offset_tc_sd * 20.0 / 30.0 * math.sqrt(30.0)  # Pa/√s, of 20 K that are to come with 30 s


def of_pressure(name: str) -> dict[str, Named]:
    """One of the two sensors."""
    noise, walk, lag, membrane, at_rest = (
        f"head.{name}.{key}" for key in ("noise_sd", "walk", "lag", "membrane_sd", "offset_sd")
    )
    return {
        f"{name}.preset": ("bmp280", *is_(noise, 3.3)),
        f"{name}.mode": ("x16/x2", *is_(f"head.{name}.window", 37.14e-3)),
        f"{name}.iir": (2, lag, lambda before: before[lag] + 1.0 / 200.0),  # weight 1/2: one conversion late
        f"{name}.noise_scale": (3.0, *times(noise, 3.0)),
        f"{name}.errors.quantisation": (False, *is_(noise, 0.0)),
        f"{name}.errors.acceleration": (3.0, *times(membrane, 3.0)),
        f"{name}.errors.drift": (3.0, *is_(walk, math.sqrt(9.0 * 2.0 * 0.6**2 / 100.0 + 0.005**2))),
        f"{name}.errors.random_walk": (3.0, *is_(walk, math.sqrt(2.0 * 0.6**2 / 100.0 + 9.0 * 0.005**2))),
        f"{name}.normal": ((0.6, 0.0, 0.8), *is_(membrane, 0.6 * 0.2)),
        f"{name}.offset_pa": (300.0, *more(at_rest, 300.0**2)),
        f"{name}.errors.offset": (3.0, *more(at_rest, 8.0 * BAROMETER.offset_sd**2)),
        f"{name}.errors.solder": (3.0, *more(at_rest, 8.0 * (80.0 / 3.0) ** 2)),
        f"{name}.errors.scale": (3.0, *more(at_rest, 8.0 * (BAROMETER.scale_sd * 2e4) ** 2)),
        f"{name}.errors.temperature": (3.0, *more("head.walk", 8.0 * CLIMBING)),
        f"{name}.errors.saturation": (False, *is_(f"head.{name}.high", math.inf)),
        f"{name}_port.tube.length": (0.6, *times(f"head.{name}.column", 2.0)),
        f"{name}_port.tube.diameter": (1e-3, *is_(lag, 16.0 * lag_of_tube(5e-8, 0.25))),
        f"{name}_port.tube.volume": (5e-7, *is_(lag, lag_of_tube(5e-7))),
        f"{name}_port.tube.direction": ((3.0, 0.0, 4.0), *is_(f"head.{name}.column", 0.6 * COLUMN)),
    }


AIR: dict[str, Named] = {
    **of_pressure("total"),
    **of_pressure("static"),
    "static.errors.thermometer": (3.0, *more("head.temperature_sd", 8.0 * BAROMETER.temperature_offset_sd**2)),
    "thermometer_recovery": (0.8, *is_("head.thermometer_recovery", 0.8)),
    "calibration": ("none", *is_("head.ports.position_sd", 0.02)),
    "total_port.probe": ("kiel", *is_("head.ports.limit", math.radians(40.0))),
    "total_port.slipstream": (0.3, *is_("head.ports.total_slipstream", 0.3)),
    "static_port.slipstream": (0.2, *is_("head.ports.static_slipstream", 0.2)),
    "static_port.error": (0.03, *is_("head.ports.error", 0.03)),
    "static_port.error_alpha": (0.2, *is_("head.ports.error_alpha", 0.2)),
    "static_port.error_alpha2": (-1.0, *is_("head.ports.alpha2_sd", 0.1)),
    "static_port.error_beta2": (-1.0, *is_("head.ports.error_beta2", -1.0)),
    "static_port.error_mach2": (0.2, *is_("head.ports.error_mach2", 0.2)),
    "pipe": (0.05, *times("head.total.column", 0.05 / 0.3)),
    "acceleration_sensitivity": (False, *is_("head.static.membrane_sd", 0.0)),
    "thermal.self_heating": (5.0, *more("head.temperature_sd", 25.0)),
    "thermal.powered_for": (0.0, *more("head.walk", 2.0 * WARMING**2 * (1.0 - math.exp(-40.0)))),
    "thermal.lag": (10.0, *more("head.walk", 2.0 * WARMING**2 * (3.0 * math.exp(-4.0) - math.exp(-4.0 / 3.0)))),
    "rate": (50.0, *is_("head.rate", 50.0)),
}
OF_DIFFERENCE = "head.scale_sd"
DIFFERENCE: dict[str, Named] = {
    "kind": ("differential", *is_("head.total.noise_sd", 1.5)),
    "differential.preset": ("sdp33", *is_("head.total.noise_sd", 0.2)),
    "differential.mode": ("average", *is_("head.total.noise_sd", 0.12)),
    "differential.noise_scale": (3.0, *times("head.total.noise_sd", 3.0)),
    "differential.errors.quantisation": (False, *is_("head.total.noise_sd", 0.0)),
    "differential.errors.acceleration": (3.0, *times("head.total.membrane_sd", 3.0)),
    "differential.errors.drift": (3.0, *is_("head.total.walk", math.sqrt(9.0 * 2.0 * 0.5**2 / 100.0 + 0.01**2))),
    "differential.errors.random_walk": (30.0, *is_("head.total.walk", math.sqrt(2.0 * 0.5**2 / 100.0 + 0.3**2))),
    "differential.normal": ((0.6, 0.0, 0.8), *is_("head.total.membrane_sd", 0.6 * 0.2)),
    "differential.offset_pa": (300.0, *more("head.difference_sd", 300.0**2)),
    "differential.errors.offset": (3.0, *more("head.difference_sd", 8.0 * 30.0**2)),
    "differential.errors.scale": (3.0, *times(OF_DIFFERENCE, 3.0)),
    "differential.errors.temperature": (3.0, *more("head.difference_sd", 8.0 * (0.5 * WARMTH) ** 2)),
    "differential.errors.saturation": (False, *is_("head.total.high", math.inf)),
}
NAMED = {
    f"{group}.{key}": named
    for group, table in (("accelerometer", ACCELEROMETER), ("vibration", VIBRATION), ("air_data", AIR | DIFFERENCE))
    for key, named in table.items()
}
SHOWS_WITH: dict[str, tuple[str, Any]] = {
    "air_data.thermal.powered_for": ("air_data.thermal.self_heating", 20.0),
    "air_data.thermal.lag": ("air_data.thermal", ThermalSettings(self_heating=20.0, powered_for=20.0)),
    "accelerometer.preset": ("accelerometer.filter", None),
    **{f"air_data.{key}": ("air_data", RELATIVE) for key in DIFFERENCE if key != "kind"},
    "air_data.differential.mode": ("air_data", THERMAL),
    "air_data.differential.errors.quantisation": (
        "air_data",
        replace(RELATIVE, differential=DifferentialSettings(noise_scale=0.0)),
    ),
    **{f"air_data.{n}.errors.quantisation": (f"air_data.{n}.noise_scale", 0.0) for n in ("total", "static")},
}
"""What else is chosen where a key is tried: a part has filters of its own, rounding shows without noise."""

# -- what is not -----------------------------------------------------------------------------------------------------

UNIT = "which unit flies is what the knowledge leaves out"
BREAKS = "what breaks is found in flight, not believed beforehand"
CLOCK = "readings carry their own time stamps"
NOT_YET = {
    "accelerometer.unit": UNIT,
    "accelerometer.errors.clock": CLOCK,
    "accelerometer.errors.drift_model": "one deviation stands for either way to wander",
    "accelerometer.position": "the lever arm's share of the force is not known on board",
    "air_data.position": "how the head moves beside the centre of gravity is not known on board",
    "accelerometer.rate_error_percent": CLOCK,
    "accelerometer.jitter": CLOCK,
    "accelerometer.delay_jitter": "its noise, the force's slope times it, counts in the stroke alone",
    "accelerometer.thermal.lag": "the board's own heat counts as settled",
    "accelerometer.thermal.powered_for": "the board's own heat counts as settled",
    "accelerometer.faults": BREAKS,
    "vibration.waiting_rms_g": "the noise of a reading is that of flight",
    "vibration.stroke_rms_g": "the noise of a reading is that of flight",
    "vibration.ring_hz": "the ring is over when the stroke is",
    "vibration.ring_fraction": "the ring is over when the stroke is",
    "vibration.ring_decay": "the ring is over when the stroke is",
    "vibration.tones": "a tone is no noise of a density",
    "vibration.spectra": "only the flat band is believed yet",
    "air_data.total.errors.thermometer": "the temperature is the static sensor's",
    "air_data.differential.errors.thermometer": "the temperature is the static sensor's",
    "air_data.differential.errors.solder": "no shipped part is said to move by it",
    "air_data.differential.polarity": BREAKS,
    "air_data.port_faults": BREAKS,
    "air_data.swapped_tubes": BREAKS,
    "air_data.cover_left_on": BREAKS,
    "air_data.thermometer_faults": BREAKS,
    "air_data.batch": "parts count as drawn by themselves, the wider of the two",
    "air_data.tare": "when the tare is taken the estimator is told",
    "air_data.tare_duration": "when the tare is taken the estimator is told",
    "air_data.cover_off": "when the tare is taken the estimator is told",
    **{
        f"air_data.{name}{key}": reason
        for name in ("total", "static", "differential")
        for key, reason in {
            ".unit": UNIT,
            ".errors.clock": CLOCK,
            ".errors.drift_model": "one deviation stands for either way to wander",
            ".rate_error_percent": CLOCK,
            ".faults": BREAKS,
        }.items()
    },
    **{
        f"air_data.{name}{key}": reason
        for name in ("total", "static")
        for key, reason in {
            "_port.faults": BREAKS,
        }.items()
    },
}


def on_the_list(key: str) -> bool:
    """Whether a key, or the list that it is a key of, is on the list."""
    return key in NOT_YET or any(key.startswith(f"{listed}.") for listed in NOT_YET)


def forgotten(chosen: type[Any] = Chosen) -> set[str]:
    """Keys that are on neither list."""
    paths = {key.partition(".")[2] for key in keys(chosen, "")}
    return {key for key in paths if key not in NAMED and not on_the_list(key)}


def test_every_key_is_in_the_knowledge_or_on_the_list() -> None:
    """A failure names keys that are new: put them into the knowledge, or on the list with a reason."""
    assert forgotten() == set()


def test_no_key_is_on_both_lists_and_none_is_of_the_past() -> None:
    paths = {key.partition(".")[2] for key in keys(Chosen, "")}
    assert not {key for key in NAMED if on_the_list(key)}
    assert NAMED.keys() <= paths
    assert all(any(path == key or path.startswith(f"{key}.") for path in paths) for key in NOT_YET)


def test_a_new_error_is_not_forgotten() -> None:
    """A field that nobody has put on a list, in the settings and in a group of them, is told by its name."""
    errors = make_dataclass("Errors", [("hysteresis", float, 0.0)], bases=(AccelerometerErrors,), frozen=True)
    part = make_dataclass(
        "Part", [("creep", float, 0.0), ("errors", errors, errors())], bases=(AccelerometerSettings,), frozen=True
    )
    chosen = make_dataclass("Chosen", [("accelerometer", part)], bases=(Chosen,), frozen=True)
    assert forgotten(chosen) == {"accelerometer.creep", "accelerometer.errors.hysteresis"}


@pytest.mark.parametrize("key", NAMED)
def test_each_named_error_changes_the_knowledge_to_its_value(key: str) -> None:
    value, number, expected = NAMED[key]
    base = put(BASE, *SHOWS_WITH[key]) if key in SHOWS_WITH else BASE
    before, after = known(base), known(put(base, key, value))
    assert after[number] != before[number]
    assert after[number] == pytest.approx(expected(before), rel=2e-4, abs=1e-8)


@pytest.mark.parametrize("key", [key for key in NOT_YET if key.startswith("vibration")])
def test_what_is_on_the_list_is_not_in_the_knowledge(key: str) -> None:
    """Else it belongs among the named: numbers are tried, as far as the list's keys are some."""
    old = BASE
    for name in key.split("."):
        old = getattr(old, name)
    if isinstance(old, float):
        assert known(put(BASE, key, 2.0 * old + 0.01)) == known(BASE)


# -- descriptions ----------------------------------------------------------------------------------------------------

SETTING = "what the part is called, and what it can be set to"
LIMIT = "no unit that is sold is beyond it; the deviation is believed"
OF_PART = {
    "bits": ((12,) * 4, *more(NOISE, ((16.0 * G0 / 2**11) ** 2 - STEP**2) / 12.0)),
    "bandwidths": (
        tuple(tuple(0.5 * width for width in row) for row in PART.bandwidths),
        *is_(LAG, 2.0 * LOW_PASS),
    ),
    "poles": (2, *times(LAG, math.sqrt(2.0))),
    "noise_densities": (((0.0, 0.0, 0.0),) * 4, *more(NOISE, -(PART.noise_sd[0] ** 2))),
    "noise_rate_floor": (4000.0, *more(NOISE, 3.0 * PART.noise_sd[0] ** 2)),
    "bias_sd": ((1.0, 2.0, 3.0), *more(OFFSET, 1.0 - PART.bias_sd[0] ** 2)),
    "bias_tc_sd": ((0.1, 0.2, 0.3), *more(OFFSET, (0.1**2 - PART.bias_tc_sd[0] ** 2) * WARMTH**2)),
    "scale_sd": (0.1, *more(SCALE, 0.1**2 - PART.scale_sd**2)),
    "scale_tc_sd": (0.01, *more(SCALE, (0.01**2 - PART.scale_tc_sd**2) * WARMTH**2)),
    "cross_axis_sd": (0.1, *more(OFFSET, (0.1**2 - PART.cross_axis_sd**2) * G0**2)),
    "rectification_sd": (1.0, *more(OFFSET, SHAKING**4)),
    "drift_sd": (1.0, *more(OFFSET, 1.0)),
    "random_walk": (0.1, *more(OFFSET, 0.01 * 60.0)),
    "range_g": (2.0, *more(NOISE, ((2.0 / 16.0) ** 2 - 1.0) * STEP**2 / 12.0)),
    "rate": (500.0, *is_("accelerometer.rate", 500.0)),
    "filter": ("5 Hz", *is_(LAG, 1.0 / (2.0 * math.pi * 5.0))),
}
PART_NOT_YET = {
    **dict.fromkeys(("name", "document", "ranges_g", "rates", "filters"), SETTING),
    **dict.fromkeys((f.name for f in fields(AccelerometerDescription) if f.name.endswith("_limit")), LIMIT),
    "nonlinearity_sd": "its cubic counts at several g alone, in the stroke",
    "correlation_time": "the offset's deviation is believed, not how it wanders",
    "rate_sd": CLOCK,
    "errors": "the factors are in the numbers already",
}
OF_BAROMETER = {
    "mode": (BAROMETER.select(mode="x16/x2").mode, *is_("head.static.window", 37.14e-3)),
    "iir_weights": (((0, 0.5),), "head.static.lag", lambda before: before["head.static.lag"] + 1.0 / 200.0),
    "acceleration_sd": (0.6, *times("head.static.membrane_sd", 3.0)),
    "drift_sd": (1.8, *is_("head.static.walk", math.sqrt(9.0 * 2.0 * 0.6**2 / 100.0 + 0.005**2))),
    "correlation_time": (25.0, *is_("head.static.walk", math.sqrt(2.0 * 0.6**2 / 25.0 + 0.005**2))),
    "random_walk": (0.1, *is_("head.static.walk", math.sqrt(2.0 * 0.6**2 / 100.0 + 0.1**2))),
    "range": ((2e4, 1.1e5), *is_("head.static.low", 2e4)),
    "offset_sd": (100.0, *more("head.static.offset_sd", 100.0**2 - BAROMETER.offset_sd**2)),
    "offset_tc_sd": (1.0, *more("head.static.offset_sd", (1.0 - BAROMETER.offset_tc_sd**2) * WARMTH**2)),
    "solder": ((-60.0, 240.0), *more("head.static.offset_sd", 50.0**2 + 90.0**2 - (80.0 / 3.0) ** 2)),
    "scale_sd": (1e-3, *more("head.static.offset_sd", (1e-6 - BAROMETER.scale_sd**2) * 2e4**2)),
    "temperature_offset_sd": (2.0, *more("head.temperature_sd", 4.0 - BAROMETER.temperature_offset_sd**2)),
    "temperature_resolution": (1.0, *more("head.temperature_sd", 1.0 / 12.0 - 0.005**2)),
    "noise_scale": (3.0, *times("head.static.noise_sd", 3.0)),
}
OF_MODE = {
    "noise_sd": (7.4, *times("head.static.noise_sd", 2.0)),
    "resolution": (37.0, *is_("head.static.noise_sd", 37.0 / math.sqrt(12.0))),
    "temperature_noise_sd": (1.0, *more("head.temperature_sd", 1.0 - 0.005**2)),
    "conversion_time": (2e-3, *is_("head.static.window", 2e-3)),
    "rate": (100.0, "head.static.lag", lambda before: before["head.static.lag"]),
}
OF_FLOW = {
    "calibration_pressure": (90_000.0, *is_("head.difference.calibration_pressure", 90_000.0)),
    "flow": (0.0, *is_(OF_DIFFERENCE, 0.03)),  # what is not known of the tubes' loss
    "flow_pressure": (100.0, *is_("head.difference.flow_pressure", 100.0)),
}
BAROMETER_NOT_YET = {
    **dict.fromkeys(("name", "document", "modes", "iir"), SETTING),
    **dict.fromkeys((f.name for f in fields(PressureDescription) if f.name.endswith("_limit")), LIMIT),
    "reference_pressure": "the scale error counts at a pressure that is usual",
    "rate_sd": CLOCK,
    "errors": "the factors are in the numbers already",
}


@pytest.mark.parametrize(
    ("kind", "named", "listed"),
    [
        (AccelerometerDescription, OF_PART, PART_NOT_YET),
        (PressureDescription, OF_BAROMETER, BAROMETER_NOT_YET),
        (DifferentialDescription, OF_BAROMETER | OF_FLOW, BAROMETER_NOT_YET),
        (PressureMode, OF_MODE, {"name": SETTING}),
    ],
)
def test_every_number_of_a_description_is_in_the_knowledge_or_on_the_list(
    kind: type[Any], named: dict[str, Any], listed: dict[str, str]
) -> None:
    assert {field.name for field in fields(kind)} == named.keys() | listed.keys()
    assert not named.keys() & listed.keys()


@pytest.mark.parametrize("key", OF_PART)
def test_each_number_of_an_accelerometer_changes_the_knowledge(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    value, number, expected = OF_PART[key]
    before = known(BASE)
    monkeypatch.setattr(AccelerometerSettings, "description", lambda _: replace(PART, **{key: value}))
    after = known(BASE)
    assert after[number] != before[number]
    assert after[number] == pytest.approx(expected(before), rel=2e-4)


@pytest.mark.parametrize(("table", "key"), [(t, k) for t in ("", "mode") for k in (OF_MODE if t else OF_BAROMETER)])
def test_each_number_of_a_pressure_sensor_changes_the_knowledge(
    table: str, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    value, number, expected = (OF_MODE if table else OF_BAROMETER)[key]
    slow = key == "rate"  # shows in the lag of a digital filter
    part = BAROMETER.select(iir=2) if slow else BAROMETER
    monkeypatch.setattr(PressureSettings, "description", lambda _: part)
    before = known(BASE)
    changed = replace(part, mode=replace(part.mode, **{key: value})) if table else replace(part, **{key: value})
    monkeypatch.setattr(PressureSettings, "description", lambda _: changed)
    after = known(BASE)
    assert after[number] != before[number]
    longer = 1.0 / 100.0 - 1.0 / 200.0 if slow else 0.0
    assert after[number] == pytest.approx(expected(before) + longer, rel=2e-4)


@pytest.mark.parametrize("key", OF_FLOW)
def test_each_number_of_a_flow_changes_the_knowledge(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    value, number, expected = OF_FLOW[key]
    chosen = replace(BASE, air_data=THERMAL)
    before, part = known(chosen), THERMAL.differential.description()
    monkeypatch.setattr(DifferentialSettings, "description", lambda _: replace(part, **{key: value}))
    after = known(chosen)
    assert after[number] != before[number]
    assert after[number] == pytest.approx(expected(before), rel=2e-4)


def test_noise_is_that_of_the_axis_that_points_ahead() -> None:
    """The ICM-42688-P's z axis, 70 µg/√Hz for 65, in a case that stands on its tail."""
    still = VibrationSettings(flight_rms_g=0.0)
    upright = AccelerometerSettings(preset="icm-42688-p", mounting_deg=(0.0, 90.0, 0.0))
    part = upright.description()
    step = part.resolution / math.sqrt(12.0)
    assert part.noise_sd[2] > part.noise_sd[0]
    assert known_of_accelerometer(upright, still).noise_sd == pytest.approx(math.hypot(part.noise_sd[2], step))


# -- units and readings ----------------------------------------------------------------------------------------------


def test_units_scatter_as_the_knowledge_says() -> None:
    """300 units at 1 g: what f_x and f_z read on the mean, less the truth (χ², 1e-4: within 17 %).

    A mean of 1000 readings has 1 % of their noise left. The die is at 25 °C, and units beyond three deviations are not
    sold, which takes 1.4 % off.
    """
    settings = AccelerometerSettings(preset="mpu-6050")
    off = []
    for seed in range(300):
        unit = Accelerometer.from_settings(settings, Streams(seed))
        off.append(next(unit.at_rest((0.0, 0.0, -G0)))[:, 1:].mean(axis=0) - (0.0, 0.0, -G0))
    expected = known_of_accelerometer(settings, VibrationSettings())
    known_sd = np.array([expected.offset_sd, expected.lift_offset_sd])
    warm = WARMTH * np.array([PART.bias_tc_sd[0], math.hypot(PART.bias_tc_sd[2], PART.scale_tc_sd * G0)])
    assert np.std(off, axis=0)[[0, 2]] == pytest.approx(np.sqrt(known_sd**2 - warm**2), rel=0.17)
