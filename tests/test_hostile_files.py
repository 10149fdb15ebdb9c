"""Files of data that somebody spoiled or made to hurt: read in a line or refused in a line, flown or not at all.

Whatever is accepted flies: no exception, no warning of a library, finite readings. How fast a text is read is not
timed here; what decides it is counted: no text that passes has more marks, deeper brackets or longer names than those
whose reading was timed.
"""

import math
import random
import tomllib
import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from mutations import mutated, written

import uavsim
from sensors import Accelerometer, Streams, data_files, datasheet_check, presets
from sensors.accelerometer_description import AccelerometerDescription, AccelerometerErrors
from sensors.catalogue import preset, sheet
from sensors.choice import nearest
from sensors.data_files import check_shape, parse_json, parse_toml, read_text
from sensors.datasheet_bounds import ACCELEROMETER, MODE, PRESSURE
from sensors.datasheet_check import check
from sensors.pressure_description import PressureDescription
from sensors.unit import Unit
from uavsim import cli
from uavsim.cosim import Cosimulation
from uavsim.scenario import MOST_READINGS, Scenario, keys, load_scenario, packaged_names
from uavsim.settings import LARGEST_NUMBER, LONGEST_TEXT, MOST_ENTRIES, MOST_GROUPS, SMALLEST_NUMBER, hint_of
from uavsim.views import terminal

# -- the shape of a file ---------------------------------------------------------------------------------------------

N = 400_000
SHAPES = {
    "a key of many dots": ("a" + ".a" * 20_000 + " = 1", "a name of more than 10 parts"),
    "a key of dots and spaces": ("a" + " . a" * 20_000 + " = 1", "a name of more than 10 parts"),
    "a quoted key of many dots": ('"a"' + '."a"' * 20_000 + " = 1", "a name of more than 10 parts"),
    "a header of many dots": ("[a" + ".a" * 20_000 + "]", "a name of more than 10 parts"),
    "dots in an inline table": ("x = {a" + ".a" * 20_000 + " = 1}", "a name of more than 10 parts"),
    "a deep header and its keys": ("[a" + ".a" * 500 + "]\n" + "".join(f"k{i} = 1\n" for i in range(40_000)), "parts"),
    "many headers": ("".join(f"[a.b.c{i}]\n" for i in range(N // 13)), "more than 20000 keys and entries"),
    "many tables in a list": ("[[a]]\n" * (N // 6), "more than 20000 keys and entries"),
    "many keys": ("".join(f"k{i} = {i}\n" for i in range(N // 13)), "line 20001: more than 20000 keys and entries"),
    "many numbers": ("x = [" + "1," * (N // 2) + "]", "more than 20000 keys and entries"),
    "many inline tables": ("x = [" + "{}," * (N // 3) + "]", "more than 20000 keys and entries"),
    "deep lists": ("x = " + "[" * N, "brackets in brackets, more than 16"),
    "deep inline tables": ("x = " + "{a = " * (N // 5), "brackets in brackets, more than 16"),
    "a long key": ("a" * N + " = 1", "a name or number of more than 200 characters"),
    "a long quoted key": ('"' + "a" * N + '" = 1', "a text of more than 20000 characters"),
    "a long number": ("x = " + "9" * N, "a name or number of more than 200 characters"),
    "a long hexadecimal number": ("x = 0x" + "f" * N, "a name or number of more than 200 characters"),
    "a long text": ('x = "' + "a" * N + '"', "a text of more than 20000 characters"),
    "a long text of lines": ('x = """' + "\n" * N + '"""', "a text of more than 20000 characters"),
    "a large file": ("# " + "x" * data_files.LARGEST, "is larger than 1000000 characters"),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_what_a_parser_would_be_slow_at_never_reaches_it(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text, says = SHAPES[shape]

    def slow(_: str) -> None:
        raise AssertionError("the parser saw it")

    monkeypatch.setattr(tomllib, "loads", slow)
    with pytest.raises(ValueError, match=r".") as caught:
        parse_toml(text)
    assert says in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "[a.b.c.d.e.f.g.h.i.j]\nx = 1.5\ny = 2.5",
        'x = "' + ".a" * 9_000 + '"  # ' + "[" * 10_000,
        "x = '''" + "[" * 1000 + "'''",
        'x = """a""b\\"""" # "',
        '""""a"""" = 1',
        "x = [\n  [[[[1.5, 2.5], [3.5]]]], # [[[\n]",
        "# " + "[" * 900_000,
        "\n" * 900_000,
        "x = 'it''s",
        "'''" + "[" * 100,
    ],
)
def test_what_is_in_text_and_comments_does_not_count(text: str) -> None:
    check_shape(text)


@pytest.mark.parametrize("name", [*packaged_names(), *presets()])
def test_all_that_is_shipped_has_room_to_its_bounds(name: str) -> None:
    """A fifteenth of the marks, half of the depth."""
    text = tomli_w.dumps(load_scenario(name).to_dict() if name in packaged_names() else sheet(name))
    monkey = pytest.MonkeyPatch()
    with monkey.context() as bounds:
        bounds.setattr(data_files, "MARKS", data_files.MARKS // 15)
        bounds.setattr(data_files, "DEEPEST", data_files.DEEPEST // 2)
        check_shape(text)


TOKENS = st.sampled_from(
    ['"', '"""', "'", "'''", "\\", "#", "\n", "=", ".", ",", "[", "]", "{", "}", "a", "1.5", " ", "é"]
)


@settings(deadline=None, derandomize=True, max_examples=500)
@given(st.lists(TOKENS, max_size=30).map("".join))
def test_any_text_of_toml_is_read_as_tomllib_reads_it(text: str) -> None:
    """What passes is what the parser makes of it; nothing that the parser takes is refused for its quotes."""
    try:
        expected: Any = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        with pytest.raises(ValueError, match=r"not valid TOML|nested too deep"):
            parse_toml(text)
    else:
        assert parse_toml(text) == expected


def test_a_pipe_or_a_device_is_not_waited_for(tmp_path: Path) -> None:
    for file in (tmp_path, Path("/dev/zero")):
        with pytest.raises(ValueError, match="cannot be read: it is no regular file"):
            read_text(file)
    with pytest.raises(ValueError, match="cannot be read: No such file"):
        read_text(tmp_path / "nothing")


@pytest.mark.parametrize("text", ["[" * 100_000, "NaN", "[Infinity]", "1e400", "9" * 5000, "{", '{"a": 1}}'])
def test_json_that_is_none_is_one_line(text: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        parse_json(text)
    assert "\n" not in str(caught.value)


# -- numbers and lists of a scenario ---------------------------------------------------------------------------------


def refused(override: str) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match=r"^--set") as caught:
            load_scenario("catapult", overrides=[override])
    assert "\n" not in str(caught.value)
    return str(caught.value)


NUMBERS = [key for key in keys() if key not in {"name", "description", "aircraft.properties", "requirements"}]


@pytest.mark.parametrize("value", ["1e400", "-1e400", "nan", "1e308", "-1e308", "1" + "0" * 5000])
def test_no_key_takes_a_number_that_overflows(value: str) -> None:
    for key in [*NUMBERS, "aircraft.properties.inertia/pointmass-weight-lbs"]:
        refused(f"{key}={value}")


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("aircraft.properties.x=1e16", f"must be a number, 0 or from {SMALLEST_NUMBER:g} to {LARGEST_NUMBER:g} in"),
        ("aircraft.properties.x=1e-31", "in magnitude"),
        ('requirements=[{key="airspeed.rmse", maximum=inf}]', "requirements[0].maximum = inf: must be a number"),
        ('requirements=[{key="airspeed.rmse", minimum=nan}]', "requirements[0].minimum = nan: must be a number"),
        ("accelerometer.bias=[0, 0, 1e5]", "each a number from -10000 to 10000"),
        (
            "accelerometer.faults=[" + '{kind="stuck"},' * 101 + "]",
            f"has 101 entries; it must have {MOST_GROUPS} at most",
        ),
        ("requirements=[" + '{key="airspeed.rmse"},' * 101 + "]", f"it must have {MOST_GROUPS} at most"),
        ("plant.wind_tunnel.speeds=[" + "5," * 1001 + "]", f"has 1001 entries; it must have {MOST_ENTRIES} at most"),
        ("vibration.spectra=[{psd=[" + "[5,1]," * 1001 + "]}]", f"it must have {MOST_ENTRIES} at most"),
        ("vibration.tones=[{frequency_hz=50, amplitude_g=[0, 0, 1e4]}]", "each a number from -1000 to 1000"),
        ("description=" + "x" * 5000, f"must be text of at most {LONGEST_TEXT} characters"),
        ("duration=3600\naccelerometer.rate=6664", "must be a number"),
    ],
)
def test_what_is_too_much_says_how_much_there_may_be(override: str, says: str) -> None:
    assert says in refused(override)


def test_values_nested_in_python_are_held_to_the_same_depth() -> None:
    deep: Any = 1.0
    for _ in range(2000):
        deep = [deep]
    with pytest.raises(ValueError, match="is nested too deep"):
        Scenario.from_dict({"accelerometer": {"bias": deep}})


def test_a_flight_of_more_readings_than_a_computer_holds_is_refused() -> None:
    sets = ["accelerometer.rate=6664", "detector.threshold=20"]
    most = math.floor(MOST_READINGS / 6664)
    assert load_scenario("catapult", overrides=[*sets, f"duration={most}"]).duration == most
    with pytest.raises(
        ValueError, match=rf"duration = {most + 1}: accelerometer at 6664 Hz would give .*; {most} s can"
    ):
        load_scenario("catapult", overrides=[*sets, f"duration={most + 1}"])


def options() -> dict[str, list[str]]:
    """Options of all commands that are numbers with a fraction, found in their signatures."""
    found: dict[str, list[str]] = {}
    for command in cli.COMMANDS:
        for name, hint in get_type_hints(command, include_extras=True).items():
            kind, *rest = get_args(hint) or (hint,)
            if float in (kind, *get_args(kind)) and rest:
                said = [text for text in rest[0].param_decls or () if text.startswith("--")]
                found.setdefault(command.__name__, []).append((said or [f"--{name.replace('_', '-')}"])[0])
    return found


def test_every_option_that_is_a_number_refuses_what_is_none(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert options()["roc"] == ["--hours", "--sigma"]
    assert options()["sensors"] == ["--hours", "--range-g", "--rate", "--noise-scale"]
    for command, names in options().items():
        for name, value in product(names, ("nan", "inf", "-inf")):
            monkeypatch.setattr(
                "sys.argv", ["uavsim", command, *(["bmp390"] if command == "sensors" else []), name, value]
            )
            with pytest.raises(SystemExit) as caught:
                cli.main()
            said = capsys.readouterr()
            assert (caught.value.code, said.out) == (2, "")
            assert said.err.startswith(f"Error: Invalid value for '{name}'")


@pytest.mark.parametrize(
    ("given_", "known", "meant"),
    [
        ("launcher.peak", ["launcher.rise", "launcher.peak_specific_force_g"], "launcher.peak_specific_force_g"),
        (
            "launcher.specific_force",
            ["launcher.friction", "launcher.peak_specific_force_g"],
            "launcher.peak_specific_force_g",
        ),
        ("noise", ["voice", "noise_scale"], "noise_scale"),
        ("Duration", ["rotation", "duration"], "duration"),
        ("threshold_g", ["threshold", "threshold_window"], "threshold"),
        ("storke", ["stroke", "stoke_rate"], "stroke"),
        ("zzz", ["stroke"], None),
        ("", ["stroke"], None),
        ("x" * 100_000, ["stroke", "x" * 90], "x" * 90),
    ],
)
def test_the_nearest_name_begins_with_or_holds_what_was_given(given_: str, known: list[str], meant: str | None) -> None:
    assert nearest(given_, known) == meant


# -- presets ---------------------------------------------------------------------------------------------------------


def test_all_missing_and_unknown_keys_are_named_in_one_line() -> None:
    part = sheet("bmp390")
    del part["document"], part["values"]["range_pa"], part["values"]["scale"], part["modes"][1]["rate"]
    del part["sources"]["offset_pa"], part["sources"]["modes.rate"]
    part["values"]["offzet_tc_pa"] = part["values"].pop("offset_tc_pa")
    with pytest.raises(ValueError, match=r".") as caught:
        check(part)
    assert str(caught.value) == (
        "keys document, values.range_pa, values.offset_tc_pa, values.scale, modes.rate (mode 2), sources.offset_pa, "
        "sources.modes.rate are missing: every number needs its source; "
        "key 'values.offzet_tc_pa' is unknown; nearest: values.offset_tc_pa"
    )


def test_of_many_unknown_keys_a_few_are_looked_up_and_the_others_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    looked_up: list[str] = []

    def counted(given_: str, known: Any, cutoff: float) -> str:
        looked_up.append(given_)
        return "x"

    monkeypatch.setattr(datasheet_check, "nearest", counted)
    part = sheet("bmp390")
    part["values"] |= {f"k{i}": 1 for i in range(5000)}
    with pytest.raises(ValueError, match=r"'values.k2' is unknown; nearest: values.x; 4997 more keys are unknown$"):
        check(part)
    assert looked_up == ["k0", "k1", "k2"]


NONSENSE = [
    ("adxl345", "rates", 1e9), ("adxl345", "rates", 1e-6), ("adxl345", "noise_density_ug", 1e15),
    ("adxl345", "noise_density_ug", -1.0), ("adxl345", "noise_density_ug", math.nan), ("adxl345", "ranges_g", 1e-3),
    ("adxl345", "ranges_g", 1e9), ("adxl345", "bits", 64), ("adxl345", "poles", 5), ("adxl345", "bandwidth_hz", 1e6),
    ("adxl345", "offset_limit_mg", 1e6), ("adxl345", "offset_tc_limit_mg", 5000.0), ("adxl345", "scale_percent", 90.0),
    ("adxl345", "scale_tc_percent", 5.0), ("adxl345", "correlation_time", 1e300), ("adxl345", "rate_limit_percent", 90),
    ("adxl345", "correlation_time", 1e-12),
    ("bmp390", "range_pa", 1e-3), ("bmp390", "solder_pa", 1e9), ("bmp390", "offset_tc_pa", 1e5),
    ("bmp390", "iir_weights", 1e-12), ("bmp390", "drift_pa", 1e12), ("bmp390", "acceleration_limit_pa", 1e9),
    ("bmp390", "modes.rate", 1e9), ("bmp390", "modes.conversion_ms", 1e-9), ("bmp390", "modes.noise_pa", 1e15),
    ("bmp390", "modes.resolution_pa", 1e-300), ("bmp390", "temperature_offset_limit_k", 1e4),
]  # fmt: skip


@pytest.mark.parametrize(("name", "key", "value"), NONSENSE)
def test_nonsense_is_refused_by_its_key(name: str, key: str, value: float) -> None:
    part = sheet(name)
    for group in part["modes"] if key.startswith("modes.") else [part["values"]]:
        last = key.removeprefix("modes.")
        group[last] = everywhere(group[last], value)
    with pytest.raises(ValueError, match=key.removeprefix("modes.")):
        check(part)


def everywhere(found: Any, value: Any) -> Any:
    return [everywhere(entry, value) for entry in found] if isinstance(found, list) else value


@pytest.mark.parametrize(
    ("name", "change", "says"),
    [
        ("bmp390", {"range_pa": [0, 50_000], "reference_pressure_pa": 1}, "does not hold 101325 Pa"),
        ("bmp390", {"range_pa": [200_000, 10_000_000], "reference_pressure_pa": 200_000}, "does not hold 101325 Pa"),
        ("bmp390", {"range_pa": [101_324, 101_326], "reference_pressure_pa": 101_325}, "is wider than range_pa"),
        ("adxl345", {"offset_limit_mg": [17_000] * 3}, "is beyond the range, 16000 mg"),
        ("adxl345", {"offset_tc_limit_mg": [161] * 3}, "over 100 K, is beyond the range, 16000 mg"),
        ("adxl345", {"filters": ["f"] * 101}, "is a list of 101; it must be one of 100 at most"),
        ("adxl345", {"default_filter": "f" * 101}, "has 101 characters; it must have 100 at most"),
    ],
)
def test_what_does_not_fit_together_is_refused(name: str, change: dict[str, Any], says: str) -> None:
    part = sheet(name)
    part["values"] |= change
    with pytest.raises(ValueError, match=says):
        check(part)


def test_every_number_of_a_preset_has_an_upper_bound() -> None:
    """Each number set to 9e14, which is finite, is refused by its key."""
    for name, rules in (("adxl345", ACCELEROMETER), ("bmp390", PRESSURE)):
        for key in rules:
            part = sheet(name)
            if "filter" in key or key == "default_mode":
                continue
            part["values"][key] = everywhere(part["values"][key], 900_000_000_000_000)
            with pytest.raises(ValueError, match=rf"key values\.{key}\b"):
                check(part)
    for key in set(MODE) - {"name"}:
        part = sheet("bmp390")
        part["modes"][0][key] = 9e14
        with pytest.raises(ValueError, match=rf"key modes\.{key}\b"):
            check(part)


@pytest.mark.parametrize("unit", ["random", "typical", "ideal"])
def test_whatever_factor_is_on_a_clock_it_runs_forwards_and_no_more_than_half_too_fast(unit: Unit) -> None:
    part = preset("mpu-6050")
    assert isinstance(part, AccelerometerDescription)
    worst = replace(part, rate_sd=0.5, rate_limit=0.5).scaled(1.0, AccelerometerErrors(clock=1000.0))
    for seed in range(20):
        assert abs(Accelerometer(worst, Streams(seed), unit=unit).rate_error) <= 0.5


@pytest.mark.parametrize("weight", [0.5, 0.8284, 0.83, 0.9, 0.9999, 1.0])
def test_a_filter_that_is_nowhere_3_db_down_leaves_the_conversions_bandwidth(weight: float) -> None:
    """y += a (x - y) is 3 dB down at half the rate for a = 2 (√2 - 1) = 0.8284, and for none above."""
    part = preset("bmp390")
    assert isinstance(part, PressureDescription)
    filtered = replace(part, iir_weights=((0, 1.0), (2, weight))).select(iir=2)
    expected = 0.4429 / part.mode.conversion_time
    assert (filtered.bandwidth == pytest.approx(expected)) is (weight > 0.8284)


SHORT = ("duration=3.5", "launcher.wait_min=2", "launcher.wait_max=2.1", "requirements=[]", "expect=timeout")


def one_line(read: Callable[[], Any], begins: str) -> Any:
    """Return what was read, or None if it was refused in one line that begins so."""
    try:
        return read()
    except ValueError as error:
        line = str(error)
    assert line.startswith(begins)
    assert "\n" not in line
    return None


def settings_of(file: Path, draw: random.Random) -> list[str]:
    """Choose a preset of one's own at one of its settings."""
    part = preset(str(file))
    if isinstance(part, AccelerometerDescription):
        low_pass = tomli_w.dumps({"f": draw.choice(part.filters)}).removeprefix("f = ")
        chosen = {"range_g": draw.choice(part.ranges_g), "rate": draw.choice(part.rates), "preset": file}
        chosen |= {"filter": low_pass} if draw.random() < 0.5 else {}
        return [*(f"accelerometer.{key}={value}" for key, value in chosen.items()), "detector.threshold=15"]
    mode = tomli_w.dumps({"m": draw.choice(part.modes).name}).removeprefix("m = ")
    chosen = {"mode": mode, "iir": draw.choice(part.iir_weights)[0], "preset": file}
    return [f"air_data.{port}.{key}={value}" for port in ("total", "static") for key, value in chosen.items()]


def spoiled_preset(seed: int, tmp_path: Path) -> bool:
    """Spoil a shipped preset, and fly it for a moment if it is accepted; tell whether it was.

    A setting that the part does not have, or that the detector cannot use, is refused in a line.
    """
    draw = random.Random(seed)
    tree = mutated(draw, sheet(draw.choice(presets())), draw.choice((1, 1, 2)))
    file = tmp_path / "part.toml"
    file.write_text(written(draw, tree), encoding="utf-8")
    if one_line(lambda: preset(str(file)), "part.toml: ") is None:
        return False
    unit = draw.choice(("random", "typical", "ideal"))
    units = [f"{sensor}.unit={unit}" for sensor in ("accelerometer", "air_data.total", "air_data.static")]
    overrides = [*SHORT, *settings_of(file, draw), *units]
    scenario = one_line(lambda: load_scenario("catapult", overrides=overrides), "--set: ")
    if scenario is not None:
        flight = uavsim.fly(scenario)
        assert np.isfinite(flight.accelerometer.to_numpy()).all()
        assert np.isfinite(flight.truth.drop(columns="phase").to_numpy(dtype=float)).all()
    return True


def test_spoiled_presets_are_refused_in_a_line_or_fly(tmp_path: Path) -> None:
    accepted = sum(spoiled_preset(seed, tmp_path) for seed in range(60))
    assert 5 <= accepted <= 40  # both happen


@pytest.mark.slow
def test_300_spoiled_presets_are_refused_in_a_line_or_fly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    accepted = sum(spoiled_preset(seed, tmp_path) for seed in range(1000, 1300))
    with capsys.disabled():
        print(f"\n{accepted} of 300 spoiled presets were accepted, and flew")  # noqa: T201
    assert 25 <= accepted <= 200


# -- scenarios -------------------------------------------------------------------------------------------------------


def at_its_bounds(draw: random.Random, tree: dict[str, Any]) -> None:
    """Put some settings at a bound of theirs, or next to it."""
    for key in draw.sample(BOUNDED, draw.choice((0, 1, 3, 6))):
        bound = get_args(hint_of(Scenario, key))[1]
        low = next(v for v in (getattr(bound, "ge", None), getattr(bound, "gt", None), 0.0) if v is not None)
        high = next(v for v in (getattr(bound, "le", None), getattr(bound, "lt", None), 1e15) if v is not None)
        value = draw.choice((low, high, low + 1e-9 * (high - low), high - 1e-9 * (high - low), SMALLEST_NUMBER))
        *groups, last = key.split(".")
        group: Any = tree
        for name in groups:
            group = group.get(name) if isinstance(group, dict) else None
        if isinstance(group, dict):
            group[last] = value


def with_faults(draw: random.Random, tree: dict[str, Any]) -> None:
    """Break sensors and ports, at times in more ways than there may be."""
    count = draw.choice((1, 3, 30, 1000))
    start = draw.uniform(0.0, 4.0)
    when = {"start": start, "stop": start + draw.choice((1e-6, 0.5, 3000.0))}
    sensor = {
        "kind": draw.choice(("dropout", "invalid", "stuck", "spike", "offset")),
        "size": draw.choice((0, 1, 1e6, -1e6)),
    }
    port = {"kind": draw.choice(("blocked", "leak", "ice", "water")), "duration": draw.choice((1e-30, 1, 3600))}
    for keys_, fault in (
        (("accelerometer",), sensor),
        (("air_data", "total"), sensor),
        (("air_data", "static_port"), port),
    ):
        group: Any = tree
        for key in keys_:
            group = group.get(key) if isinstance(group, dict) else None
        if isinstance(group, dict) and draw.random() < 0.5:
            group["faults"] = [{**when, **fault}] * count


BOUNDED = sorted(
    key
    for key in keys()
    if get_origin(hint_of(Scenario, key)) is Annotated and get_args(hint_of(Scenario, key))[0] in (int, float)
    and key != "duration"
)  # fmt: skip
LONGEST_RUN = 20.0  # s


def spoiled_scenario(seed: int, tmp_path: Path) -> bool:
    """Spoil a packaged scenario, and fly it for a moment if it is accepted; tell whether it was."""
    draw = random.Random(seed)
    tree = mutated(draw, load_scenario(draw.choice(packaged_names())).to_dict(), draw.choice((0, 1, 1, 2)))
    at_its_bounds(draw, tree)
    if draw.random() < 0.3:
        with_faults(draw, tree)
    file = tmp_path / "spoiled.toml"
    file.write_text(written(draw, tree) if draw.random() < 0.3 else tomli_w.dumps(tree), encoding="utf-8")
    scenario = one_line(lambda: load_scenario(file), f"{file}: ")
    if scenario is None:
        return False
    duration = scenario.launcher.wait_max + max(scenario.plant.length, 1.5)
    if duration <= LONGEST_RUN:
        short = replace(scenario, duration=duration)
        simulation = one_line(lambda: Cosimulation(short), "")  # only JSBSim knows whether it has a property
        while simulation is not None and not simulation.ended:
            simulation.advance(1000)
        if simulation is not None:
            terminal.print_score(simulation.finish())
    return True


def test_spoiled_scenarios_are_refused_in_a_line_or_fly(tmp_path: Path) -> None:
    accepted = sum(spoiled_scenario(seed, tmp_path) for seed in range(20))
    assert 3 <= accepted <= 17


@pytest.mark.slow
def test_100_spoiled_scenarios_are_refused_in_a_line_or_fly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    accepted = sum(spoiled_scenario(seed, tmp_path) for seed in range(1000, 1100))
    with capsys.disabled():
        print(f"\n{accepted} of 100 spoiled scenarios were accepted, and flew")  # noqa: T201
    assert 15 <= accepted <= 80
