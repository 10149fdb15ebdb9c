"""What a flight read from outside is in its folder, is flown again from there, and is refused where it was changed."""

import copy
import pickle
import shutil
import tomllib
from hashlib import sha256
from pathlib import Path

import pytest

import uavsim
from sensors.catalogue import FOLDER, captured
from sensors.sheet import Sheet
from uavsim import inputs
from uavsim.cosim import replay
from uavsim.flight import load
from uavsim.plants.airframe import Airframe
from uavsim.plants.airframe.check import Checked
from uavsim.plants.hangar import hangar
from uavsim.scenario import Scenario, load_scenario

SHORT = ("duration=8",)
HEAD = """
kind = "head-calibration"
source = "a reference tube beside it"
[static]
error = 0.021
error_sd = 0.001
error_alpha_per_rad = 0.0
error_alpha_sd_per_rad = 0.002
error_alpha2_per_rad2 = -0.5
error_alpha2_sd_per_rad2 = 0.06
error_beta2_per_rad2 = -0.6
error_beta2_sd_per_rad2 = 0.06
error_mach2 = 0.0
error_mach2_sd = 0.0
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """Return a folder with an aircraft, a calibration, two presets of the same name and a file that nobody names."""
    aircraft = tmp_path / "own" / "bird"
    shutil.copytree(hangar() / "fw8", aircraft)
    (aircraft / "fw8.xml").rename(aircraft / "bird.xml")
    (aircraft / "diary.txt").write_text("nobody's business")
    for place, resolution in (("total", 2.0), ("static", 3.0)):
        text = (FOLDER / "bmp390.toml").read_text(encoding="utf-8")
        file = tmp_path / "own" / place / "mine.toml"
        file.parent.mkdir()
        file.write_text(text.replace('part = "', f'part = "{place} {resolution} ', 1), encoding="utf-8")
    shutil.copy(FOLDER / "adxl345.toml", tmp_path / "own" / "axes.toml")
    (tmp_path / "own" / "head.toml").write_text(HEAD, encoding="utf-8")
    return tmp_path / "own"


def overrides(own: Path) -> list[str]:
    """Return what makes a scenario use all of them."""
    return [
        *SHORT,
        f"aircraft.model={own / 'bird'}",
        f"accelerometer.preset={own / 'axes.toml'}",
        f"air_data.total.preset={own / 'total' / 'mine.toml'}",
        f"air_data.static.preset={own / 'static' / 'mine.toml'}",
        f"air_data.calibration={own / 'head.toml'}",
    ]


@pytest.fixture
def kept(own: Path, tmp_path: Path) -> Path:
    """Return the folder of a flight that used them; the originals are gone."""
    folder = uavsim.fly("catapult", overrides=overrides(own)).save(tmp_path / "kept")
    shutil.rmtree(own)
    return folder


def test_all_that_was_read_is_kept_and_no_more(kept: Path) -> None:
    files = {str(file.relative_to(kept)) for file in (kept / "inputs").rglob("*") if file.is_file()}
    aircraft = {"bird.xml", "systems/wing.xml", "systems/stabiliser.xml", "engine/fw8_motor.xml"}
    assert files == {
        *(f"inputs/aircraft.model/bird/{file}" for file in (*aircraft, "engine/fw8_propeller.xml")),
        "inputs/accelerometer.preset/axes.toml",
        "inputs/air_data.total.preset/mine.toml",
        "inputs/air_data.static.preset/mine.toml",
        "inputs/air_data.calibration/head.toml",
    }
    recorded = tomllib.loads((kept / "scenario.toml").read_text(encoding="utf-8"))
    assert recorded["aircraft"]["model"] == "inputs/aircraft.model/bird"
    assert recorded["inputs"] == {file: sha256((kept / file).read_bytes()).hexdigest() for file in files}


def test_it_flies_again_and_replays_from_its_folder_wherever_that_is(kept: Path, tmp_path: Path) -> None:
    moved = tmp_path / "elsewhere" / "moved"
    shutil.copytree(kept, moved)
    again = uavsim.fly(moved).save(tmp_path / "again")
    replayed = replay(load(moved)).save(tmp_path / "replayed")
    for folder in (again, replayed):
        for file in (file for file in kept.rglob("*") if file.is_file()):
            assert (folder / file.relative_to(kept)).read_bytes() == file.read_bytes(), file


@pytest.mark.parametrize("change", ["append", "remove", "link", "unlisted"])
@pytest.mark.parametrize(
    "file",
    ["air_data.static.preset/mine.toml", "aircraft.model/bird/systems/wing.xml", "air_data.calibration/head.toml"],
)
def test_a_copy_that_was_changed_is_refused(kept: Path, tmp_path: Path, change: str, file: str) -> None:
    target = kept / "inputs" / file
    if change == "append":
        target.write_bytes(target.read_bytes() + b"\n")
    elif change == "remove":
        target.unlink()
    elif change == "link":
        target.rename(tmp_path / "outside")
        target.symlink_to(tmp_path / "outside")
    else:
        scenario = kept / "scenario.toml"
        lines = scenario.read_text(encoding="utf-8").splitlines()
        scenario.write_text("\n".join(line for line in lines if not line.startswith(f'"inputs/{file}"')))
    why = {"append": "SHA-256 is another", "remove": "no such file", "link": "leads out", "unlisted": "not in"}[change]
    for read in (load_scenario, load):
        with pytest.raises(ValueError, match=why) as told:
            read(kept)
        assert "\n" not in str(told.value)


def test_what_the_originals_become_changes_nothing_once_the_scenario_is_read(own: Path) -> None:
    scenario = load_scenario("catapult", overrides=overrides(own))
    expected = uavsim.fly(scenario)
    for file in own.rglob("*"):
        if file.is_file():
            file.write_text("changed")
    sent = pickle.loads(pickle.dumps(scenario))  # as to another process
    for again in (scenario, copy.deepcopy(scenario), Scenario.from_dict(scenario.to_dict()), sent):
        flown = uavsim.fly(again)
        assert flown.estimate.equals(expected.estimate)
        assert flown.score == expected.score
    assert uavsim.fly(scenario.with_seed(2)).score["seed"] == 2


def test_a_flight_without_them_has_neither_folder_nor_table(tmp_path: Path) -> None:
    folder = uavsim.fly("launch-curve").save(tmp_path / "flight")
    assert not (folder / "inputs").exists()
    assert "inputs" not in tomllib.loads((folder / "scenario.toml").read_text(encoding="utf-8"))


def test_presets_are_read_once(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    shutil.copy(FOLDER / "bmp390.toml", mine)
    sheet = captured(str(mine))
    assert isinstance(sheet, Sheet)
    assert captured(sheet) is sheet
    assert captured("bmp390") == "bmp390"
    assert not isinstance(captured("bmp390"), Sheet)
    mine.write_text("kind = 'nothing'")
    assert copy.deepcopy(sheet) is sheet
    with pytest.raises(ValueError, match=r"mine\.toml: kind"):
        captured(str(mine))


@pytest.mark.parametrize("table", ["inputs = 3", "[inputs]\nx = 3", '[inputs]\n"../../etc/passwd" = "00"'])
def test_tables_that_are_none(tmp_path: Path, table: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        f"{table}\n[aircraft]\nmodel = 'inputs/aircraft.model/fw8'\n"
        if table[0] == "i"
        else f"aircraft.model = 'inputs/aircraft.model/fw8'\n{table}"
    )
    with pytest.raises(ValueError, match=r"inputs must be a table|is no file of inputs/KEY/"):
        load_scenario(file)


def test_a_calibration_that_is_wrong_is_one_line_and_nothing_is_written(own: Path, tmp_path: Path) -> None:
    head = own / "head.toml"
    head.write_text(HEAD.replace("error_alpha_per_rad", "error_alpha_per_deg"), encoding="utf-8")
    with pytest.raises(
        ValueError, match=r"^--set: air_data\.calibration: head\.toml: key .* has the wrong unit"
    ) as told:
        uavsim.fly("catapult", overrides=overrides(own)).save(tmp_path / "kept")
    assert "\n" not in str(told.value)
    assert not (tmp_path / "kept").exists()


def test_value_of_what_is_not_there() -> None:
    assert inputs.value_of({"a": {"b": 3}}, "a.b") == 3
    assert inputs.value_of({"a": 3}, "a.b") is None
    assert inputs.value_of({}, "a.b") is None


@pytest.mark.parametrize("name", ["..", ".", "", "bird/..", "bird/../bird"])
def test_an_aircraft_is_a_name_in_its_folder_and_no_way_out(kept: Path, tmp_path: Path, name: str) -> None:
    """A record whose aircraft is called `..` would be laid out above the folder for it."""
    scenario = kept / "scenario.toml"
    text = scenario.read_text(encoding="utf-8")
    scenario.write_text(text.replace("inputs/aircraft.model/bird", f"inputs/aircraft.model/{name}"), encoding="utf-8")
    for read in (load_scenario, load):
        with pytest.raises(ValueError, match=r"must be inputs/aircraft\.model/ and a name|is no file of inputs/KEY/"):
            read(kept)
    with pytest.raises(ValueError, match="is no name of an aircraft"):
        Airframe(str(tmp_path / ".."), Checked({}, {}, frozenset(), frozenset())).write(tmp_path)
