"""What hardware does to a true quantity: accelerometers and pressure sensors as their datasheets describe them.

Frames and units
    Body axes forward-right-down. SI, radians, kelvin; any other unit is in the name (`range_g`, `waiting_rms_g`).
    Specific force is what an ideal accelerometer feels: (0, 0, -9.80665) m/s² at rest with z down. Readings of an
    accelerometer are in the axes of its case. Pressures are absolute, Pa.

Time
    Every device has its own clock: its k-th sample is at φ + k/f, φ drawn by the seed, f off from its nominal rate by
    the part's error. Times are simulation time, s. The plant steps at its own dt; between two steps the truth is taken
    as linear, and what a sensor gives is the filtered signal at its own instant, or its mean over its window.

Noise
    A "noise density" n is one-sided, the square root of the power spectral density over positive frequencies:
    white noise through an equivalent noise bandwidth ENBW has the standard deviation n √(ENBW), and the Allan
    deviation N/√τ with N = n/√2. A datasheet's figure a conversion is used as such. Bias instability B is that of
    IEEE Std 952, flat at 0.664 B. Drift starts at zero: what a unit is off by when it is switched on is its turn-on
    offset.

Order of errors
    On continuous truth: geometry (mounting, lever arm, port) → pneumatics → vibration → nonlinearity → bandwidth →
    transport delay → sampling at the device's own instant, or the mean over its window.
    On the sample: scale and misalignment → temperature → bias and drift → noise → saturation → quantisation → the
    part's digital filter → time stamp, dropout, stuck value, spike.
    Each term has a factor or a switch in the settings, and a term that is off or new changes no draw of another.

One description, two readers
    `preset("lsm6dso32")` is an `AccelerometerDescription`, `preset("bmp390")` a `PressureDescription`,
    `preset("ms4525do")` a `DifferentialDescription`: frozen numbers of which the simulator draws a unit and a filter
    takes its noise model. Settings (`AccelerometerSettings`, `AirDataSettings`) say what a scenario may choose; their
    `description()` is the part as chosen. What follows from both for the readings, the drawn unit left out, is in
    `sensors.knowledge`.

Randomness
    `Streams(seed, index)` gives each source of noise its own named stream: adding one leaves all others as they were.

What is not a number
    A truth that is NaN gives a reading that is NaN, never an exception; once it is a number again, readings are, too.

Names
    presets, preset, promised · Streams · Accelerometer, Vibration · PressureSensor, AirDataHead, membranes ·
    known_of_accelerometer, known_of_head · record_at_rest, read_bench_log · the settings and descriptions. The package
    imports numpy; pandas and scipy late, and nothing of uavsim.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sensors.accelerometer import Accelerometer
    from sensors.accelerometer_description import AccelerometerDescription, AccelerometerErrors
    from sensors.bench import record_at_rest
    from sensors.bench_log import read_bench_log
    from sensors.catalogue import preset, presets
    from sensors.differential_description import DifferentialDescription
    from sensors.head import AirDataHead, membranes
    from sensors.knowledge import AccelerometerKnowledge, HeadKnowledge, known_of_accelerometer, known_of_head
    from sensors.pressure import PressureSensor
    from sensors.pressure_description import PressureDescription, PressureErrors, PressureMode
    from sensors.promise import promised
    from sensors.settings import (
        AccelerometerSettings,
        AirDataSettings,
        DifferentialSettings,
        PressureSettings,
        VibrationSettings,
    )
    from sensors.streams import Streams
    from sensors.vibration import Vibration

__all__ = [
    "Accelerometer",
    "AccelerometerDescription",
    "AccelerometerErrors",
    "AccelerometerKnowledge",
    "AccelerometerSettings",
    "AirDataHead",
    "AirDataSettings",
    "DifferentialDescription",
    "DifferentialSettings",
    "HeadKnowledge",
    "PressureDescription",
    "PressureErrors",
    "PressureMode",
    "PressureSensor",
    "PressureSettings",
    "Streams",
    "Vibration",
    "VibrationSettings",
    "known_of_accelerometer",
    "known_of_head",
    "membranes",
    "preset",
    "presets",
    "promised",
    "read_bench_log",
    "record_at_rest",
]

_HOME = {
    "Accelerometer": "accelerometer",
    "AccelerometerDescription": "accelerometer_description",
    "AccelerometerErrors": "accelerometer_description",
    "AccelerometerKnowledge": "knowledge",
    "AccelerometerSettings": "settings",
    "AirDataHead": "head",
    "AirDataSettings": "settings",
    "DifferentialDescription": "differential_description",
    "DifferentialSettings": "settings",
    "HeadKnowledge": "knowledge",
    "PressureDescription": "pressure_description",
    "PressureErrors": "pressure_description",
    "PressureMode": "pressure_description",
    "PressureSensor": "pressure",
    "PressureSettings": "settings",
    "Streams": "streams",
    "Vibration": "vibration",
    "VibrationSettings": "settings",
    "known_of_accelerometer": "knowledge",
    "known_of_head": "knowledge",
    "membranes": "head",
    "preset": "catalogue",
    "presets": "catalogue",
    "promised": "promise",
    "read_bench_log": "bench_log",
    "record_at_rest": "bench",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'sensors' has no attribute {name!r}")
    return getattr(import_module(f"sensors.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
