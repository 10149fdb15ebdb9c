"""What autopilots log: which message holds what, in which unit, by which clock.

PX4 logs in SI, temperatures in °C, before 1.14 the barometer's pressure in millibar; ArduPilot angles in degrees, and
before 2015 its time in milliseconds. MAVLink has accelerations in thousandths of g, pressures in hPa.

Source: PX4-Autopilot, msg/*.msg; ArduPilot, libraries/AP_Logger/LogStructure.h and its libraries' LogStructure.h;
MAVLink, message_definitions/v1.0/common.xml.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from uavsim.truth import STANDARD_GRAVITY

Fields = Mapping[str, NDArray[np.generic]]
Choice = tuple[str, float, float, str]
"""A field, its factor and offset to our unit, and what is to be said."""

CELSIUS = 273.15  # K
LEAST_PASCAL = 2000.0  # Pa; what is below is in hPa, for no aircraft flies where 2000 Pa are left
OF_BAROMETER = "brought from °C to K; it is the barometer's own, not that of the air"


@dataclass(frozen=True, slots=True)
class Autopilot:
    """What an autopilot's logs are like.

    Attributes
    ----------
    log : str
        What they are called.
    times : tuple
        Fields that are a message's time, the best first, with their unit in s.
    force : mapping
        Messages that hold the specific force, the best first, with their axes.
    series : mapping
        Messages that hold something else of ours, the best first; of each, the fields that may be it.
    signs : mapping
        Factors of force that is not in m/s².
    own_times : mapping
        Messages whose time is another field.
    again : mapping
        Messages whose other instances are other accelerometers, where the force is from a message without.
    derived : mapping
        Functions that add fields to a message's.
    """

    log: str
    times: tuple[tuple[str, float], ...]
    force: Mapping[str, tuple[str, str, str]]
    series: Mapping[str, Mapping[str, tuple[Choice, ...]]]
    signs: Mapping[str, float] = field(default_factory=dict)
    own_times: Mapping[str, tuple[tuple[str, float], ...]] = field(default_factory=dict)
    again: Mapping[str, str] = field(default_factory=dict)
    derived: Mapping[str, Callable[[Fields], Fields]] = field(default_factory=dict)

    def times_of(self, message: str) -> tuple[tuple[str, float], ...]:
        """Return the fields that may be a message's time, with their unit in s."""
        return self.own_times.get(message, self.times)

    def completed(self, message: str, fields: Fields) -> Fields:
        """Return a message's fields, with what follows from them."""
        derive = self.derived.get(message)
        return fields if derive is None else {**fields, **derive(fields)}


def _plain(name: str, factor: float = 1.0, offset: float = 0.0, said: str = "") -> tuple[Choice, ...]:
    return ((name, factor, offset, said),)


def _all(fields: Fields, names: tuple[str, ...]) -> bool:
    return all(name in fields and fields[name].dtype.kind in "biuf" for name in names)


def _number(values: NDArray[np.generic]) -> NDArray[np.float64]:
    with np.errstate(invalid="ignore"):
        return values.astype(np.float64)


# -- PX4 -------------------------------------------------------------------------------------------------------------


def _angles(fields: Fields) -> Fields:
    """Return Euler angles of a quaternion, from the earth's frame to the body's."""
    names = ("q[0]", "q[1]", "q[2]", "q[3]")
    if not _all(fields, names):
        return {}
    w, x, y, z = (_number(fields[name]) for name in names)
    return {
        "roll": np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        "pitch": np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        "heading": np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    }


def _clips_counted(fields: Fields) -> Fields:
    """Return counts up to each reading of those in each reading."""
    names = [f"clip_counter[{i}]" for i in range(3)]
    return {f"clips[{i}]": np.cumsum(_number(fields[n])) for i, n in enumerate(names) if _all(fields, (n,))}


def _pascal(fields: Fields) -> Fields:
    """Return the pressure of a barometer, which older versions log in millibar."""
    if not _all(fields, ("pressure",)):
        return {}
    pressure = _number(fields["pressure"])
    finite = pressure[np.isfinite(pressure)]
    is_millibar = finite.size > 0 and float(np.median(finite)) < LEAST_PASCAL
    return {"pressure_from_millibar": 100.0 * pressure} if is_millibar else {"pressure_in_pascal": pressure}


PX4 = Autopilot(
    "ULog",
    (("timestamp", 1e-6),),
    {
        "sensor_combined": ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
        "vehicle_acceleration": ("xyz[0]", "xyz[1]", "xyz[2]"),
        "sensor_accel": ("x", "y", "z"),
    },
    {
        "differential_pressure": {
            "p_difference": (
                ("differential_pressure_pa", 1.0, 0.0, ""),
                ("differential_pressure_raw_pa", 1.0, 0.0, ""),
                ("differential_pressure_filtered_pa", 1.0, 0.0, "filtered on board"),
            )
        },
        "vehicle_air_data": {
            "p_static": _plain("baro_pressure_pa"),
            "temperature": (
                ("ambient_temperature", 1.0, CELSIUS, "brought from °C to K"),
                ("baro_temp_celcius", 1.0, CELSIUS, OF_BAROMETER),
            ),
            "baro_height": _plain("baro_alt_meter"),
        },
        "sensor_baro": {
            "p_static": (
                ("pressure_from_millibar", 1.0, 0.0, "brought from millibar to Pa"),
                ("pressure_in_pascal", 1.0, 0.0, ""),
            ),
            "temperature": _plain("temperature", 1.0, CELSIUS, OF_BAROMETER),
        },
        "airspeed_validated": {"airspeed_reference": _plain("true_airspeed_m_s", said="the autopilot's own")},
        "airspeed": {
            "airspeed_reference": _plain("true_airspeed_m_s", said="the autopilot's own"),
            "equivalent_airspeed": _plain("indicated_airspeed_m_s"),
        },
        "vehicle_attitude": {"roll": _plain("roll"), "pitch": _plain("pitch"), "heading": _plain("heading")},
        **{
            message: {
                "north_speed": _plain("vel_n_m_s"),
                "east_speed": _plain("vel_e_m_s"),
                "down_speed": _plain("vel_d_m_s"),
                "satellites": _plain("satellites_used"),
            }
            for message in ("vehicle_gps_position", "sensor_gps")
        },
        "vehicle_imu_status": {f"clips_{axis}": _plain(f"accel_clipping[{i}]") for i, axis in enumerate("xyz")},
        "sensor_accel": {f"clips_{axis}": _plain(f"clips[{i}]") for i, axis in enumerate("xyz")},
    },
    again={"sensor_combined": "sensor_accel"},
    derived={"vehicle_attitude": _angles, "sensor_accel": _clips_counted, "sensor_baro": _pascal},
)


# -- ArduPilot -------------------------------------------------------------------------------------------------------


def _over_ground(fields: Fields) -> Fields:
    """Return the components of a velocity over ground, of speed and course."""
    if not _all(fields, ("Spd", "GCrs")):
        return {}
    speed, course = _number(fields["Spd"]), np.radians(_number(fields["GCrs"]))
    return {"north": speed * np.cos(course), "east": speed * np.sin(course)}


def _mean_force(fields: Fields) -> Fields:
    """Return mean specific force of speed gained in some time."""
    names = ("DelVX", "DelVY", "DelVZ") if "DelVX" in fields else ("DelvX", "DelvY", "DelvZ")
    if not _all(fields, (*names, "DelvT")):
        return {}
    with np.errstate(divide="ignore", invalid="ignore"):
        spans = _number(fields["DelvT"])
        forces = [np.where(spans > 0.0, _number(fields[name]) / spans, np.nan) for name in names]
    return dict(zip(("AccX", "AccY", "AccZ"), forces, strict=True))


_ACC = ("AccX", "AccY", "AccZ")
_DEGREE = float(np.pi / 180.0)

ARDUPILOT = Autopilot(
    "DataFlash log",
    (("TimeUS", 1e-6), ("TimeMS", 1e-3)),
    {"IMU": _ACC, "ACC": _ACC, "ACC1": _ACC, "IMT": _ACC},
    {
        "ARSP": {
            "p_difference": _plain("DiffPress"),
            "equivalent_airspeed": _plain("Airspeed", said="the autopilot's own"),
        },
        "BARO": {
            "p_static": _plain("Press"),
            "temperature": _plain("Temp", 1.0, CELSIUS, OF_BAROMETER),
            "baro_height": _plain("Alt"),
        },
        "ATT": {
            "roll": _plain("Roll", _DEGREE),
            "pitch": _plain("Pitch", _DEGREE),
            "heading": _plain("Yaw", _DEGREE),
        },
        "GPS": {
            "north_speed": _plain("north"),
            "east_speed": _plain("east"),
            "down_speed": _plain("VZ"),
            "ground_speed": _plain("Spd"),
            "satellites": _plain("NSats"),
        },
        "VIBE": {
            f"clips_{axis}": (("Clip", 1.0, 0.0, "it counts all axes"), ("Clip0", 1.0, 0.0, "it counts all axes"))
            for axis in "xyz"
        },
    },
    own_times={"GPS": (("TimeUS", 1e-6), ("T", 1e-3))},  # its TimeMS is that of the week
    derived={"GPS": _over_ground, "IMT": _mean_force},
)


# -- MAVLink ---------------------------------------------------------------------------------------------------------

_XYZ = ("xacc", "yacc", "zacc")
_SPEEDS = {
    "north_speed": _plain("vx", 0.01),
    "east_speed": _plain("vy", 0.01),
    "down_speed": _plain("vz", 0.01),
}
_LOW = "a radio link passes it on at a low rate"

MAVLINK = Autopilot(
    "tlog",
    (("time", 1.0),),
    dict.fromkeys(("RAW_IMU", "SCALED_IMU", "HIGHRES_IMU", "SCALED_IMU2", "SCALED_IMU3"), _XYZ),
    {
        "SCALED_PRESSURE": {
            "p_static": _plain("press_abs", 100.0, 0.0, f"brought from hPa to Pa; {_LOW}"),
            "p_difference": _plain("press_diff", 100.0, 0.0, f"brought from hPa to Pa; {_LOW}"),
            "temperature": _plain("temperature", 0.01, CELSIUS, OF_BAROMETER),
        },
        "HIGHRES_IMU": {
            "p_static": _plain("abs_pressure", 100.0, 0.0, f"brought from hPa to Pa; {_LOW}"),
            "p_difference": _plain("diff_pressure", 100.0, 0.0, f"brought from hPa to Pa; {_LOW}"),
            "temperature": _plain("temperature", 1.0, CELSIUS, OF_BAROMETER),
        },
        "ATTITUDE": {"roll": _plain("roll"), "pitch": _plain("pitch"), "heading": _plain("yaw")},
        "GLOBAL_POSITION_INT": _SPEEDS,
        "GPS_RAW_INT": {"satellites": _plain("satellites_visible")},
        "VFR_HUD": {
            "equivalent_airspeed": _plain("airspeed", said="the autopilot's own"),
            "ground_speed": _plain("groundspeed"),
        },
    },
    signs=dict.fromkeys(("RAW_IMU", "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3"), 1e-3 * STANDARD_GRAVITY),
)
