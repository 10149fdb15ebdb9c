"""What autopilots' logs mean without a map: made from the message definitions of five versions of each.

Definitions: PX4-Autopilot msg/*.msg at 1.8, 1.10, 1.12, 1.13 and 1.15; ArduPilot LogStructure.h of 2014, 2015 (3.3),
2018 (4.0), 2021 (4.1) and 2024 (4.5). MAVLink is written and read by pymavlink beside ours.
"""

import struct
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from sensors.files import look
from uavsim.logs import Recording, read_log
from uavsim.logs.dataflash import LETTERS, OVER
from uavsim.logs.mavlink_names import NAMES, name_of
from uavsim.logs.tlog import read_tlog

Row = Mapping[str, float]
RATE, END, ONSET = 50.0, 3.0, 1.0
TIMES = np.arange(round(RATE * END)) / RATE + 12.0  # s since boot
TRUE = {
    "p_difference": 120.0,
    "p_static": 97_650.0,
    "temperature": 293.15,
    "baro_height": 301.5,
    "roll": 0.2,
    "pitch": 0.1,
    "heading": 1.5,
    "north_speed": 3.0,
    "east_speed": -4.0,
    "down_speed": 0.5,
    "satellites": 11.0,
}


def force(t: float) -> tuple[float, float, float]:
    return (60.0 if ONSET <= t - 12.0 < ONSET + 0.3 else 1.5), 0.25, -9.75


def assert_as_it_was(recording: Recording, names: set[str], tolerance: float = 1e-5) -> None:
    assert recording.readings[:, 0] == pytest.approx(TIMES, abs=2e-3)
    assert recording.readings[:, 1:] == pytest.approx(np.array([force(t) for t in TIMES]), rel=tolerance, abs=6e-3)
    assert names <= set(recording.series)
    for name in names & set(TRUE):
        series = recording.series[name]
        assert series.values == pytest.approx(TRUE[name], rel=tolerance, abs=2e-3), name
        assert series.t[0] == pytest.approx(12.0, abs=0.05)


# -- PX4 -------------------------------------------------------------------------------------------------------------

CODES = {"uint64_t": "Q", "uint32_t": "I", "float": "f", "uint8_t": "B", "int32_t": "i", "bool": "?"}
COMBINED = (
    "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
    "float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;"
)
OLD_PRESSURE = (
    "uint64_t timestamp;uint64_t error_count;float differential_pressure_raw_pa;"
    "float differential_pressure_filtered_pa;float temperature;uint32_t device_id;uint8_t[4] _padding0;"
)
NEW_PRESSURE = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float differential_pressure_pa;float temperature;"
    "uint32_t error_count;"
)
MILLIBAR = "uint64_t timestamp;uint64_t error_count;uint32_t device_id;float pressure;float temperature;"
PASCAL = "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float pressure;float temperature;"
AIR = "uint64_t timestamp;float baro_alt_meter;float baro_temp_celcius;float baro_pressure_pa;float rho;"
AMBIENT = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t baro_device_id;float baro_alt_meter;float baro_pressure_pa;"
    "float ambient_temperature;uint8_t temperature_source;float rho;"
)
ATTITUDE = "uint64_t timestamp;float[4] q;float[4] delta_q_reset;uint8_t quat_reset_counter;"
GPS = "uint64_t timestamp;float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t satellites_used;"
CLIPS = "uint64_t timestamp;uint32_t accel_device_id;uint32_t[3] accel_clipping;"
ACCEL = (
    "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;uint8_t[3] clip_counter;"
)
COMMON = {"vehicle_attitude": ATTITUDE}
PX4_VERSIONS = {
    "1.8": {"sensor_combined": COMBINED, "differential_pressure": OLD_PRESSURE, "sensor_baro": MILLIBAR,
            "vehicle_gps_position": GPS, **COMMON},
    "1.10": {"sensor_combined": COMBINED, "differential_pressure": OLD_PRESSURE, "vehicle_air_data": AIR,
             "vehicle_gps_position": GPS, **COMMON},
    "1.12": {"sensor_combined": COMBINED, "differential_pressure": OLD_PRESSURE, "vehicle_air_data": AIR,
             "sensor_baro": MILLIBAR, "vehicle_gps_position": GPS, "vehicle_imu_status": CLIPS, **COMMON},
    "1.13": {"sensor_accel": ACCEL, "differential_pressure": NEW_PRESSURE, "sensor_baro": MILLIBAR,
             "sensor_gps": GPS, **COMMON},
    "1.15": {"sensor_combined": COMBINED, "differential_pressure": NEW_PRESSURE, "vehicle_air_data": AMBIENT,
             "sensor_baro": PASCAL, "sensor_gps": GPS, "vehicle_imu_status": CLIPS, **COMMON},
}  # fmt: skip


def quaternion(roll: float, pitch: float, heading: float) -> tuple[float, ...]:
    cr, sr, cp, sp, ch, sh = (f(0.5 * a) for a in (roll, pitch, heading) for f in (np.cos, np.sin))
    return (
        cr * cp * ch + sr * sp * sh,
        sr * cp * ch - cr * sp * sh,
        cr * sp * ch + sr * cp * sh,
        cr * cp * sh - sr * sp * ch,
    )


def px4_values(t: float, format_: str) -> dict[str, object]:
    f = force(t)
    return {
        "timestamp": round(t * 1e6),
        "accelerometer_m_s2": f,
        **dict(zip("xyz", f, strict=True)),
        "differential_pressure_raw_pa": TRUE["p_difference"],
        "differential_pressure_filtered_pa": -1.0,
        "differential_pressure_pa": TRUE["p_difference"],
        "pressure": TRUE["p_static"] * (0.01 if format_ == MILLIBAR else 1.0),
        "temperature": TRUE["temperature"] - 273.15,
        "baro_alt_meter": TRUE["baro_height"],
        "baro_temp_celcius": TRUE["temperature"] - 273.15,
        "ambient_temperature": TRUE["temperature"] - 273.15,
        "baro_pressure_pa": TRUE["p_static"],
        "q": quaternion(TRUE["roll"], TRUE["pitch"], TRUE["heading"]),
        "vel_n_m_s": TRUE["north_speed"],
        "vel_e_m_s": TRUE["east_speed"],
        "vel_d_m_s": TRUE["down_speed"],
        "satellites_used": 11,
        "accel_clipping": (0, 0, 0),
    }


def px4_log(messages: Mapping[str, str]) -> bytes:
    def packed(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    log += b"".join(packed(b"F", f"{name}:{text}".encode()) for name, text in messages.items())
    log += b"".join(packed(b"A", struct.pack("<BH", 0, i) + name.encode()) for i, name in enumerate(messages))
    for t in TIMES:
        for i, text in enumerate(messages.values()):
            values = px4_values(t, text)
            body = struct.pack("<H", i)
            for field in text.rstrip(";").split(";"):
                kind, name = field.split(" ")
                count = int(kind.partition("[")[2].rstrip("]") or 1)
                value = values.get(name, 0)
                each = value if isinstance(value, tuple) else (value,) * count
                body += struct.pack(f"<{count}{CODES[kind.partition('[')[0]]}", *each)
            log += packed(b"D", body)
    return log


@pytest.mark.parametrize("version", PX4_VERSIONS)
def test_px4(tmp_path: Path, version: str) -> None:
    path = tmp_path / "log.ulg"
    path.write_bytes(px4_log(PX4_VERSIONS[version]))
    recording = read_log([path])
    held = {"p_difference", "p_static", "temperature", "roll", "pitch", "heading", "north_speed", "east_speed"}
    assert_as_it_was(recording, held | {"down_speed", "satellites"})
    assert ("clips_x" in recording.series) == (version in ("1.12", "1.13", "1.15"))
    assert any("°C to K" in said for said in recording.remarks)


def test_a_map_may_take_one_thing_and_leave_the_others(tmp_path: Path) -> None:
    path = tmp_path / "log.ulg"
    path.write_bytes(px4_log(PX4_VERSIONS["1.12"]))
    recording = read_log([path], "p_difference=differential_pressure.differential_pressure_filtered_pa*-2")
    assert recording.series["p_difference"].values == pytest.approx(2.0)
    assert recording.series["p_static"].values == pytest.approx(TRUE["p_static"])


# -- ArduPilot -------------------------------------------------------------------------------------------------------

NEW_IMU = ("QBffffffIIfBBHH", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz")
NEW_GPS = ("QBBIHBcLLeffffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U")
ARDUPILOT_VERSIONS = {
    "2014": {
        "IMU": ("Iffffff", "TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"),
        "BARO": ("Iffcf", "TimeMS,Alt,Press,Temp,CRt"),
        "ARSP": ("Iffcff", "TimeMS,Airspeed,DiffPress,Temp,RawPress,Offset"),
        "ATT": ("IccccCC", "TimeMS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw"),
        "GPS": ("BIHBcLLeeEefI", "Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T"),
    },
    "2015": {
        "IMU": ("QffffffIIfBB", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,ErrG,ErrA,Temp,GyHlt,AcHlt"),
        "BARO": ("Qffcf", "TimeUS,Alt,Press,Temp,CRt"),
        "ARSP": ("Qffcff", "TimeUS,Airspeed,DiffPress,Temp,RawPress,Offset"),
        "ATT": ("QccccCCCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw"),
        "GPS": ("QBIHBcLLeeEefB", "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,RAlt,Alt,Spd,GCrs,VZ,U"),
        "VIBE": ("QfffIII", "TimeUS,VibeX,VibeY,VibeZ,Clip0,Clip1,Clip2"),
    },
    "2018": {
        "IMU": ("QffffffIIfBBHH", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz"),
        "BARO": ("QffcfIff", "TimeUS,Alt,Press,Temp,CRt,SMS,Offset,GndTemp"),
        "ARSP": ("QffcffBBfB", "TimeUS,Airspeed,DiffPress,Temp,RawPress,Offset,U,H,Hfp,Pri"),
        "ATT": ("QccccCCCCB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF"),
        "GPS": ("QBIHBcLLefffB", "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,U"),
        "VIBE": ("QfffIII", "TimeUS,VibeX,VibeY,VibeZ,Clip0,Clip1,Clip2"),
    },
    "2021": {
        "IMU": NEW_IMU,
        "BARO": ("QBffcfIffB", "TimeUS,I,Alt,Press,Temp,CRt,SMS,Offset,GndTemp,Health"),
        "ARSP": ("QBffcffBBfB", "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset,U,H,Hfp,Pri"),
        "ATT": ("QccccCCCCB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF"),
        "GPS": NEW_GPS,
        "VIBE": ("QBfffI", "TimeUS,IMU,VibeX,VibeY,VibeZ,Clip"),
    },
    "2024": {
        "IMT": ("QBfffffffff", "TimeUS,I,DelT,DelvT,DelaT,DelAX,DelAY,DelAZ,DelVX,DelVY,DelVZ"),
        "BARO": ("QBfffcfIffB", "TimeUS,I,Alt,AltAMSL,Press,Temp,CRt,SMS,Offset,GndTemp,H"),
        "ARSP": ("QBffcffBBffB", "TimeUS,I,Airspeed,DiffPress,Temp,RawPress,Offset,U,H,Hp,TR,Pri"),
        "ATT": ("QffffffB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,AEKF"),
        "GPS": NEW_GPS,
        "VIBE": ("QBfffI", "TimeUS,IMU,VibeX,VibeY,VibeZ,Clip"),
    },
}
INTERVAL = 1.0 / 400.0  # s, over which IMT sums


def ardupilot_values(t: float) -> dict[str, float]:
    f = force(t)
    return {
        "TimeUS": round(t * 1e6),
        "TimeMS": round(t * 1e3),
        "T": round(t * 1e3),
        **dict(zip(("AccX", "AccY", "AccZ"), f, strict=True)),
        **{f"DelV{axis}": INTERVAL * value for axis, value in zip("XYZ", f, strict=True)},
        "DelvT": INTERVAL,
        "Press": TRUE["p_static"],
        "Temp": TRUE["temperature"] - 273.15,
        "Alt": TRUE["baro_height"],
        "DiffPress": TRUE["p_difference"],
        "Airspeed": 14.0,
        "Roll": np.degrees(TRUE["roll"]),
        "Pitch": np.degrees(TRUE["pitch"]),
        "Yaw": np.degrees(TRUE["heading"]),
        "Spd": 5.0,
        "GCrs": np.degrees(np.arctan2(TRUE["east_speed"], TRUE["north_speed"])) % 360.0,
        "VZ": TRUE["down_speed"],
        "NSats": 11,
    }


def ardupilot_log(messages: Mapping[str, tuple[str, str]]) -> bytes:
    log = b""
    for number, (name, (letters, columns)) in enumerate(
        {"FMT": ("BBnNZ", "Type,Length,Name,Format,Columns"), **messages}.items()
    ):
        kind = 0x80 if name == "FMT" else 0x90 + number
        size = np.dtype([(str(i), LETTERS[letter]) for i, letter in enumerate(letters)]).itemsize + 3
        texts = [text.encode().ljust(long, b"\0") for text, long in ((name, 4), (letters, 16), (columns, 64))]
        log += b"\xa3\x95\x80" + struct.pack("<BB", kind, size) + b"".join(texts)
    for t in TIMES:
        values = ardupilot_values(t)
        for number, (name, (letters, columns)) in enumerate(messages.items(), 1):
            layout = np.dtype([(str(i), LETTERS[letter]) for i, letter in enumerate(letters)])
            row = np.zeros(1, layout)
            for i, (letter, column) in enumerate(zip(letters, columns.split(","), strict=True)):
                value = 0.0 if name == "GPS" and column == "TimeMS" else values.get(column, 0.0)
                row[str(i)] = np.round(value * OVER[letter]) if letter in OVER else value
            log += bytes((0xA3, 0x95, 0x90 + number)) + row.tobytes()
    return log


@pytest.mark.parametrize("version", ARDUPILOT_VERSIONS)
def test_ardupilot(tmp_path: Path, version: str) -> None:
    path = tmp_path / "log.bin"
    path.write_bytes(ardupilot_log(ARDUPILOT_VERSIONS[version]))
    recording = read_log([path])
    assert any(said.endswith("it is the barometer's own, not that of the air") for said in recording.remarks)
    assert_as_it_was(recording, set(TRUE), tolerance=1e-3)  # angles and temperatures in hundredths
    assert recording.series["equivalent_airspeed"].values == pytest.approx(14.0)
    assert ("clips_x" in recording.series) == (version != "2014")


# -- MAVLink ---------------------------------------------------------------------------------------------------------


def telemetry(mavlink2: bool) -> tuple[bytes, Callable[[str], list[dict[str, object]]]]:
    """Write a telemetry log by pymavlink, and return what was written by message."""
    if mavlink2:
        dialect = pytest.importorskip("pymavlink.dialects.v20.common")
    else:
        dialect = pytest.importorskip("pymavlink.dialects.v10.common")
    link = dialect.MAVLink(None, srcSystem=1)
    ground = dialect.MAVLink(None, srcSystem=255)
    log, kept = b"", []
    for k, t in enumerate(TIMES):
        f = [round(1000.0 * value / 9.80665) for value in force(t)]
        messages = [
            dialect.MAVLink_raw_imu_message(round(t * 1e6), *f, 0, 0, 0, 0, 0, 0),
            dialect.MAVLink_scaled_pressure_message(round(t * 1e3), 0.01 * TRUE["p_static"], 1.2, 2000),
            dialect.MAVLink_attitude_message(round(t * 1e3), TRUE["roll"], TRUE["pitch"], TRUE["heading"], 0, 0, 0),
            dialect.MAVLink_global_position_int_message(round(t * 1e3), 0, 0, 0, 0, 300, -400, 50, 0),
            dialect.MAVLink_vfr_hud_message(14.0, 5.0, 10, 50, 301.5, 0.0),
            dialect.MAVLink_sys_status_message(*(0,) * 13),
        ]
        if k % 10 == 0:
            other = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3)
            log += struct.pack(">Q", 1_700_000_000_000_000 + round(t * 1e6)) + other.pack(ground)
        for message in messages:
            log += struct.pack(">Q", 1_700_000_000_000_000 + round(t * 1e6)) + message.pack(link)
            kept.append(message.to_dict())
    return log, lambda name: [message for message in kept if message["mavpackettype"] == name]


@pytest.mark.parametrize("mavlink2", [False, True])
def test_a_telemetry_log_is_read_as_pymavlink_wrote_it(tmp_path: Path, mavlink2: bool) -> None:
    log, written = telemetry(mavlink2)
    for name in ("RAW_IMU", "SCALED_PRESSURE", "ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD"):
        table = read_tlog(log, {name}).tables[name, 0]
        for field in set(table) - {"time", "received"}:
            theirs = [message[field] for message in written(name)]
            assert table[field].tolist() == pytest.approx(theirs, rel=1e-6), (name, field)
    path = tmp_path / "flight.tlog"
    path.write_bytes(log)
    assert look(path).size == len(log)
    recording = read_log([path])
    held = {"p_static", "temperature", "roll", "pitch", "heading", "north_speed", "east_speed", "down_speed"}
    assert_as_it_was(recording, held, tolerance=1e-2)
    assert recording.series["p_difference"].values == pytest.approx(120.0)
    assert recording.series["equivalent_airspeed"].t[0] == pytest.approx(12.0, abs=0.05)
    assert any("low rate" in said for said in recording.remarks)


@pytest.mark.parametrize("seed", range(8))
def test_a_damaged_telemetry_log_is_read_as_far_as_it_can_be(tmp_path: Path, seed: int) -> None:
    log, _ = telemetry(mavlink2=bool(seed % 2))
    noise = np.random.default_rng(seed)
    damaged = bytearray(log)
    for place in noise.integers(600, len(log), 5):
        damaged[place : place + int(noise.integers(1, 60))] = noise.bytes(int(noise.integers(0, 40)))
    path = tmp_path / "flight.tlog"
    path.write_bytes(bytes(damaged))
    recording = read_log([path])
    assert len(recording.readings) >= len(TIMES) - 10
    assert any("could not be read" in said for said in recording.remarks)


def test_a_telemetry_log_without_what_is_needed_says_what_it_has(tmp_path: Path) -> None:
    dialect = pytest.importorskip("pymavlink.dialects.v20.common")
    link = dialect.MAVLink(None, srcSystem=1)
    beat = dialect.MAVLink_heartbeat_message(2, 3, 0, 0, 0, 3).pack(link)
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"".join(struct.pack(">Q", 1_700_000_000_000_000 + 1_000_000 * k) + beat for k in range(50)))
    with pytest.raises(
        ValueError,
        match=r"^[^\n]*has no message RAW_IMU or SCALED_IMU or HIGHRES_IMU[^\n]*; it has HEARTBEAT; map",
    ):
        read_log([path])


def test_messages_of_telemetry_are_called_by_their_names() -> None:
    """Authority: pymavlink's table of the messages of ArduPilot's dialect."""
    messages = pytest.importorskip("pymavlink.dialects.v20.ardupilotmega").mavlink_map
    for number, name in NAMES.items():
        assert messages[number].msgname == name
    assert name_of(0) == "HEARTBEAT"
    assert name_of(60_000) == "message 60000"


@pytest.mark.parametrize("number", [2, 3])
def test_telemetry_of_another_accelerometer_alone_is_read(tmp_path: Path, number: int) -> None:
    dialect = pytest.importorskip("pymavlink.dialects.v20.common")
    link, records = dialect.MAVLink(None, srcSystem=1), []
    for t in TIMES:
        counts = [round(1e3 * f / 9.80665) for f in force(t)]
        encoded = getattr(link, f"scaled_imu{number}_encode")(round(1e3 * t), *counts, *([0] * 6))
        records.append(struct.pack(">Q", 1_700_000_000_000_000 + round(1e6 * t)) + encoded.pack(link))
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"".join(records))
    assert_as_it_was(read_log([path]), set(), 1e-3)


def test_a_map_that_names_no_message_is_told_what_there_is(tmp_path: Path) -> None:
    path = tmp_path / "flight.log"
    path.write_text(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 144, 24, IMU, Qfff, TimeUS,AccX,AccY,AccZ\n"
        + "".join(f"IMU, {20_000 * k}, 1, 2, -9.8\n" for k in range(50))
    )
    with pytest.raises(ValueError, match=r"^[^\n]*has no column 'ax'; it has IMU\.…; say which is which"):
        read_log([path], "fx=ax")


def test_the_other_accelerometer_is_turned_by_the_same_map(tmp_path: Path) -> None:
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"]
    lines.append("FMT, 144, 24, IMU, QBfff, TimeUS,I,AccX,AccY,AccZ")
    for t in TIMES:
        x, y, z = force(t)
        z += 0.1 * np.sin(50.0 * t)  # it lives
        lines += [f"IMU, {round(1e6 * t)}, {i}, {-y}, {x}, {z}" for i in (0, 1)]
    path = tmp_path / "flight.log"
    path.write_text("\n".join(lines) + "\n")
    recording = read_log([path], "fx=IMU.AccY,fy=-IMU.AccX,fz=IMU.AccZ")
    assert recording.remarks == ()
    assert recording.others["IMU[1]"] == pytest.approx(recording.readings)
