"""Scenarios as files and command lines give them: what is right is read as it stands, what is wrong becomes one line.

Property tests draw from the grammar of TOML values and from the settings' own declared bounds.
"""

import copy
import datetime
import errno
import os
import re
import shutil
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

import numpy as np
import pytest
import tomli_w
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import uavsim
from sensors import presets
from uavsim.flight import Flight, write_toml
from uavsim.plants.hangar import hangar
from uavsim.scenario import PACKAGED, Scenario, keys, load_scenario, packaged, packaged_names
from uavsim.score_keys import NUMBERS
from uavsim.settings import SMALLEST_NUMBER, hint_of
from uavsim.studies.batch import fly_seeds

KEYS = keys()


def complaint(values: Mapping[str, Any] | None = None, *, file: Path | str = "catapult", sets: Any = ()) -> str:
    """The one line that wrong settings give."""
    overrides = [sets] if isinstance(sets, str) else sets
    read = partial(load_scenario, file, overrides=overrides) if values is None else partial(Scenario.from_dict, values)
    with pytest.raises(ValueError, match=r".") as caught:
        read()
    line = str(caught.value)
    assert len(line.splitlines()) == 1
    assert "Error" not in line
    return line


# -- what is wrong, and what the line says --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("launcher.storke=3", "--set: unknown key 'launcher.storke'; did you mean 'launcher.stroke'?"),
        ("storke=3", "did you mean 'launcher.stroke'?"),
        ("detector.rate=100", "did you mean 'detector.ratio'?"),
        ("sensor.vibration_scale=3", "did you mean 'accelerometer.vibration_scale'?"),
        ("duratoin=3", "did you mean 'duration'?"),
        ("zzzzz=1", "there are name, description, duration"),
        ("launcher=3", "--set: launcher is a group; its keys are kind, peak_specific_force_g, rise"),
        ("launcher", "--set 'launcher': give it as KEY=VALUE"),
        ("", "--set '': give it as KEY=VALUE"),
        ("=3", "--set '=3': give it as KEY=VALUE"),
        ("  =3", "give it as KEY=VALUE"),
        ("launcher.stroke=", "--set: launcher.stroke = '': must be a number from 0.6 to 50"),
        ("launcher.stroke=abc", "= 'abc': must be a number from 0.6 to 50"),
        ("launcher.stroke=-1", "= -1: must be a number from 0.6 to 50"),
        ("launcher.stroke=nan", "= nan: must be a number from 0.6 to 50"),
        ("launcher.stroke=-inf", "= -inf: must be a number from 0.6 to 50"),
        ("launcher.stroke=true", "= True: must be a number from 0.6 to 50"),
        ('launcher.stroke="3"', "= '3': must be a number from 0.6 to 50"),
        ("launcher.stroke=[3]", "= [3]: must be a number from 0.6 to 50"),
        ("launcher.stroke={a=3}", "= {'a': 3}: must be a number from 0.6 to 50"),
        ("launcher.stroke=1979-05-27", "must be a number from 0.6 to 50"),
        ("launcher.stroke=3\nseed=4", "must be a number from 0.6 to 50"),
        ("detector.levels=1.5", "must be a whole number from 1 to 100"),
        ("detector.rearm=1", "must be true or false"),
        ("seed=-1", "must be a whole number from 0 to 9223372036854775807"),
        ("seed=9223372036854775808", "must be a whole number from 0 to 9223372036854775807"),
        ("seed=" + "9" * 5000, "must be a whole number"),
        ("seed=0x" + "f" * 5000, "must be a whole number"),
        ("seed=" + "[" * 50_000, "must be a whole number"),
        ("expect=cruse", "must be 'cruise', 'missed_launch'"),
        ("expect=cruse", "did you mean 'cruise'?"),
        ("air_data.tare=cover", "must be 'covered', 'open' or 'none'; did you mean 'covered'?"),
        ("detector.axes=[]", "(at least 1) or 'any'"),
        ("detector.axes=['x']", "must be a list, each '+x'"),
        ("vibration.band_hz=[1]", "must be a list of 2, each a number above 0"),
        ("vibration.band_hz=[200, 5]", "vibration.band_hz = [200, 5]: must be a band, low first"),
        ("accelerometer.bias=[1, 2]", "must be a number from -10000 to 10000 or a list of 3, each a number from"),
        ("accelerometer.preset=adxl34", "--set: accelerometer.preset: preset 'adxl34' is unknown; nearest: adxl345"),
        ("accelerometer.preset=bmp390", "is a pressure sensor, not an accelerometer"),
        ("air_data.total.preset=adxl345", "--set: air_data.total: preset 'adxl345' is an accelerometer"),
        ("air_data.static.mode=x5/x5", "--set: air_data.static: bmp390: mode 'x5/x5' is unknown; nearest:"),
        ("accelerometer.rate=1001", "rate 1001.0 is unknown; nearest: 833; allowed: 12.5, 26"),
        ("accelerometer.range_g=17", "range_g 17.0 is unknown; nearest: 16; allowed: 4, 8, 16, 32"),
        ("detector.trigger=20", "detector.trigger: is not read by kind = 'adaptive-cusum'"),
        ("detector.threshold=400", "±32 g can never be sure to show it"),
        ("accelerometer.range_g=4", "--set: detector.threshold = 45.11 m/s²: lsm6dso32 at ±4 g can never"),
        ("air_data.port_faults=[{kind='ice',start=9,stop=4}]", "air_data.port_faults[0].stop = 4: must be after its"),
        (
            "air_data.total_port.faults=[{kind='ice',between_heights=[90,40]}]",
            "air_data.total_port.faults[0].between_heights = [90, 40]: must be a band, low first",
        ),
        ("air_data.total_port.faults=[{kind='ice',below_temperature=-5}]", "must be a number from 150 to 400"),
        ("air_data.thermometer_faults=[{kind='ded'}]", "'stuck', 'dead', 'spike' or 'offset'; did you mean 'dead'?"),
        ("air_data.batch=1.2", "air_data.batch = 1.2: must be a number from 0 to 1"),
        ("plant.flight_path.legs=[{bank_deg=90}]", "must be a number from -75 to 75"),
        ("launcher.wait_max=1.7", "launcher.wait_max = 1.7: must be at least wait_min = 2 s"),
        ("launcher.wait_max=40", "duration = 35: must be longer than the longest wait"),
        (
            "plant.step_rate=500",
            "plant.step_rate = 500: the springs of the rail (40 Hz, damping 0.7) do not survive it; must be one of "
            "1000, 2000, 4000, 8000 Hz",
        ),
        ("plant.step_rate=0", "plant.step_rate = 0: the springs of the rail"),
        ("plant.step_rate=3000", "plant.step_rate = 3000: must be one of 1000, 2000, 4000, 8000 Hz"),
        ("plant.step_rate=16000", "plant.step_rate = 16000: must be one of"),
        ("plant.step_rate=1000.5", "plant.step_rate = 1000.5: must be a whole number"),
        ("air_data.tare_duration=5", "must fit into the shortest wait, launcher.wait_min = 2 s"),
        ("air_data.cover_off=1.5", "air_data.tare_duration = 1 and cover_off = 1.5 s: must fit"),
        ("aircraft.model=fw9", "--set: aircraft.model: unknown aircraft 'fw9'; did you mean 'fw8'?"),
        ("aircraft.model=", "unknown aircraft ''"),
        ("aircraft.model=~nobody-of-that-name/x", "unknown aircraft"),
        ("aircraft.model=" + "x" * 4000, "unknown aircraft"),
        ("aircraft.model=" + "x" * 5000, "must be text of at most 4096 characters"),
        ("aircraft.properties=1", "must be a group of NAME = number"),
        ("aircraft.properties.inertia/cg-x-in=abc", "aircraft.properties.inertia/cg-x-in = 'abc': must be a number"),
        (
            "aircraft.properties.simulation/terminate=1",
            "is JSBSim's own, not a property of an aircraft; it may not set simulation/…",
        ),
        ("name=../../evil", "name = '../../evil': it names a folder"),
        ("name=", "name = '': it names a folder"),
        ("name=.hidden", "it names a folder"),
        ("name=" + "n" * 101, "it names a folder"),
        ("name=a\u3164b", "it names a folder"),
        (
            "vibration.spectra=[{psd=[[5, 0]]}]",
            "each a list of a number above 0 and below 500 and a number above 0 and of",
        ),
        ("name=\udcff", "must be text"),
        ("requirements=3", "must be a list, each a group of key, statistic, equals, minimum"),
        ('requirements=[{key="airspeed.rmse", maximun=1}]', "unknown key 'maximun' in requirements[0]"),
        ('requirements=[{key="airspeed.rmse", maximun=1}]', "did you mean 'maximum'?"),
        ("requirements=[{maximum=1}]", "requirements[0]: key is missing"),
        ('requirements=[{key="airspeed.rmse", maximum="1"}]', "requirements[0].maximum = '1': must be a number"),
        ('requirements=[{key="airspeed.rsme", maximum=1}]', "is no number of the score; did you mean 'airspeed.rmse'?"),
        ('requirements=[{key="airspeed.stroke", maximum=1}]', "is no number of the score"),
        ('requirements=[{key="outcome", maximum=1}]', "is no number of the score"),
        ('requirements=[{key="airspeed.rmse", minimum=2, maximum=1}]', "minimum is above maximum"),
    ],
)
def test_a_wrong_override_is_one_line_that_says_what_is_allowed(given: str, says: str) -> None:
    line = complaint(sets=given)
    assert says in line
    assert line.startswith("--set")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"\x00\xff\x01", "is not text in UTF-8"),
        (b"duration = = 3\n", "not valid TOML: Invalid value (at line 1"),
        (b"duration = 3\nduration = 4\n", "not valid TOML"),
        (b"x = " + b"[" * 100_000, "nested too deep"),
        (b"seed = " + b"9" * 5000, "line 1: a name or number of more than 200 characters"),
        (b" " * 2_000_000, "is larger than 1000000 bytes"),
        (b"launcher = 3\n", "launcher = 3: must be a group of keys, not a value"),
        (b"[[launcher]]\nstroke = 3\n", "must be a group of keys"),
        (b"[duration]\nx = 3\n", "duration = {'x': 3}: must be a number from 1 to 3600"),
        (b"[launcher]\nstroke = nan\n", "launcher.stroke = nan: must be a number from 0.6 to 50"),
        (b'"" = 3\n', "unknown key ''"),
        (b'"a\\nb" = 3\n', "unknown key 'a\\nb'"),
        (b"[aircraft.properties.inertia]\nx = 1\n", "aircraft.properties.inertia = {'x': 1}: must be a number"),
        (b"name = 3\n", "name = 3: must be text"),
    ],
    ids=range(14),
)
def test_a_wrong_file_is_one_line_that_names_it(tmp_path: Path, content: bytes, says: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(content)
    line = complaint(file=file)
    assert line.startswith(f"{file}: ")
    assert says in line


@pytest.mark.parametrize(
    ("source", "says"),
    [
        (
            "catapalt",
            "unknown scenario 'catapalt'; did you mean 'catapult'? packaged: blocked-pitot, bungee, catapult, ",
        ),
        ("", "unknown scenario ''"),
        ("no/such/file", "no/such/file: there is no such file"),
        ("nothing.toml", "nothing.toml: there is no such file"),
        ("/", "this folder holds no scenario.toml"),
        ("~nobody-of-that-name/x.toml", "there is no such file"),
        ("x" * 5000, "unknown scenario"),
        ("a\0b", "unknown scenario"),
    ],
)
def test_a_scenario_that_is_not_there(source: str, says: str) -> None:
    assert says in complaint(file=source)


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As anybody but root, who may read everything, would see it."""
    file = tmp_path / "mine.toml"
    file.touch(mode=0o000)

    def refuse(*_: Any) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(file))

    monkeypatch.setattr(Path, "open", refuse)
    assert complaint(file=file) == f"{file}: cannot be read: Permission denied"


def test_a_name_with_a_line_end_in_it_does_not_break_the_line() -> None:
    assert "aircraft.properties.a b = 'x': must be a number" in complaint({"aircraft": {"properties": {"a\nb": "x"}}})


@pytest.mark.parametrize(("rate", "longest"), [(1000, 3600), (2000, 1800), (8000, 450)])
def test_a_flight_has_no_more_rows_of_truth_than_an_hour_at_1_khz(rate: int, longest: int) -> None:
    sets = [f"plant.step_rate={rate}", "accelerometer.rate=104"]
    load_scenario("catapult", overrides=[*sets, f"duration={longest}"])
    if rate > 1000:
        said = complaint(sets=[*sets, f"duration={longest + 1}"])
        assert f"duration = {longest + 1}: at plant.step_rate = {rate} Hz it would give 3.6" in said
        assert f"{longest} s can be flown" in said


@pytest.mark.parametrize(("bias", "limit"), [("0.0", 298.71), ("5", 293.71), ("[0, 0, -5]", 293.71)])
def test_the_limit_of_a_threshold_is_what_the_accelerometer_surely_shows(bias: str, limit: float) -> None:
    """LSM6DSO32 at ±32 g: 32 g less 3 × 0.5 % of scale, 3 × 20 mg of offset, 1 g of gravity and the given bias."""
    exact = 32 * 9.80665 * 0.985 - 0.06 * 9.80665 - 9.80665 - (298.71 - limit)
    assert exact == pytest.approx(limit, abs=0.01)
    for threshold, fits in ((exact - 0.01, True), (exact + 0.01, False)):
        sets = [f"accelerometer.bias={bias}", f"detector.threshold={threshold}"]
        if fits:
            load_scenario("catapult", overrides=sets)
        else:
            assert f"the limit is {exact:.1f} m/s²" in complaint(sets=sets)


@pytest.mark.parametrize(
    ("tare", "duration", "cover", "fits"),
    [
        ("covered", 1.5, 0.5, True), ("covered", 1.6, 0.5, False), ("covered", 0.5, 1.6, False),
        ("open", 1.5, 0.5, True), ("open", 2.1, 0.0, False), ("none", 60.0, 60.0, True),
    ],
)  # fmt: skip
def test_a_tare_must_fit_into_the_shortest_wait(tare: str, duration: float, cover: float, fits: bool) -> None:
    sets = [f"air_data.tare={tare}", f"air_data.tare_duration={duration}", f"air_data.cover_off={cover}"]
    if fits:
        assert load_scenario("catapult", overrides=sets).air_data.tare == tare
    else:
        assert "must fit into the shortest wait, launcher.wait_min = 2 s" in complaint(sets=sets)


def test_the_line_blames_whoever_gave_the_key(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text("[launcher]\nwait_min = 2.5\n[air_data]\ntare_duration = 2.0\n")
    assert complaint(file=file, sets="air_data.cover_off=0.6").startswith("--set: ")
    file.write_text("[launcher]\nwait_min = 2.5\n[air_data]\ntare_duration = 2.1\n")
    assert complaint(file=file, sets="seed=2").startswith(f"{file}: air_data.tare_duration")
    with pytest.raises(ValueError, match=r"^seed: seed = -1: must be a whole number from 0"):
        load_scenario("catapult", seed=-1)
    with pytest.raises(ValueError, match=r"^--seed: seed = -1: must be"):
        load_scenario("catapult", seed=-1, seed_name="--seed")
    with pytest.raises(ValueError, match=r"^scenario: seed = -1"):
        Scenario().with_seed(-1)


def test_a_wrong_seed_given_in_python_names_no_option() -> None:
    with pytest.raises(ValueError, match=r"^seed: seed = -1: must be a whole number from 0") as error:
        uavsim.fly(seed=-1)
    assert "--" not in str(error.value)


# -- what is right ---------------------------------------------------------------------------------------------------


def test_values_may_leave_out_their_quotes_but_keep_their_type() -> None:
    chosen = load_scenario(
        "catapult",
        overrides=[
            " accelerometer.preset = adxl345",
            'air_data.total.mode="x2/x1"',
            "air_data.static.mode=x2/x1",
            "name=2024",
            "description=true",
            "launcher.stroke=6",
            "launcher.stroke=7  # the last one counts",
            "detector.kind=multi-level-window",
            "detector.rearm=false",
            "accelerometer.bias=[0, 0.1, -0.2]",
            "aircraft.properties.wing/opening-rate-per_sec=3",
            "aircraft.properties.inertia/pointmass-weight-lbs[1]=0.1",
        ],
    )
    assert chosen.accelerometer.preset == "adxl345"
    assert (chosen.air_data.total.mode, chosen.air_data.static.mode) == ("x2/x1", "x2/x1")
    assert (chosen.name, chosen.description) == ("2024", "true")
    assert chosen.launcher.stroke == 7.0
    assert type(chosen.launcher.stroke) is float
    assert chosen.detector.rearm is False
    assert chosen.accelerometer.bias == (0.0, 0.1, -0.2)
    assert chosen.aircraft.properties == {"wing/opening-rate-per_sec": 3.0, "inertia/pointmass-weight-lbs[1]": 0.1}


@pytest.mark.parametrize("name", packaged_names())
def test_another_seed_gives_what_reading_it_with_that_seed_gives(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.with_seed(7) == load_scenario(name, seed=7) == scenario.with_seed(7).checked()


def test_what_was_made_in_python_is_checked_when_it_is_flown_and_not_by_another_seed() -> None:
    made = replace(Scenario(), duration=0.5)
    assert made.with_seed(2) == replace(made, seed=2)
    for fly in (uavsim.fly, partial(uavsim.fly, seed=2), Scenario.checked, partial(fly_seeds, seeds=[1])):
        with pytest.raises(ValueError, match=r"^scenario: duration = 0.5: must be"):
            fly(made)


def test_numpy_numbers_are_numbers() -> None:
    assert Scenario().with_seed(np.int64(5)) == Scenario(seed=5)
    assert Scenario.from_dict({"duration": np.float32(12.5)}) == Scenario(duration=12.5)
    for wrong in (np.bool_(True), np.array([1.0]), datetime.date(2000, 1, 1), 3j, {1}, b"3", object()):
        assert "duration" in complaint({"duration": wrong})


def test_none_counts_as_left_out_only_where_a_setting_may_be_none() -> None:
    assert Scenario.from_dict({"accelerometer": {"rate": None}}) == Scenario()
    assert "must be a number" in complaint({"duration": None})


def test_a_byte_order_mark_and_windows_line_ends_do_not_matter(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(b"\xef\xbb\xbfduration = 30\r\n[launcher]\r\nstroke = 6\r\n")
    assert load_scenario(file) == Scenario.from_dict({"name": "mine", "duration": 30, "launcher": {"stroke": 6}})


def test_packaged_scenarios_say_what_they_are_and_read_without_a_word() -> None:
    assert packaged()
    for name, description in packaged().items():
        assert description
        assert len(f"{name}  {description}") <= 110
        scenario = load_scenario(name)
        assert scenario.name == name
        assert Scenario.from_dict(scenario.to_dict()) == scenario
    assert {file.stem for file in PACKAGED.iterdir()} == set(packaged())


def test_a_packaged_name_wins_over_a_file_of_that_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("catapult").write_text("duration = 30")
    assert load_scenario("catapult").duration == Scenario().duration
    assert load_scenario("./catapult").duration == 30.0


def test_an_own_aircraft_is_found_from_anywhere_once_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = tmp_path / "own"
    own.symlink_to(hangar() / "fw8")
    monkeypatch.chdir(tmp_path)
    shutil.copytree(hangar() / "fw8", tmp_path / "bird")
    (tmp_path / "bird" / "fw8.xml").rename(tmp_path / "bird" / "bird.xml")
    read = load_scenario("catapult", overrides=["aircraft.model=bird"])
    assert read.aircraft.model == str(tmp_path / "bird")
    monkeypatch.chdir("/")
    assert Scenario.from_dict(read.to_dict()) == read
    assert load_scenario("catapult").aircraft.model == "fw8"


def test_a_requirement_may_name_every_number_of_a_score(catapult: Flight) -> None:
    def numbers(value: Any, prefix: str = "") -> set[str]:
        if isinstance(value, dict):
            return {
                key for name, item in value.items() for key in numbers(item, f"{prefix}.{name}" if prefix else name)
            }
        return set() if isinstance(value, str | list) else {prefix}

    assert set(NUMBERS) == numbers({k: v for k, v in catapult.score.items() if k not in ("versions", "reason")})


# -- whatever is given -----------------------------------------------------------------------------------------------

SCALARS = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.dates() | st.times()
    | st.integers(min_value=2**62) | st.sampled_from(["covered", "cruise", "paper", "bmp390", "adxl345", "any"])
)  # fmt: skip
NAMES = st.sampled_from(sorted({part for key in KEYS for part in key.split(".")})) | st.text(max_size=6)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3), max_leaves=6
)


def nested(key: str, value: Any) -> dict[str, Any]:
    *groups, last = key.split(".")
    tree: dict[str, Any] = {last: value}
    for group in reversed(groups):
        tree = {group: tree}
    return tree


def merged(trees: list[dict[str, Any]]) -> dict[str, Any]:
    whole: dict[str, Any] = {}
    for tree in copy.deepcopy(trees):
        for key, value in tree.items():
            both = isinstance(value, dict) and isinstance(whole.get(key), dict)
            whole[key] = merged([whole[key], value]) if both else value
    return whole


def names_something_in(line: str, values: Mapping[str, Any]) -> bool:
    """Whether a line names a key that was given: in words, or quoted as Python would."""
    return any(
        str(key) in line or ascii(key)[1:-1][:20] in line.encode("ascii", "backslashreplace").decode()
        or repr(key)[:20] in line
        or (isinstance(value, Mapping) and names_something_in(line, value))
        for key, value in values.items()
    )  # fmt: skip


@settings(deadline=None, max_examples=300, derandomize=True)
@given(
    st.lists(st.builds(nested, st.sampled_from(KEYS), VALUES), max_size=3).map(merged)
    | st.dictionaries(NAMES, VALUES, max_size=4)
)
def test_any_nested_values_are_a_scenario_or_one_line_that_names_the_key(values: dict[str, Any]) -> None:
    try:
        scenario = Scenario.from_dict(values, "here")
    except ValueError as error:
        line = str(error)
        assert line.startswith("here: ")
        assert len(line.splitlines()) == 1
        assert len(line) < 1000
        assert names_something_in(line, values)
    else:
        assert Scenario.from_dict(scenario.to_dict()) == scenario


def scenario_or_line(override: str) -> Scenario | str:
    try:
        return load_scenario("catapult", overrides=[override])
    except ValueError as error:
        return str(error)


@settings(deadline=None, max_examples=300, derandomize=True)
@given(
    st.text(max_size=30)
    | st.builds("{}={}".format, st.sampled_from(KEYS), st.text(max_size=12))
    | st.builds("{}={}".format, st.sampled_from(KEYS), VALUES)
    | st.builds("aircraft.properties.{}={}".format, st.text(max_size=8), st.floats())
)
def test_any_override_is_a_scenario_or_one_line(override: str) -> None:
    found = scenario_or_line(override)
    if isinstance(found, Scenario):
        assert Scenario.from_dict(found.to_dict()) == found
    else:
        assert found.startswith("--set")
        assert len(found.splitlines()) == 1


def allowed(hint: Any) -> st.SearchStrategy[Any]:
    """Values that a declaration of a number or a choice allows."""
    if get_origin(hint) is Literal:
        return st.sampled_from(get_args(hint))
    kind, bound = get_args(hint)
    low, above, high, below = (getattr(bound, name, None) for name in ("ge", "gt", "le", "lt"))
    least, most = (low if above is None else above), (high if below is None else below)
    if kind is int:
        return st.integers(least, most)
    most = 1e9 if most is None else most
    drawn = st.floats(least, most, exclude_min=above is not None, exclude_max=below is not None)
    return drawn.filter(lambda number: number == 0.0 or abs(number) >= SMALLEST_NUMBER)


def is_simple(hint: Any) -> bool:
    """Whether it is a bounded number or a choice."""
    return get_origin(hint) is Literal or (get_origin(hint) is Annotated and get_args(hint)[0] in {int, float})


PARTLY = {"air_data.total.iir", "air_data.static.iir"}  # what a part has is less than what its key allows
SIMPLE = sorted({key for key in KEYS if is_simple(hint_of(Scenario, key))} - PARTLY)
# The bounds that several keys share.
SHARED = r"wait_max|longest wait|shortest wait|never be sure|is not read by|lasts no more than|no wind under it"
PROPERTIES = st.dictionaries(
    st.from_regex(r"[a-z][a-z/.\[\]0-9-]{0,20}", fullmatch=True),
    st.floats(-1e9, 1e9).filter(lambda number: number == 0.0 or abs(number) >= SMALLEST_NUMBER),
    max_size=3,
)
TEXT = st.text(st.characters(codec="utf-8"), max_size=40)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.data(), st.lists(st.sampled_from(SIMPLE), max_size=8, unique=True), TEXT, PROPERTIES)
def test_valid_settings_come_back_from_toml_as_they_were(
    data: st.DataObject, chosen: list[str], text: str, properties: dict[str, float]
) -> None:
    """Random values, each within its own bounds, through the file that a flight writes."""
    trees = [nested(key, data.draw(allowed(hint_of(Scenario, key)), label=key)) for key in chosen]
    values = merged([*trees, {"description": text}, {"aircraft": {"properties": properties}}])
    try:
        scenario = Scenario.from_dict(values)
    except ValueError as error:
        assume(not re.search(SHARED, str(error)))
        raise
    again = Scenario.from_dict(tomllib.loads(tomli_w.dumps(scenario.to_dict())))
    assert again == scenario
    assert repr(asdict(again)) == repr(asdict(scenario))  # tells -0.0 from 0.0, and 1 from 1.0
    for key in chosen:
        assert pick(asdict(again), key) == pick(values, key)


def pick(values: Any, key: str) -> Any:
    for part in key.split("."):
        values = values[part]
    return values


@pytest.mark.parametrize("name", ["a", "8", "Überflug 2", "x" * 100, "a.b+c_d-e"])
def test_names_that_may_be_folders(name: str) -> None:
    assert Scenario.from_dict({"name": name}).name == name


def test_a_written_file_is_read_as_the_same(tmp_path: Path) -> None:
    for name in packaged():
        scenario = load_scenario(name, seed=2**63 - 1)
        write_toml(tmp_path / "scenario.toml", scenario.to_dict())
        assert load_scenario(tmp_path) == scenario == load_scenario(tmp_path / "scenario.toml")


@pytest.mark.parametrize("part", presets())
def test_every_preset_can_be_chosen_for_something(part: str) -> None:
    def accepts(key: str, *more: str) -> bool:
        try:
            load_scenario("catapult", overrides=[f"{key}={part}", "detector.threshold=20", *more])
        except ValueError:
            return False
        return True

    differential = accepts("air_data.differential.preset", "air_data.kind=differential")
    assert [accepts("accelerometer.preset"), accepts("air_data.total.preset"), differential].count(True) == 1
