"""The shipped parts against their datasheets, typed again here from notes on the documents and not from our files."""

import subprocess
import sys
from dataclasses import FrozenInstanceError

import pytest
from pydantic import TypeAdapter, ValidationError

import sensors
from sensors import AccelerometerSettings, AirDataSettings, PressureSettings, catalogue, head_noise, preset

G0 = 9.80665

# part, range g, noise density x, y, z µg/√Hz, least significant bit mg: LSM6DSO32 DocID032891 r1, ADXL345 Rev. E
ACCELEROMETERS = [
    ("lsm6dso32", 4, (120, 120, 120), 0.122),
    ("lsm6dso32", 8, (130, 130, 130), 0.244),
    ("lsm6dso32", 16, (160, 160, 160), 0.488),
    ("lsm6dso32", 32, (220, 220, 220), 0.976),
    ("adxl345", 2, (290, 290, 430), 3.9),
    ("adxl345", 4, (290, 290, 430), 3.9),
    ("adxl345", 8, (290, 290, 430), 3.9),
    ("adxl345", 16, (290, 290, 430), 3.9),
]

# part, mode, noise Pa rms, conversion ms, rate Hz: BMP390 DS002 r1.7 table 8 and 3.9; BMP581 DS003 r1.9 table 9
PRESSURE_MODES = [
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
]


def test_all_shipped_parts_are_listed_and_read():
    assert {"adxl345", "bmp390", "bmp581", "lsm6dso32"} <= set(sensors.presets())
    for name in sensors.presets():
        assert preset(name).name == name


@pytest.mark.parametrize(("name", "range_g", "density_ug", "lsb_mg"), ACCELEROMETERS)
def test_accelerometer_at_each_range(name, range_g, density_ug, lsb_mg):
    part = preset(name).select(range_g=range_g)
    assert part.range == pytest.approx(range_g * G0)
    assert part.noise_density == pytest.approx([n * 1e-6 * G0 for n in density_ug])
    assert part.resolution == pytest.approx(lsb_mg * 1e-3 * G0, rel=2e-3)  # the datasheets round it


@pytest.mark.parametrize(
    ("name", "range_g", "rate", "offset_mg", "scale_percent"),
    [("lsm6dso32", 32, 833, (20, 20, 20), 0.5), ("adxl345", 16, 800, (35, 35, 40), 1.0)],
)
def test_accelerometer_defaults_offset_and_scale(name, range_g, rate, offset_mg, scale_percent):
    part = preset(name)
    assert (part.range_g, part.rate, part.bandwidth) == (range_g, rate, rate / 2)
    assert part.bias_sd == pytest.approx([mg * 1e-3 * G0 for mg in offset_mg])
    assert part.scale_sd == pytest.approx(scale_percent / 100)


def test_adxl345_limits_and_noise_law():
    """Rev. E: 0 g output ±150, ±250 mg; 230 to 282 LSB/g; noise constant below 100 Hz, √2 a doubling above."""
    part = preset("adxl345")
    assert part.bias_limit == pytest.approx([0.150 * G0, 0.150 * G0, 0.250 * G0])
    assert part.scale_limit == pytest.approx(0.10, abs=0.002)
    at = {rate: part.select(rate=rate).noise_sd[0] for rate in (12.5, 100, 200, 400)}
    assert at[12.5] == at[100]
    assert at[400] / at[200] == pytest.approx(2**0.5)
    assert at[100] == pytest.approx(290e-6 * G0 * 50**0.5)


def test_lsm6dso32_rates():
    rates = preset("lsm6dso32").rates
    assert rates == (12.5, 26, 52, 104, 208, 416, 833, 1666, 3332, 6664)


@pytest.mark.parametrize(("name", "mode", "noise", "conversion_ms", "rate"), PRESSURE_MODES)
def test_pressure_sensor_in_each_mode(name, mode, noise, conversion_ms, rate):
    part = preset(name).select(mode=mode)
    assert part.noise_sd == pytest.approx(noise)
    assert part.mode.conversion_time == pytest.approx(conversion_ms / 1000)
    assert part.rate == rate
    assert part.mode.conversion_time < 1 / part.rate
    assert part.range == (30_000, 125_000)


@pytest.mark.parametrize(("name", "count"), [("bmp390", 6), ("bmp581", 8)])
def test_no_mode_is_missing_from_the_table(name, count):
    assert len(preset(name).modes) == count == sum(row[0] == name for row in PRESSURE_MODES)


def test_bmp390_rate_is_the_highest_that_holds_the_conversion():
    for mode in preset("bmp390").modes:
        allowed = [rate for rate in (200, 100, 50, 25, 12.5) if mode.conversion_time <= 1 / rate]
        assert mode.rate == max(allowed)


@pytest.mark.parametrize("mode", ["x1/x1", "x2/x1", "x4/x1", "x16/x2", "x32/x2"])
def test_bmp390_conversion_time_is_that_of_its_formula(mode):
    """T = 234 + (392 + 2020 osr_p) + (163 + 2020 osr_t) µs, to 0.3 %; at x8 the document prints 18.69 for 18.97 ms."""
    osr_p, osr_t = (int(part[1:]) for part in mode.split("/"))
    expected = (234 + 392 + 2020 * osr_p + 163 + 2020 * osr_t) * 1e-6
    assert preset("bmp390").select(mode=mode).mode.conversion_time == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize(
    ("coefficient", "printed"),
    [(1, 0.1147), (3, 0.0459), (7, 0.0212), (15, 0.01025), (31, 0.005041), (63, 0.00250), (127, 0.00125)],
)
def test_bmp581_filter_has_the_datasheets_bandwidth(coefficient, printed):
    """f(-3 dB)/rate as printed, within 0.5 %."""
    part = preset("bmp581").select(iir=coefficient)
    assert part.bandwidth / part.rate == pytest.approx(printed, rel=5e-3)


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
        (lambda: preset("lsm6dso32").select(rate=800), "833", "6664"),
        (lambda: preset("lsm6dso32").select(range_g=30), "32", "16"),
        (lambda: preset("bmp390").select(mode="x8/x2"), "x8/x1", "x32/x2"),
        (lambda: preset("bmp390").select(iir=3), "2", "128"),
        (lambda: AccelerometerSettings(preset="bmp390").description(), "pressure sensor", "adxl345, lsm6dso32"),
        (lambda: PressureSettings(preset="adxl345").description(), "accelerometer", "bmp390, bmp581"),
    ],
)
def test_unknown_choices_name_the_nearest_and_what_is_allowed(call, nearest, allowed):
    with pytest.raises(ValueError) as caught:  # noqa: PT011  # both parts of the message are checked
        call()
    message = str(caught.value)
    assert nearest in message
    assert allowed in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("bits = [16, 16, 16, 16]", "bitz = [16, 16, 16, 16]", "'values.bitz' is unknown; nearest: values.bits"),
        ("default_rate = 833\n", "", "default_rate is missing"),
        ('kind = "accelerometer"', 'kind = "gyroscope"', "kind 'gyroscope'"),
        ("default_rate = 833", "default_rate = 800", "rate 800.0 is unknown; nearest: 833"),
        ('part = "', 'pert = "', "'pert' is unknown; nearest: part"),
        ('drift_ug = "', 'drift_mg = "', "sources.drift_mg"),
        ("bits = [16, 16, 16, 16]", "bits = [16]", "bits needs one entry"),
        ("offset_mg = [20, 20, 20]", "offset_mg = [20, 20]", "part.toml"),
    ],
)  # fmt: skip
def test_a_broken_file_is_an_error_that_names_file_and_key(tmp_path, old, new, message):
    text = (catalogue.FOLDER / "lsm6dso32.toml").read_text()
    assert old in text
    path = tmp_path / "part.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=r"part\.toml") as caught:
        catalogue.read(path)
    assert message in str(caught.value)


def test_noise_scale_is_part_of_the_description():
    """An assumption about the part: three times the noise is nine times the filter's variance."""
    settings = AirDataSettings(total=PressureSettings(noise_scale=3.0), static=PressureSettings(iir=2))
    total, static, temperature = head_noise(settings)
    assert total == pytest.approx(3 * 3.7)
    assert static == pytest.approx(3.7 * (1 / 3) ** 0.5)  # a/(2 - a) of the variance at a = 1/2
    assert temperature == pytest.approx(0.005 * (1 / 3) ** 0.5)


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
