"""The shipped parts against their datasheets, typed again here from notes on the documents and not from our files."""

import math
import os
import re
import subprocess
import sys
import tomllib
from dataclasses import FrozenInstanceError

import pytest
from pydantic import TypeAdapter, ValidationError

import sensors
from sensors import (
    Accelerometer,
    AccelerometerDescription,
    AccelerometerSettings,
    AirDataSettings,
    DifferentialDescription,
    PressureDescription,
    PressureSensor,
    PressureSettings,
    Streams,
    catalogue,
    datasheet_check,
    known_of_head,
    preset,
)
from sensors.noise import enbw

G0 = 9.80665

PARTS = {
    "accelerometer": ["adxl345", "adxl359", "bmi088", "h3lis331dl", "icm-42688-p", "lsm6dso32", "mpu-6050"],
    "pressure": ["bmp280", "bmp388", "bmp390", "bmp581", "dps368", "lps22df", "ms5611", "ms5803-02ba"],
    "differential": ["dlvr-l10d", "ms4525do", "ms4525do-005d", "sdp33"],
}
KINDS = {
    "accelerometer": AccelerometerDescription,
    "pressure": PressureDescription,
    "differential": DifferentialDescription,
}

# part, range g, noise density x, y, z µg/√Hz, least significant bit mg. LSM6DSO32 DocID032891 r1 table 3; ADXL345
# table 1 (its densities are tested below); MPU-6050 PS r3.4 6.2; BMI088 DS000-19 table 4; ICM-42688-P DS-000347
# table 2; ADXL359 r0 table 1 (80 µg/√Hz at ±10 g; the others assumed); H3LIS331DL DocID023111 r2.
ACCELEROMETERS = [
    ("lsm6dso32", 4, (120, 120, 120), 0.122),
    ("lsm6dso32", 8, (130, 130, 130), 0.244),
    ("lsm6dso32", 16, (160, 160, 160), 0.488),
    ("lsm6dso32", 32, (220, 220, 220), 0.976),
    ("adxl345", 2, (290, 290, 430), 3.9),
    ("adxl345", 4, (290, 290, 430), 3.9),
    ("adxl345", 8, (290, 290, 430), 3.9),
    ("adxl345", 16, (290, 290, 430), 3.9),
    ("mpu-6050", 2, (400, 400, 400), 1e3 / 16384),
    ("mpu-6050", 4, (400, 400, 400), 1e3 / 8192),
    ("mpu-6050", 8, (400, 400, 400), 1e3 / 4096),
    ("mpu-6050", 16, (400, 400, 400), 1e3 / 2048),
    ("bmi088", 3, (160, 160, 190), 1e3 / 10920),
    ("bmi088", 6, (160, 160, 190), 1e3 / 5460),
    ("bmi088", 12, (160, 160, 190), 1e3 / 2730),
    ("bmi088", 24, (160, 160, 190), 1e3 / 1365),
    ("icm-42688-p", 2, (65, 65, 70), 1e3 / 16384),
    ("icm-42688-p", 4, (65, 65, 70), 1e3 / 8192),
    ("icm-42688-p", 8, (65, 65, 70), 1e3 / 4096),
    ("icm-42688-p", 16, (65, 65, 70), 1e3 / 2048),
    ("adxl359", 10, (80, 80, 80), 0.0195),
    ("adxl359", 20, (90, 90, 90), 0.039),
    ("adxl359", 40, (110, 110, 110), 0.078),
    ("h3lis331dl", 100, (15e3, 15e3, 15e3), 49),
    ("h3lis331dl", 200, (15e3, 15e3, 15e3), 98),
    ("h3lis331dl", 400, (15e3, 15e3, 15e3), 195),
]

# part, offset mg, its coefficient mg/K, scale %, its coefficient %/K, cross-axis %, nonlinearity %: typical figures of
# the same tables. MPU-6050: ±35, ±60 mg over 0 to 70 °C. Not stated and assumed: scale of BMI088, ADXL359 (limit of
# the ADXL355, ±8 %) and H3LIS331DL; nonlinearity of the ADXL359 at ±40 g (ADXL358).
ERRORS = [
    ("lsm6dso32", (20, 20, 20), (0.1, 0.1, 0.1), 0.5, 0.007, 0, 0),
    ("adxl345", (35, 35, 40), (0.4, 0.4, 1.2), 1, 0.01, 1, 0.5),
    ("mpu-6050", (50, 50, 80), (35 / 70, 35 / 70, 60 / 70), 3, 0.02, 2, 0.5),
    ("bmi088", (20, 20, 20), (0.2, 0.2, 0.2), 0.5, 0.002, 0.5, 0.5),
    ("icm-42688-p", (20, 20, 20), (0.15, 0.15, 0.15), 0.5, 0.005, 1, 0.1),
    ("adxl359", (125, 125, 125), (0.45, 0.45, 0.45), 8 / 3, 0.015, 1.5, 1.3),
    ("h3lis331dl", (1000, 1000, 1000), (5, 5, 5), 3, 0.01, 0, 2),
]

HALVES = [3200 / 2**n for n in range(10)]
RATES = {
    "lsm6dso32": (12.5, 26, 52, 104, 208, 416, 833, 1666, 3332, 6664),
    "adxl345": (0.1, 0.2, 0.39, 0.78, 1.56, 3.13, *reversed(HALVES)),
    "mpu-6050": (10, 20, 25, 40, 50, 100, 125, 200, 250, 500, 1000),
    "bmi088": (12.5, 25, 50, 100, 200, 400, 800, 1600),
    "icm-42688-p": (25, 50, 100, 200, 500, 1000, 2000, 4000, 8000, 16000, 32000),
    "adxl359": tuple(4000 / 2**n for n in range(10, -1, -1)),
    "h3lis331dl": (50, 100, 400, 1000),
}

# ICM-42688-P DS-000347 5.5, second-order filter: rate, ACCEL_UI_FILT_BW 0 to 7: 3 dB bandwidth and noise bandwidth, Hz
ICM_FILTERS = ["rate/2", "rate/4", "rate/5", "rate/8", "rate/10", "rate/16", "rate/20", "rate/40"]
ICM = {
    1000: "493.3 230.7 191.6 117.5 97.1 59.6 48.0 21.3",
    500: "246.7 115.3 95.8 58.8 48.5 29.8 24.0 10.6",
    200: "98.7 92.3 76.6 47.0 38.8 23.8 19.2 8.5",
    100: "49.3 92.3 76.6 47.0 38.8 23.8 19.2 8.5",
    50: "24.7 92.3 76.6 47.0 38.8 23.8 19.2 8.5",
    25: "12.3 92.3 76.6 47.0 38.8 23.8 19.2 8.5",
    2000: "524.0 " * 8,
    4000: "1048.1 " * 8,
    8000: "2096.3 " * 8,
    16000: "4194.1 " * 8,
    32000: "8400.0 " * 8,
}
ICM_NOISE_BANDWIDTH = {
    1000: "551.1 223.7 189.9 122.7 102.8 64.7 52.5 23.7",
    500: "259.6 111.9 95.0 61.4 51.4 32.4 26.3 11.9",
}
# BMI088 table 8, x and y: rate: normal, OSR2, OSR4
BMI088 = "12.5:5/2/1 25:10/5/3 50:20/9/5 100:40/19/10 200:80/38/20 400:145/75/40 800:230/140/80 1600:280/234/145"

# part, mode, noise Pa rms (filter off), conversion ms, rate Hz. BMP280 DS001-11 tables 8, 13, 14; BMP388 DS001-07
# 3.4.4, 3.9.1; BMP390 DS002-07 table 8 and 3.9; BMP581 DS003-09 table 9; MS5611 06/2017; DPS368 v1.1 table 16. Of the
# LPS22DF, DS13316 r3, two figures at rate/9 are tested below.
PRESSURE_MODES = [
    ("bmp280", "x1/x1", 3.3, 5.5, 166.67),
    ("bmp280", "x2/x1", 2.6, 7.5, 125.00),
    ("bmp280", "x4/x1", 2.1, 11.5, 83.33),
    ("bmp280", "x8/x1", 1.6, 19.5, 50.00),
    ("bmp280", "x16/x2", 1.3, 37.5, 26.32),
    ("bmp388", "x1/x1", 6.6, 4.82, 200),
    ("bmp388", "x2/x1", 4.3, 6.84, 100),
    ("bmp388", "x4/x1", 3.2, 10.88, 50),
    ("bmp388", "x8/x1", 2.3, 18.69, 50),
    ("bmp388", "x16/x2", 1.6, 37.14, 25),
    ("bmp388", "x32/x2", 1.2, 69.46, 12.5),
    ("bmp390", "x1/x1", 3.7, 4.82, 200),
    ("bmp390", "x2/x1", 2.7, 6.84, 100),
    ("bmp390", "x4/x1", 2.0, 10.88, 50),
    ("bmp390", "x8/x1", 1.6, 18.69, 50),
    ("bmp390", "x16/x2", 1.2, 37.14, 25),
    ("bmp390", "x32/x2", 0.9, 69.46, 12.5),
    ("bmp581", "x1/x1", 0.78, 1.0, 498),
    ("bmp581", "x2/x1", 0.58, 1.7, 374),
    ("bmp581", "x4/x1", 0.41, 2.9, 255),
    ("bmp581", "x8/x1", 0.30, 5.4, 155),
    ("bmp581", "x16/x1", 0.21, 10.4, 87),
    ("bmp581", "x32/x2", 0.15, 20.4, 46),
    ("bmp581", "x64/x4", 0.11, 40.4, 24),
    ("bmp581", "x128/x8", 0.08, 80.4, 12),
    ("ms5611", "x256/x256", 6.5, 0.54, 833.3),
    ("ms5611", "x512/x512", 4.2, 1.06, 427.3),
    ("ms5611", "x1024/x1024", 2.7, 2.08, 219.2),
    ("ms5611", "x2048/x2048", 1.8, 4.13, 110.1),
    ("ms5611", "x4096/x4096", 1.2, 8.22, 55.3),
    ("dps368", "x1/x1", 2.5, 3.6, 128),
    ("dps368", "x2/x1", 1.0, 5.2, 64),
    ("dps368", "x4/x1", 0.5, 8.4, 64),
    ("dps368", "x8/x1", 0.4, 14.8, 32),
    ("dps368", "x16/x1", 0.35, 27.6, 32),
    ("dps368", "x32/x1", 0.3, 53.2, 16),
    ("dps368", "x64/x1", 0.2, 104.4, 8),
]

# part: range kPa; offset Pa, its limit; coefficient Pa/K; solder Pa; thermometer K, its limit; oscillator %, its limit
PRESSURE_ERRORS = {
    "bmp280": ((30, 110), 100, 300, 1.5, (-50, 200), 0.5, 1.5, 5, 25),
    "bmp388": ((30, 125), 50, 150, 0.75, (-100, 100), 0.3, 0.9, 2, 12),
    "bmp390": ((30, 125), 50, 150, 0.62, (-80, 80), 0.5, 1.5, 2, 12),
    "bmp581": ((30, 125), 10, 30, 0.5 / 3, (-30, 30), 0.5 / 3, 0.5, 10 / 3, 10),
    "ms5611": ((1, 120), 50, 150, 2 / 3, (0, 0), 0.8 / 3, 0.8, 0, 0),
    "ms5803-02ba": ((1, 200), 100, 300, 2 / 3, (0, 0), 0.8 / 3, 0.8, 0, 0),  # twice the MS5611's: assumed
    "dps368": ((30, 120), 100, 300, 0.5, (-240, 240), 0.5, 1.5, 0, 0),
    "lps22df": ((26, 126), 20, 60, 0.45, (-15, 15), 1.5, 4.5, 0, 0),
}

# printed noise behind the digital filter, Pa rms (0.05 stands for <0.1); rows: modes, columns: coefficients above 0
FILTERED = {
    "bmp280": ["1.9 1.2 .9 .4", "1.5 1.0 .6 .4", "1.2 .8 .5 .3", "1.0 .6 .4 .2", ".8 .5 .4 .2"],
    "bmp388": [
        "3.8 2.5 1.7 1.2 .8 .6 .4", "2.5 1.6 1.1 .8 .5 .4 .3", "1.8 1.2 .8 .6 .4 .3 .2", "1.3 .9 .6 .4 .3 .2 .1",
        ".9 .6 .4 .2 .2 .1 .1", ".7 .4 .3 .3 .1 .1 .05",
    ],
    "bmp390": [
        "2.0 1.2 .8 .4 .2 .1 .1", "1.5 .9 .5 .3 .2 .1 .1", "1.1 .7 .4 .3 .2 .1 .04", ".9 .6 .3 .2 .1 .1 .03",
        ".6 .4 .2 .1 .1 .04 .03", ".5 .3 .2 .1 .1 .05 .05",
    ],
}  # fmt: skip


def sheet(name):
    return tomllib.loads((catalogue.FOLDER / f"{name}.toml").read_text(encoding="utf-8"))


def numbers(row):
    return [float(word) for word in row.split()]


def of_so_many(a, count=32):
    """Share of its standard deviation that y += a (x - y) of white noise shows in `count` consecutive samples."""
    phi = 1.0 - a
    mean = ((1 + phi) / (1 - phi) - 2 * phi * (1 - phi**count) / (count * (1 - phi) ** 2)) / count
    return (count / (count - 1) * (1 - mean)) ** 0.5


# -- accelerometers --------------------------------------------------------------------------------------------------


def test_all_shipped_parts_are_listed_and_read():
    assert sensors.presets() == sorted(name for names in PARTS.values() for name in names)
    for kind, names in PARTS.items():
        for name in names:
            part = preset(name)
            assert part.name == name
            assert type(part) is KINDS[kind]


@pytest.mark.parametrize(("name", "range_g", "density_ug", "lsb_mg"), ACCELEROMETERS)
def test_accelerometer_at_each_range(name, range_g, density_ug, lsb_mg):
    part = preset(name).select(range_g=range_g)
    assert part.range == pytest.approx(range_g * G0)
    assert part.noise_density == pytest.approx([n * 1e-6 * G0 for n in density_ug])
    rounded = 2.5e-2 if name == "adxl359" else 4e-3  # the datasheets round it; the ADXL359's converter ends at 10.24 g
    assert part.resolution == pytest.approx(lsb_mg * 1e-3 * G0, rel=rounded)


def test_no_range_is_missing_from_the_table():
    for name in PARTS["accelerometer"]:
        assert preset(name).ranges_g == tuple(row[1] for row in ACCELEROMETERS if row[0] == name)


@pytest.mark.parametrize(("name", "offset_mg", "tc_mg", "scale", "scale_tc", "cross", "nonlinearity"), ERRORS)
def test_typical_errors_of_an_accelerometer(name, offset_mg, tc_mg, scale, scale_tc, cross, nonlinearity):
    part = preset(name)
    assert part.bias_sd == pytest.approx([mg * 1e-3 * G0 for mg in offset_mg])
    assert part.bias_tc_sd == pytest.approx([mg * 1e-3 * G0 for mg in tc_mg], rel=1e-3)
    assert part.scale_sd == pytest.approx(scale / 100, rel=1e-3)
    assert part.scale_tc_sd == pytest.approx(scale_tc / 100)
    assert part.cross_axis_sd == pytest.approx(cross / 100)
    assert part.nonlinearity_sd == pytest.approx(nonlinearity / 100)


@pytest.mark.parametrize("name", PARTS["accelerometer"])
def test_rates_of_an_accelerometer(name):
    assert preset(name).rates == pytest.approx(RATES[name])


@pytest.mark.parametrize(
    ("name", "range_g", "rate", "bandwidth"),
    [
        ("lsm6dso32", 32, 833, 416.5), ("adxl345", 16, 800, 400), ("mpu-6050", 16, 1000, 260), ("bmi088", 24, 800, 230),
        ("icm-42688-p", 16, 1000, 230.7), ("adxl359", 40, 1000, 250), ("h3lis331dl", 100, 1000, 500),
    ],
)  # fmt: skip
def test_accelerometer_defaults(name, range_g, rate, bandwidth):
    part = preset(name)
    assert (part.range_g, part.rate, part.bandwidth) == (range_g, rate, bandwidth)


def test_bandwidths_that_follow_the_rate():
    """LSM6DSO32 table 65; ADXL345 table 1 note 3; ADXL359 filter register; H3LIS331DL prints above half the rate."""
    lsm = preset("lsm6dso32")
    assert lsm.filters == tuple(f"rate/{n}" for n in (2, 4, 10, 20, 45, 100, 200, 400, 800))
    for name, filters in (("lsm6dso32", lsm.filters), ("adxl345", ["rate/2"]), ("adxl359", ["rate/4"])):
        for rate in preset(name).rates:
            for chosen in filters:
                part = preset(name).select(rate=rate, filter=chosen)
                assert part.bandwidth == pytest.approx(rate / int(chosen.removeprefix("rate/")), rel=1e-3, abs=1e-5)
    high = preset("h3lis331dl")
    assert all(high.select(rate=rate).bandwidth == rate / 2 for rate in (50, 100, 400, 1000))


def test_mpu6050_bandwidths():
    """Register 26, at 1 kHz; behind the divider only what is not above half the rate."""
    part = preset("mpu-6050")
    for filter_hz in (260, 184, 94, 44, 21, 10, 5):
        assert part.select(filter=f"{filter_hz} Hz").bandwidth == filter_hz
    assert part.select(rate=500, filter="184 Hz").bandwidth == 184
    with pytest.raises(ValueError, match="'260 Hz' does not exist at 500 Hz; allowed: 1000"):
        part.select(rate=500)


def test_bmi088_bandwidths():
    for entry in BMI088.split():
        rate, widths = entry.split(":")
        for chosen, width in zip(("normal", "osr2", "osr4"), widths.split("/"), strict=True):
            assert preset("bmi088").select(rate=float(rate), filter=chosen).bandwidth == float(width)


@pytest.mark.parametrize("rate", ICM)
def test_icm42688p_bandwidths(rate):
    """5.5, second order: as printed where it is not above half the rate, refused where it is."""
    part = preset("icm-42688-p")
    for chosen, width in zip(ICM_FILTERS, numbers(ICM[rate]), strict=True):
        if width <= rate / 2:
            assert part.select(rate=rate, filter=chosen).bandwidth == width
        else:
            with pytest.raises(ValueError, match=f"{chosen!r} does not exist at {rate:g} Hz; allowed: "):
                part.select(rate=rate, filter=chosen)


@pytest.mark.parametrize("rate", ICM_NOISE_BANDWIDTH)
def test_icm42688p_noise_bandwidth_is_the_datasheets(rate):
    """NBW of 5.5 against our two poles at the output rate, to 5 % of the variance; setting 0 is left, its NBW > f/2."""
    part = preset("icm-42688-p")
    for chosen, printed in list(zip(ICM_FILTERS, numbers(ICM_NOISE_BANDWIDTH[rate]), strict=True))[1:]:
        x, _, z = part.select(rate=rate, filter=chosen).noise_sd
        assert (x / (65e-6 * G0)) ** 2 == pytest.approx(printed, rel=0.05)
        assert (z / (70e-6 * G0)) ** 2 == pytest.approx(printed, rel=0.05)


def test_icm42688p_rms_in_100_hz():
    """Table 2: 0.65 and 0.70 mg rms in 100 Hz."""
    assert [n * 10 / (1e-3 * G0) for n in preset("icm-42688-p").noise_density] == pytest.approx([0.65, 0.65, 0.70])


def test_adxl345_limits_and_noise_law():
    """Table 1: 0 g output ±150, ±250 mg; 230 to 282 LSB/g. Page 33: noise constant to 100 Hz, √2 a doubling above."""
    part = preset("adxl345")
    assert part.bias_limit == pytest.approx([0.150 * G0, 0.150 * G0, 0.250 * G0])
    assert part.scale_limit == pytest.approx(0.10, abs=0.002)
    at = {rate: part.select(rate=rate).noise_sd[0] for rate in (12.5, 100, 200, 400)}
    assert at[12.5] == at[100]
    assert at[400] / at[200] == pytest.approx(2**0.5)


def test_adxl345_noise_in_steps():
    """The document's two lines differ: with its density the rms at 100 Hz is below table 1's; at 1.3 of it, it is that.

    Table 1: 0.75 and 1.1 LSB rms, the step's own 0.289 in it; to 6 %. Page 33, at 400 Hz: below 1.5 and 2.2 LSB.
    """
    part = preset("adxl345").select(rate=100)
    worded, read_as_allan = ([hypot_lsb(sd, p) for sd in p.noise_sd] for p in (part, part.scaled(1.3)))
    assert worded == pytest.approx([0.60, 0.60, 0.83], abs=0.01)
    assert read_as_allan == pytest.approx([0.75, 0.75, 1.1], rel=0.06)
    at_one_second = [hypot_lsb(sd, part) * part.resolution * 0.1 for sd in part.scaled(1.3).noise_sd]  # σ √(0.01 s)
    assert at_one_second == pytest.approx([290e-6 * G0, 290e-6 * G0, 430e-6 * G0], rel=0.06)  # figure 52
    fast = preset("adxl345").select(rate=400).scaled(1.3)
    assert all(hypot_lsb(sd, fast) < bound for sd, bound in zip(fast.noise_sd, (1.5, 1.5, 2.2), strict=True))


def hypot_lsb(sd, part):
    """Standard deviation of the readings, in steps, their rounding included."""
    return math.hypot(sd / part.resolution, 12**-0.5)


def test_adxl359_vibration_rectification():
    """Table 1: below 0.1 g for 7.5 g rms at ±10 g, taken as 3 sigma."""
    assert preset("adxl359").rectification_sd * (7.5 * G0) ** 2 == pytest.approx(0.1 / 3 * G0, rel=1e-3)


@pytest.mark.parametrize("name", PARTS["accelerometer"])
def test_every_setting_of_an_accelerometer_exists_or_is_refused(name):
    part = preset(name)
    table = dict(zip(part.filters, part.bandwidths, strict=True))
    for range_g in part.ranges_g:
        for index, rate in enumerate(part.rates):
            for chosen in part.filters:
                if table[chosen][index]:
                    one = part.select(range_g=range_g, rate=rate, filter=chosen)
                    assert 0 < one.bandwidth <= rate / 2
                    assert all(0 < sd < math.inf for sd in one.noise_sd)
                    passed = enbw(one.bandwidth, rate, part.poles)
                    floored = max(rate, part.noise_rate_floor) / rate
                    assert one.noise_sd[0] == pytest.approx(one.noise_density[0] * (passed * floored) ** 0.5)
                else:
                    allowed = [f"{r:g}" for r, width in zip(part.rates, table[chosen], strict=True) if width]
                    with pytest.raises(ValueError, match=r"does not exist at .*; allowed: ") as caught:
                        part.select(range_g=range_g, rate=rate, filter=chosen)
                    assert str(caught.value).endswith(", ".join(allowed))


# -- pressure sensors ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "mode", "noise", "conversion_ms", "rate"), PRESSURE_MODES)
def test_pressure_sensor_in_each_mode(name, mode, noise, conversion_ms, rate):
    part = preset(name).select(mode=mode)
    assert part.noise_sd == pytest.approx(noise)
    assert part.mode.conversion_time == pytest.approx(conversion_ms / 1000)
    assert part.rate == rate
    assert part.mode.conversion_time < 1 / part.rate
    assert 0 < part.white_sd <= part.noise_sd


@pytest.mark.parametrize("name", sorted({row[0] for row in PRESSURE_MODES}))
def test_no_mode_is_missing_from_the_table(name):
    assert [mode.name for mode in preset(name).modes] == [row[1] for row in PRESSURE_MODES if row[0] == name]


@pytest.mark.parametrize("name", PARTS["pressure"])
def test_typical_errors_of_a_pressure_sensor(name):
    part = preset(name)
    span, offset, limit, tc, solder, warm, warm_limit, rate, rate_limit = PRESSURE_ERRORS[name]
    assert part.range == tuple(1000.0 * kpa for kpa in span)
    assert (part.offset_sd, part.offset_limit, part.solder) == (offset, limit, solder)
    assert part.offset_tc_sd == pytest.approx(tc, rel=3e-3)
    assert part.temperature_offset_sd == pytest.approx(warm, rel=3e-3)
    assert part.temperature_offset_limit == warm_limit
    assert part.rate_sd == pytest.approx(rate / 100, rel=1e-3)
    assert part.rate_limit == rate_limit / 100
    assert (part.acceleration_sd, part.acceleration_limit) == (0.2, 0.6)


@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("bmp280", (2.62, 1.31, 0.66, 0.33, 0.16)),
        ("bmp388", (2.64, 1.32, 0.66, 0.33, 0.17, 0.085)),
        ("bmp390", (2.64, 1.32, 0.66, 0.33, 0.17, 0.085)),
        ("bmp581", (1 / 64,) * 8),
        ("ms5611", (1315097036 / 2**36,) * 5),
        ("dps368", (0.06,) * 7),
        ("lps22df", (100 / 4096,) * 3),
    ],
)
def test_resolution_of_pressure(name, steps):
    assert [mode.resolution for mode in preset(name).modes] == pytest.approx(steps, rel=5e-3)


@pytest.mark.parametrize(
    ("name", "temperature_noise", "step"),
    [
        ("bmp280", (0.005, 0.005, 0.005, 0.005, 0.004), 0.005),
        ("bmp388", (0.005, 0.005, 0.005, 0.005, 0.004, 0.003), 0.005),
        ("bmp390", (0.005, 0.005, 0.005, 0.005, 0.004, 0.003), 0.005),
        ("ms5611", (0.012, 0.008, 0.005, 0.003, 0.002), 0.01 * 28312 / 2**23),
        ("dps368", (0.005,) * 7, 0.01),
        ("lps22df", (0.005,) * 3, 0.01),
    ],
)
def test_thermometers(name, temperature_noise, step):
    part = preset(name)
    assert tuple(mode.temperature_noise_sd for mode in part.modes) == temperature_noise
    assert part.temperature_resolution == pytest.approx(step, rel=1e-3)


@pytest.mark.parametrize("name", ["bmp388", "bmp390"])
def test_bosch_rate_is_the_highest_that_holds_the_conversion(name):
    for mode in preset(name).modes:
        allowed = [rate for rate in (200, 100, 50, 25, 12.5) if mode.conversion_time <= 1 / rate]
        assert mode.rate == max(allowed)


def test_bmp280_rate_is_conversion_and_standby():
    """Table 14 is 1/(table 13 + 0.5 ms)."""
    for mode in preset("bmp280").modes:
        assert mode.rate == pytest.approx(1 / (mode.conversion_time + 0.5e-3), abs=0.005)


def test_dps368_rate_leaves_time_for_the_temperature():
    """Section 4.4: rate (pressure + 3.6 ms) < 1, rates in powers of two to 128 Hz; table 16 is 2 + 1.6 OSR ms."""
    for mode in preset("dps368").modes:
        assert mode.rate == max(2**n for n in range(8) if 2**n * (mode.conversion_time + 3.6e-3) < 1)
        assert mode.conversion_time == pytest.approx(2e-3 + 1.6e-3 * int(mode.name[1:].split("/")[0]), rel=1e-9)


def test_ms5611_rate_is_the_slowest_units_with_both_conversions():
    for mode, longest in zip(preset("ms5611").modes, (0.60, 1.17, 2.28, 4.54, 9.04), strict=True):
        assert 1 / mode.rate >= 2e-3 * longest
        assert mode.rate == pytest.approx(500 / longest, rel=2e-3)
        assert mode.conversion_time == pytest.approx(1e-3 * longest / 1.1, rel=0.02)  # typ ±10 %


@pytest.mark.parametrize("mode", ["x1/x1", "x2/x1", "x4/x1", "x16/x2", "x32/x2"])
def test_bmp390_conversion_time_is_that_of_its_formula(mode):
    """T = 234 + (392 + 2020 osr_p) + (163 + 2020 osr_t) µs, to 0.3 %; at x8 the document prints 18.69 for 18.97 ms."""
    osr_p, osr_t = (int(part[1:]) for part in mode.split("/"))
    expected = (234 + 392 + 2020 * osr_p + 163 + 2020 * osr_t) * 1e-6
    assert preset("bmp390").select(mode=mode).mode.conversion_time == pytest.approx(expected, rel=3e-3)


def test_bmp388_conversion_time_is_near_its_formula():
    """3.9.2: T = 234 + (392 + 2000 osr_p) + (313 + 2000 osr_t) µs; its table, the BMP390's, is up to 2.5 % off that."""
    for mode in preset("bmp388").modes:
        osr_p, osr_t = (int(part[1:]) for part in mode.name.split("/"))
        expected = (234 + 392 + 2000 * osr_p + 313 + 2000 * osr_t) * 1e-6
        assert mode.conversion_time == pytest.approx(expected, rel=0.025)


def test_bmp390_noise_behind_its_filter():
    """Table 8, all 42 entries to 0.08 Pa (0.05 is rounding): deviation of 32 samples of y += (x - y)/coefficient."""
    part = preset("bmp390")
    for mode, row in zip(part.modes, FILTERED["bmp390"], strict=True):
        for coefficient, printed in zip((2, 4, 8, 16, 32, 64, 128), numbers(row), strict=True):
            one = part.select(mode=mode.name, iir=coefficient)
            assert one.iir_weight == 1 / coefficient
            assert one.noise_sd * of_so_many(one.iir_weight) == pytest.approx(printed, abs=0.08)


def test_bmp388_noise_behind_its_filter():
    """3.4.4, to 0.09 Pa (0.05 is rounding; two of column 15 stand in each other's place): weight 1/(c + 1)."""
    part = preset("bmp388")
    for mode, row in zip(part.modes, FILTERED["bmp388"], strict=True):
        for coefficient, printed in zip((1, 3, 7, 15, 31, 63, 127), numbers(row), strict=True):
            one = part.select(mode=mode.name, iir=coefficient)
            assert one.iir_weight == 1 / (coefficient + 1)
            assert one.noise_sd == pytest.approx(printed, abs=0.09)


def test_bmp280_noise_behind_its_filter():
    """Table 8, to 0.08 Pa (0.05 is rounding); at 16 it lies between the noise and what 32 samples show of it."""
    part = preset("bmp280")
    for mode, row in zip(part.modes, FILTERED["bmp280"], strict=True):
        *printed, last = numbers(row)
        for coefficient, noise in zip((2, 4, 8), printed, strict=True):
            assert part.select(mode=mode.name, iir=coefficient).noise_sd == pytest.approx(noise, abs=0.08)
        slow = part.select(mode=mode.name, iir=16)
        assert slow.iir_weight == 1 / 16
        assert slow.noise_sd * of_so_many(1 / 16) - 0.05 < last < slow.noise_sd + 0.05


@pytest.mark.parametrize(("coefficient", "samples"), [(0, 1), (2, 2), (4, 5), (8, 11), (16, 22)])
def test_bmp280_step_response(coefficient, samples):
    """Table 6: samples to reach 75 % of a step, 1 - (1 - a)^n."""
    a = preset("bmp280").select(iir=coefficient).iir_weight
    assert min(n for n in range(1, 40) if 1 - (1 - a) ** n >= 0.75) == samples


@pytest.mark.parametrize(
    ("coefficient", "printed"),
    [(1, 0.1147), (3, 0.0459), (7, 0.0212), (15, 0.01025), (31, 0.005041), (63, 0.00250), (127, 0.00125)],
)
def test_bmp581_filter_has_the_datasheets_bandwidth(coefficient, printed):
    """f(-3 dB)/rate as printed, within 0.5 %."""
    part = preset("bmp581").select(iir=coefficient)
    assert part.bandwidth / part.rate == pytest.approx(printed, rel=5e-3)


@pytest.mark.parametrize(("mode", "printed"), [("x512", 0.34), ("x32", 0.87)])
def test_lps22df_noise_behind_its_low_pass(mode, printed):
    """DS13316: rms at rate/9."""
    assert preset("lps22df").select(mode=mode, iir=9).noise_sd == pytest.approx(printed, rel=2e-3)


@pytest.mark.parametrize("divisor", [4, 9])
def test_lps22df_low_pass(divisor):
    """CTRL_REG2: -3 dB at rate/4 or rate/9."""
    part = preset("lps22df").select(iir=divisor)
    assert part.bandwidth == pytest.approx(part.rate / divisor, rel=1e-5)


@pytest.mark.parametrize("name", ["ms5611", "dps368"])
def test_parts_without_a_filter_refuse_one(name):
    assert preset(name).iir_weights == ((0, 1.0),)
    with pytest.raises(ValueError, match=r"iir 2 is unknown; nearest: 0; allowed: 0$"):
        preset(name).select(iir=2)


@pytest.mark.parametrize("name", [*PARTS["pressure"], *PARTS["differential"]])
def test_every_setting_of_a_pressure_sensor_exists_or_is_refused(name):
    part = preset(name)
    coefficients = [coefficient for coefficient, _ in part.iir_weights]
    for mode in part.modes:
        for coefficient in coefficients:
            one = part.select(mode=mode.name, iir=coefficient)
            assert 0 < one.noise_sd <= mode.noise_sd
            assert 0 < one.bandwidth < math.inf
            assert 0 < one.temperature_noise_sd < 1
    with pytest.raises(ValueError, match="mode 'x3/x3' is unknown") as caught:
        part.select(mode="x3/x3")
    assert str(caught.value).endswith("allowed: " + ", ".join(mode.name for mode in part.modes))
    with pytest.raises(ValueError, match="iir 5 is unknown") as caught:
        part.select(iir=5)
    assert str(caught.value).endswith("allowed: " + ", ".join(map(str, coefficients)))


# -- units of a part -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", PARTS["accelerometer"])
def test_three_draws_of_an_accelerometer(name):
    part = preset(name)
    ideal = Accelerometer(part, Streams(1), unit="ideal")
    assert (*ideal.bias, *ideal.scale_error, ideal.rate_error) == (0.0,) * 7
    typical = Accelerometer(part, Streams(1), unit="typical")
    assert [abs(b) for b in typical.bias] == pytest.approx(part.bias_sd)
    assert [abs(s) for s in typical.scale_error] == pytest.approx([part.scale_sd] * 3)
    units = [Accelerometer(part, Streams(seed), unit="random") for seed in range(40)]
    for unit in units:
        assert all(abs(b) <= limit for b, limit in zip(unit.bias, part.bias_limit, strict=True))
        assert all(abs(s) <= part.scale_limit for s in unit.scale_error)
        assert abs(unit.rate_error) <= part.rate_limit
    # 120 draws: standard deviation within 30 % (5 sigma of its own scatter, cut at 3 sigma included)
    drawn = (sum((b / sd) ** 2 for unit in units for b, sd in zip(unit.bias, part.bias_sd, strict=True)) / 120) ** 0.5
    assert drawn == pytest.approx(1.0, abs=0.3)


@pytest.mark.parametrize("name", [*PARTS["pressure"], *PARTS["differential"]])
def test_three_draws_of_a_pressure_sensor(name):
    part = preset(name)
    ideal = PressureSensor(part, Streams(1), unit="ideal")
    assert (ideal.offset, ideal.scale_error, ideal.rate_error, ideal.temperature_offset) == (0.0,) * 4
    typical = PressureSensor(part, Streams(1), unit="typical")
    assert abs(typical.scale_error) == pytest.approx(part.scale_sd)
    assert abs(typical.temperature_offset) == pytest.approx(part.temperature_offset_sd)
    reach = part.offset_limit + max(map(abs, part.solder))
    units = [PressureSensor(part, Streams(seed), unit="random") for seed in range(40)]
    for unit in [typical, *units]:
        assert abs(unit.offset) <= reach
        assert abs(unit.scale_error) <= part.scale_limit
        assert abs(unit.rate_error) <= part.rate_limit
        assert abs(unit.temperature_offset) <= part.temperature_offset_limit
    assert len({unit.offset for unit in units}) == 40


# -- sources ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sensors.presets())
def test_every_number_has_a_source(name):
    """Which says something and names neither a path nor an address."""
    file = sheet(name)
    keys = set(file["values"]) | {f"modes.{key}" for mode in file.get("modes", []) for key in mode}
    assert set(file["sources"]) == keys
    place = re.compile(r"(^|\s)[/~][A-Za-z]|\w:\\|https?:|www\.|github|\.(py|pdf|md|txt|toml|csv)\b|libdriver")
    for key, source in file["sources"].items():
        assert len(source) > 5, key
        assert not place.search(source), f"{key}: {source}"
    assert not place.search(file["part"] + " " + file["document"])


def test_a_part_tells_its_document():
    assert preset("bmp388").document.endswith("BST-BMP388-DS001-07 rev 1.7, November 2020")
    assert preset("icm-42688-p").document.startswith("ICM-42688-P, TDK InvenSense")


# -- files -----------------------------------------------------------------------------------------------------------


def test_descriptions_are_frozen_plain_numbers():
    part = preset("bmp390")
    with pytest.raises(FrozenInstanceError):
        part.iir = 4
    for number in (part.noise_sd, part.random_walk, part.correlation_time, part.resolution, part.offset_sd):
        assert isinstance(number, float)
        assert number > 0


@pytest.mark.parametrize(
    ("call", "nearest", "allowed"),
    [
        (lambda: preset("lsm6ds032"), "lsm6dso32", "adxl345"),
        (lambda: preset("BMP390"), "bmp", "bmp581"),
        (lambda: preset("mpu6050"), "mpu-6050", "icm-42688-p"),
        (lambda: preset("lsm6dso32").select(rate=800), "833", "6664"),
        (lambda: preset("lsm6dso32").select(range_g=30), "32", "16"),
        (lambda: preset("lsm6dso32").select(filter="rate/3"), "rate/", "rate/800"),
        (lambda: preset("bmp390").select(mode="x8/x2"), "x8/x1", "x32/x2"),
        (lambda: preset("bmp390").select(iir=3), "2", "128"),
        (
            lambda: AccelerometerSettings(preset="bmp390").description(),
            "pressure sensor",
            "adxl345, adxl359, bmi088, h3lis331dl, icm-42688-p, lsm6dso32, mpu-6050",
        ),
        (
            lambda: PressureSettings(preset="adxl345").description(),
            "accelerometer",
            "bmp280, bmp388, bmp390, bmp581, dps368, lps22df, ms5611, ms5803-02ba",
        ),
    ],
)
def test_unknown_choices_name_the_nearest_and_what_is_allowed(call, nearest, allowed):
    with pytest.raises(ValueError) as caught:  # noqa: PT011  # both parts of the message are checked
        call()
    message = str(caught.value)
    assert nearest in message
    assert allowed in message
    assert "\n" not in message


LSM = "lsm6dso32"
BMP = "bmp390"
BROKEN = [
    # keys
    (LSM, "bits = [16,", "bitz = [16,", "key 'values.bitz' is unknown; nearest: values.bits"),
    (LSM, "default_rate = 833\n", "", "key values.default_rate is missing"),
    (LSM, 'part = "', 'pert = "', "key 'pert' is unknown; nearest: part"),
    (LSM, "\n[values]", "\n[valuez]", "key 'valuez' is unknown; nearest: values"),
    (LSM, "\n[values]", "\nmodes = 1\n[values]", "key 'modes' is unknown; nearest: "),
    (LSM, 'kind = "accelerometer"', 'kind = "gyroscope"', "kind 'gyroscope' is unknown; nearest: accelerometer"),
    (LSM, 'kind = "accelerometer"\n', "", "key kind is missing"),
    (LSM, 'kind = "accelerometer"', "kind = 3", "key kind must be text, not a number"),
    (LSM, 'kind = "accelerometer"', 'kind = "pressure"', "keys modes, values.default_mode, values.range_pa"),
    (LSM, 'document = "', 'document = "" #', "key document is empty"),
    (BMP, 'name = "x1/x1"\n', "", "key modes.name (mode 1) is missing"),
    (BMP, "noise_pa = 3.7", "noise_pa = 3.7\ncolour = 1", "key 'modes.colour' is unknown; nearest: modes."),
    (BMP, "range_pa = [30000, 125000]\n", "", "key values.range_pa is missing"),
    # units
    (LSM, "offset_mg = [20", "offset_ug = [20",
     "'values.offset_ug' has the wrong unit; wanted: mg, as values.offset_mg"),
    (LSM, "offset_mg = [20", "offset = [20", "'values.offset' has the wrong unit; wanted: mg, as values.offset_mg"),
    (LSM, "noise_density_ug", "noise_density_mg", "wanted: µg, as values.noise_density_ug"),
    (LSM, "scale_limit_percent", "scale_limit_ppm", "wanted: %, as values.scale_limit_percent"),
    (LSM, "\nrates =", "\nrates_khz =", "'values.rates_khz' has the wrong unit; wanted: Hz, as values.rates"),
    (LSM, "correlation_time =", "correlation_time_ms =", "wanted: s, as values.correlation_time"),
    (BMP, "offset_pa = 50", "offset_hpa = 0.5",
     "'values.offset_hpa' has the wrong unit; wanted: Pa, as values.offset_pa"),
    (BMP, "scale = 3e-4", "scale_percent = 0.03", "wanted: a fraction, as values.scale"),
    (BMP, "conversion_ms = 4.82", "conversion_us = 4820", "'modes.conversion_us' has the wrong unit; wanted: ms"),
    (BMP, "temperature_noise_k = 0.005", "temperature_noise_degc = 0.005", "wanted: K, as modes.temperature_noise_k"),
    # sources
    (LSM, 'drift_ug = "', 'drift_mg = "', "key 'sources.drift_mg' is the source of nothing; nearest: sources.drift_ug"),
    (LSM, 'drift_ug = "assum', 'drift_ug = "" # "assum', "key sources.drift_ug is empty"),
    (LSM, 'poles = "assum', '# poles = "assum', "key sources.poles is missing: every number needs its source"),
    (LSM, 'poles = "assum', 'poles = 1 # "assum', "key sources.poles must be text, not a number"),
    (BMP, '"modes.noise_pa" = ', '"modes.rate2" = ', "key 'sources.modes.rate2' is the source of nothing"),
    (BMP, '"modes.noise_pa" = ', "# ", "key sources.modes.noise_pa is missing"),
    # types
    (LSM, "drift_ug = 91", 'drift_ug = "91"', "key values.drift_ug must be a number, not text"),
    (LSM, "drift_ug = 91", "drift_ug = true", "key values.drift_ug must be a number, not true or false"),
    (LSM, "drift_ug = 91", "drift_ug = [91]", "key values.drift_ug must be a number, not a list"),
    (LSM, "drift_ug = 91", "drift_ug = 2020-01-01", "key values.drift_ug must be a number, not a date or time"),
    (LSM, "drift_ug = 91", "drift_ug = nan", "key values.drift_ug must be a finite number"),
    (LSM, "drift_ug = 91", "drift_ug = inf", "key values.drift_ug must be a finite number"),
    (LSM, "drift_ug = 91", f"drift_ug = 1{'0' * 100}", "key values.drift_ug must be a finite number"),
    (LSM, "ranges_g = [4,", "ranges_g = [true,", "key values.ranges_g[0] must be a number, not true or false"),
    (LSM, "bits = [16, 16", "bits = [16, 16.5",
     "key values.bits[1] must be a whole number, not a number with a fraction"),
    (LSM, "bits = [16, 16", "bits = [16, 99", "key values.bits[1] is 99; it must be 2 to 32"),
    (LSM, 'filters = ["rate/2"', "filters = [2", "key values.filters[0] must be text, not a number"),
    (BMP, "range_pa = [30000, 125000]", "range_pa = 125000", "key values.range_pa must be a list, not a number"),
    # each value
    (LSM, "[[120, 120, 120]", "[[120, -120, 120]", "key values.noise_density_ug[0][1] is -120; it must be 0 to 1e+06"),
    (LSM, "offset_mg = [20, 20", "offset_mg = [20, -20", "key values.offset_mg[1] is -20; it must be 0 to 100000"),
    (LSM, "offset_limit_mg = [60", "offset_limit_mg = [-60", "key values.offset_limit_mg[0] is -60"),
    (LSM, "scale_percent = 0.5", "scale_percent = -0.5", "key values.scale_percent is -0.5; it must be 0 to 50"),
    (LSM, "random_walk_ug = 8.2", "random_walk_ug = -8.2", "key values.random_walk_ug is -8.2; it must be 0 to 1e+06"),
    (LSM, "correlation_time = 100", "correlation_time = 0", "correlation_time is 0; it must be 0.001 to 1e+06"),
    (LSM, "rates = [12.5", "rates = [-12.5", "key values.rates[0] is -12.5; it must be 0.1 to 40000"),
    (LSM, "rates = [12.5, 26", "rates = [26, 12.5", "key values.rates must rise from each to the next"),
    (LSM, "ranges_g = [4, 8", "ranges_g = [4, 4", "key values.ranges_g must rise from each to the next"),
    (LSM, "ranges_g = [4, 8, 16, 32]", "ranges_g = []", "key values.ranges_g is an empty list"),
    (LSM, "poles = 1", "poles = 3", "key values.poles is 3; it must be 0 to 2"),
    (LSM, "offset_mg = [20, 20, 20]", "offset_mg = [20, 20]", "key values.offset_mg must be a list of 3, not of 2"),
    (LSM, "[[120, 120, 120]", "[[120, 120]", "key values.noise_density_ug[0] must be a list of 3, not of 2"),
    (BMP, "noise_pa = 3.7", "noise_pa = -3.7", "key modes.noise_pa is -3.7; it must be 0 to 10000"),
    (BMP, "resolution_pa = 2.64", "resolution_pa = 0", "key modes.resolution_pa is 0; it must be 1e-06 to 10000"),
    (BMP, "rate = 200", "rate = 0", "key modes.rate is 0; it must be 0.1 to 10000"),
    (BMP, "rate_limit_percent = 12", "rate_limit_percent = 120",
     "key values.rate_limit_percent is 120; it must be 0 to 50"),
    (BMP, "iir_weights = [1, 0.5", "iir_weights = [1, 0", "key values.iir_weights[1] is 0; it must be above 0"),
    (BMP, "iir_weights = [1, 0.5", "iir_weights = [1, 1.5", "key values.iir_weights[1] is 1.5; it must be 0.0001 to 1"),
    (BMP, "iir_coefficients = [0, 2", "iir_coefficients = [0, -2", "key values.iir_coefficients[1] is -2"),
    (BMP, "range_pa = [30000, 125000]", "range_pa = [125000, 30000]", "key values.range_pa must rise"),
    # what has to fit together
    (LSM, "default_rate = 833", "default_rate = 800",
     "key values.default_rate: 800.0 is unknown; nearest: 833; allowed: 12.5"),
    (LSM, "default_range_g = 32", "default_range_g = 30", "key values.default_range_g: 30.0 is unknown; nearest: 32"),
    (LSM, 'default_filter = "rate/2"', 'default_filter = "rate/3"', "key values.default_filter: 'rate/3' is unknown"),
    (LSM, "bits = [16, 16, 16, 16]", "bits = [16]", "key values.bits needs one entry for each of ranges_g"),
    (LSM, "  [6.25, 13,", "  [6.3, 13,",
     "key values.bandwidth_hz has 6.3 Hz for filter 'rate/2' at 12.5 Hz, above half"),
    (LSM, "  [6.25, 13,", "  [13,", "key values.bandwidth_hz needs one row for each of filters"),
    (LSM, '"rate/400", "rate/800"]', '"rate/400"]', "key values.bandwidth_hz needs one row for each of filters"),
    (LSM, '"rate/400", "rate/800"]', '"rate/400", "rate/2"]', "key values.filters has the same name twice"),
    (LSM, "  [6.25, 13, 26, 52, 104, 208, 416.5,", "  [6.25, 13, 26, 52, 104, 208, 0,",
     "key values.default_filter 'rate/2' does not exist at default_rate 833"),
    ("h3lis331dl", "[[25, 50, 200, 500]]", "[[0, 50, 200, 500]]", "0 at every filter for 50 Hz: leave the rate out"),
    ("bmi088", "[1, 3, 5, 10, 20, 40, 80, 145]", "[0, 0, 0, 0, 0, 0, 0, 0]", "0 at every rate for filter 'osr4'"),
    (LSM, "offset_limit_mg = [60, 60", "offset_limit_mg = [60, 19",
     "key values.offset_limit_mg is below values.offset_mg"),
    (LSM, "scale_tc_limit_percent = 0.021", "scale_tc_limit_percent = 0.006",
     "key values.scale_tc_limit_percent is below"),
    (BMP, "offset_limit_pa = 150", "offset_limit_pa = 49", "key values.offset_limit_pa is below values.offset_pa"),
    (BMP, "scale_limit = 9e-4", "scale_limit = 2e-4", "key values.scale_limit is below values.scale"),
    (BMP, "conversion_ms = 4.82", "conversion_ms = 5.01",
     "of mode 'x1/x1', 5.01 ms, is longer than the period of its rate, 5 ms"),
    (BMP, 'default_mode = "x1/x1"', 'default_mode = "x1"', "key values.default_mode: 'x1' is unknown; nearest: x"),
    (BMP, 'name = "x2/x1"', 'name = "x1/x1"', "key modes.name has the same name twice"),
    (BMP, "iir_weights = [1, 0.5, ", "iir_weights = [1, ", "key values.iir_weights needs one entry for each"),
    (BMP, "iir_coefficients = [0, 2", "iir_coefficients = [1, 2", "key values.iir_coefficients must begin with 0"),
    (BMP, "iir_weights = [1, 0.5", "iir_weights = [0.9, 0.5", "key values.iir_coefficients must begin with 0"),
    (BMP, "solder_pa = [-80, 80]", "solder_pa = [80, -80]", "key values.solder_pa must have the least shift first"),
    (BMP, "reference_pressure_pa = 90000", "reference_pressure_pa = 9000", "reference_pressure_pa is outside range_pa"),
    # not a file of this kind at all
    (LSM, "\n[values]", "\n[values", "at line"),
]  # fmt: skip


@pytest.mark.parametrize(("base", "old", "new", "message"), BROKEN, ids=range(len(BROKEN)))
def test_a_broken_file_is_an_error_that_names_file_and_key(tmp_path, base, old, new, message):
    text = (catalogue.FOLDER / f"{base}.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "part.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ValueError, match=r"^part\.toml: ") as caught:
        catalogue.read(path)
    told = str(caught.value)
    assert message in told
    assert "\n" not in told
    assert len(told) < 1500


def test_every_key_is_checked_for_its_sign():
    """Each number set to -1, one at a time, is refused by its key; only the solder shift may be negative."""
    for name in ("lsm6dso32", "bmp390"):
        file = sheet(name)
        for key in file["values"]:
            if key == "solder_pa" or isinstance(file["values"][key], str) or key == "filters":
                continue
            one = {**file, "values": {**file["values"], key: _negative(file["values"][key])}}
            with pytest.raises(ValueError, match=rf"^key values\.{key}\b.* is -"):
                datasheet_check.check(one)


def _negative(value):
    return [_negative(entry) for entry in value] if isinstance(value, list) else -1


def test_a_file_without_tables_is_refused():
    for one, message in (
        ({}, "key kind is missing"),
        ({**sheet("bmp390"), "values": 3}, "key values must be a table, not a number"),
        ({**sheet("bmp390"), "sources": []}, "key sources must be a table, not a list"),
        ({**sheet("bmp390"), "modes": []}, "key modes is an empty list"),
        ({**sheet("bmp390"), "modes": [4]}, r"key modes\[0\] must be a table, not a number"),
        ({**sheet("bmp390"), "modes": {}}, "key modes must be a list, not a table"),
    ):
        with pytest.raises(ValueError, match=message):
            datasheet_check.check(one)


# -- a user's own part -----------------------------------------------------------------------------------------------


def test_a_users_own_file_is_read_by_the_same_code(tmp_path, monkeypatch):
    text = (catalogue.FOLDER / "lsm6dso32.toml").read_text(encoding="utf-8")
    (tmp_path / "my-part.toml").write_text(text.replace("[[120, 120, 120]", "[[12, 12, 12]"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for name in ("my-part.toml", f".{os.sep}my-part.toml", str(tmp_path / "my-part.toml")):
        part = AccelerometerSettings(preset=name, range_g=4).description()
        assert part.name == "my-part"
        assert part.noise_density == pytest.approx([12e-6 * G0] * 3)
    with pytest.raises(ValueError, match="is an accelerometer, not a pressure sensor"):
        PressureSettings(preset="my-part.toml").description()


def test_a_users_own_file_is_read_anew_when_it_has_changed(tmp_path):
    path = tmp_path / "own.toml"
    text = (catalogue.FOLDER / "bmp390.toml").read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    assert preset(str(path)).offset_sd == 50
    path.write_text(text.replace("offset_pa = 50", "offset_pa = 60"), encoding="utf-8")
    assert preset(str(path)).offset_sd == 60


def test_the_same_text_is_described_once():
    assert preset("bmp390") is preset("bmp390")


@pytest.mark.parametrize("name", ["none.toml", "no/such/part", "no/such/part.toml", "./", "a\0b.toml"])
def test_a_file_that_is_not_there_is_one_line(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=r"is unknown: there is no such file$") as caught:
        preset(name)
    assert repr(name) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_name_too_long_for_the_system_is_one_line():
    with pytest.raises(ValueError, match=r"^preset '.{,60}' is unknown: there is no such file$"):
        preset("x" * 300 + ".toml")


def test_files_that_are_no_text_or_no_toml_are_one_line(tmp_path):
    path = tmp_path / "odd.toml"
    for content, message in (
        (b"\xff\xfe", "is not text in UTF-8"),
        (b"a = ", "Invalid value"),
        (b"", "key kind is missing"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"^odd\.toml: .*{message}") as caught:
            preset(str(path))
        assert "\n" not in str(caught.value)


# -- in a scenario ---------------------------------------------------------------------------------------------------


def test_noise_scale_is_part_of_the_description():
    """An assumption about the part: three times the noise is nine times the filter's variance."""
    settings = AirDataSettings(total=PressureSettings(noise_scale=3.0), static=PressureSettings(iir=2))
    head = known_of_head(settings)
    assert head.total.noise_sd == pytest.approx(3 * 3.7)
    assert head.static.noise_sd == pytest.approx(3.7 * (1 / 3) ** 0.5)  # a/(2 - a) of the variance at a = 1/2
    offset = settings.static.description().temperature_offset_sd
    assert head.temperature_sd**2 - offset**2 == pytest.approx(0.005**2 / 3, rel=1e-6)


def test_settings_are_checked_against_their_bounds():
    """By pydantic, as whoever reads a scenario does."""
    adapter = TypeAdapter(AirDataSettings)
    assert adapter.validate_python({"total": {"preset": "bmp581", "mode": "x1/x1"}, "rate": 50}).total.mode == "x1/x1"
    for wrong in ({"rate": 0.0}, {"tare": "shut"}, {"static": {"noise_scale": -1.0}}):
        with pytest.raises(ValidationError):
            adapter.validate_python(wrong)
    assert TypeAdapter(AccelerometerSettings).validate_python({"bias": [1.0, 2.0, 3.0]}).bias == (1.0, 2.0, 3.0)


def test_import_is_light():
    """Neither pandas nor scipy nor anything of uavsim for a unit in the loop."""
    code = (
        "import sys, sensors\n"
        "assert not any(name.startswith('sensors.') for name in sys.modules)\n"
        "head = sensors.AirDataHead(sensors.AirDataSettings(), sensors.Streams(1))\n"
        "device = sensors.Accelerometer(sensors.preset('lsm6dso32'), sensors.Streams(1))\n"
        "device.step((0.0, (0.0, 0.0, 0.0)))\n"
        "heavy = {'pandas', 'scipy', 'pydantic', 'uavsim', 'jsbsim', 'matplotlib'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_public_names_are_there_and_others_are_not():
    for name in sensors.__all__:
        assert getattr(sensors, name) is not None
    assert dir(sensors) == sorted(sensors.__all__)
    with pytest.raises(AttributeError, match="gyroscope"):
        _ = sensors.gyroscope


def test_a_part_may_average_over_its_output_interval(tmp_path):
    """poles = 0: of a force that steps, the reading of the interval of the step lies between the two."""
    text = (catalogue.FOLDER / "lsm6dso32.toml").read_text(encoding="utf-8")
    assert "\npoles = 1\n" in text
    path = tmp_path / "mean.toml"
    path.write_text(text.replace("\npoles = 1\n", "\npoles = 0\n", 1), encoding="utf-8")
    part = preset(str(path)).select(rate=104)
    assert part.noise_sd == preset("lsm6dso32").select(rate=104).noise_sd
    device = Accelerometer(part.scaled(0.0), Streams(3), unit="ideal")
    readings = [r for k in range(200) for r in device.step((k * 1e-3, (10.0 if k > 100 else 0.0, 0.0, 0.0)))]
    between = [fx for _, fx, _, _ in readings if 0.1 < fx < 9.9]
    assert len(between) in (1, 2)
