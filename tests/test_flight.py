"""A flight's folder: whole or not there, with units, readable back, and flown again to the same bytes."""

import hashlib
import json
import math
import os
import stat
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from pandas.testing import assert_frame_equal

import uavsim
from uavsim.cli import main
from uavsim.cosim import CHUNK, Cosimulation, draw, plant_settings, replay
from uavsim.flight import DERIVED, UNITS, Flight, load
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.scenario import load_scenario
from uavsim.views.plots import save_plots
from uavsim.views.terminal import print_score

FILES = {"scenario.toml", "score.json", "events.json", *(f"{name}.parquet" for name in UNITS)}
SHORT = ["duration=6", "requirements=[]"]
ANGLES = {"roll", "pitch", "heading", "alpha", "beta"}
SI = {"s", "m", "m/s", "m/s^2", "rad", "rad/s", "Pa", "K", "N", "1", ""}


def digests(folder: Path) -> dict[str, str]:
    return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in folder.iterdir() if file.is_file()}


@pytest.fixture(scope="session")
def short() -> Flight:
    """Return the first 6 s of `catapult`, seed 3: rail, launch, wings."""
    return uavsim.fly("catapult", seed=3, overrides=SHORT)


@pytest.fixture
def folder(short: Flight, tmp_path: Path) -> Path:
    return short.save(tmp_path / "flight")


# -- there and back --------------------------------------------------------------------------------------------------


def test_a_folder_holds_the_flight(short: Flight, folder: Path) -> None:
    assert {file.name for file in folder.iterdir()} == FILES
    again = uavsim.load(folder)
    assert again.scenario == short.scenario
    assert again.score == short.score
    assert again.events == short.events
    assert list(again.tables) == list(UNITS)
    for name, table in short.tables.items():
        assert_frame_equal(again.tables[name], table, check_exact=True, check_dtype=name != "truth")
        assert getattr(again, name) is again.tables[name]


def test_json_holds_numbers_or_null(folder: Path) -> None:
    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    for name in ("score.json", "events.json"):
        json.loads((folder / name).read_text(encoding="utf-8"), parse_constant=refuse)


@pytest.mark.parametrize("name", UNITS)
def test_every_column_of_every_table_has_its_unit(folder: Path, short: Flight, name: str) -> None:
    schema = pq.read_schema(folder / f"{name}.parquet")
    assert schema.names == list(UNITS[name]) == list(short.tables[name])
    for column in schema:
        unit = column.metadata[b"unit"].decode()
        assert unit == UNITS[name][column.name]
        assert unit in SI
        assert bool(unit) == (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)), column.name
        assert (unit == "rad") == (column.name in ANGLES)
        assert (unit == "s") == (column.name == "t" or column.name.startswith("t_"))


def test_angles_are_radians(catapult: Flight) -> None:
    truth = catapult.truth
    assert truth["heading"].abs().max() < 0.1  # northwards, and no jump by a turn
    assert truth["pitch"].iloc[0] == pytest.approx(0.2182, abs=2e-3)  # 12.5 degrees of rail
    assert truth[["roll", "pitch", "alpha"]].abs().max().max() < 1.6


# -- again -----------------------------------------------------------------------------------------------------------


def test_a_written_scenario_flies_again_to_the_same_bytes(short: Flight, folder: Path, tmp_path: Path) -> None:
    for source in (folder, folder / "scenario.toml"):
        again = uavsim.fly(source).save(tmp_path / f"again-{Path(source).name}")
        assert digests(again) == digests(folder)


def test_another_process_flies_to_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    """Neither the order of a process's flights nor its hash seed nor its surroundings matter."""
    code = (
        "import sys, uavsim\n"
        "uavsim.fly('weak-launch', seed=9, overrides=['duration=5'])\n"
        f"uavsim.fly('catapult', seed=3, overrides={SHORT!r}).save(sys.argv[1])\n"
    )
    environment = {
        "PYTHONPATH": os.pathsep.join(sys.path),
        "PYTHONHASHSEED": "77",
        "TZ": "Asia/Kathmandu",
        "LC_ALL": "C",
    }
    other = tmp_path / "other"
    subprocess.run([sys.executable, "-c", code, str(other)], check=True, env=environment, cwd=tmp_path)
    assert digests(other) == digests(folder)


def test_two_seeds_are_two_flights(short: Flight) -> None:
    other = uavsim.fly("catapult", seed=4, overrides=SHORT)
    assert other.score["launch"]["release_time"] != short.score["launch"]["release_time"]
    assert other.score["flight"]["rail_exit_speed"] != short.score["flight"]["rail_exit_speed"]


def test_a_loaded_flight_replays_to_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    again = replay(uavsim.load(folder)).save(tmp_path / "replay")
    assert digests(again) == digests(folder)


# -- a folder that is damaged ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("scenario.toml", None, "is not a flight's folder: scenario.toml is missing"),
        ("score.json", None, "is not a flight's folder: score.json is missing"),
        ("scenario.toml", b"= 3", "scenario.toml is damaged: not valid TOML: Invalid"),
        ("scenario.toml", b"\xff", "scenario.toml is not text in UTF-8"),
        ("scenario.toml", b"a" + b".a" * 20_000 + b" = 1", "scenario.toml is damaged: line 1: nested too deep"),
        ("scenario.toml", b" " * 1_000_001, "scenario.toml is larger than 1000000 bytes"),
        ("score.json", b"{", "score.json is damaged"),
        ("score.json", b"[" * 100_000, "score.json is damaged: nested too deep"),
        ("score.json", b'{"a": NaN}', "score.json is damaged: NaN is not a finite number"),
        ("score.json", b'{"a": -1e400}', "score.json is damaged: -1e400 is not a finite number"),
        ("score.json", b'{"a": 1' + b"0" * 5000 + b"}", "score.json is damaged"),
        ("events.json", b'[{"t": 1.0}]', "events.json is not a flight's: an event has a time t, s, and a name"),
        ("events.json", b"[3]", "events.json is not a flight's: an event has a time t, s, and a name"),
        ("score.json", b"[]", "score.json is not a flight's: it holds a list, not a dict"),
        ("events.json", b"{}", "events.json is not a flight's: it holds a dict, not a list"),
        ("truth.parquet", b"", "truth.parquet cannot be read"),
        ("estimate.parquet", b"PAR1" * 100, "estimate.parquet cannot be read"),
    ],
)
def test_a_damaged_folder_is_one_line_that_names_the_file(
    folder: Path, name: str, content: bytes | None, says: str
) -> None:
    (folder / name).unlink()
    if content is not None:
        (folder / name).write_bytes(content)
    with pytest.raises(ValueError, match=r".") as caught:
        load(folder)
    assert says in str(caught.value)


def test_a_table_of_something_else_is_named(folder: Path) -> None:
    pd.DataFrame({"t": [0.0]}).to_parquet(folder / "air_data.parquet")
    with pytest.raises(ValueError, match=r"air_data.parquet is not a flight's: the column 'p_total' is missing"):
        load(folder)


def test_what_is_no_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for name in ("nothing", "file"):
        with pytest.raises(ValueError, match=f"{name} is not a flight's folder: there is no such folder"):
            load(tmp_path / name)


def test_a_recording_may_lack_tables(folder: Path) -> None:
    (folder / "truth.parquet").unlink()
    flight = load(folder)
    with pytest.raises(AttributeError, match="this flight has no table 'truth'; it has accelerometer, air_data"):
        _ = flight.truth


# -- whole or not there ----------------------------------------------------------------------------------------------


def everything(folder: Path) -> set[str]:
    return {str(entry.relative_to(folder)) for entry in folder.rglob("*")}


def test_a_folder_is_made_with_its_parents_and_the_umask(short: Flight, tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        target = short.save(tmp_path / "a" / "b" / "c")
    finally:
        os.umask(before)
    assert everything(tmp_path) == {"a", "a/b", "a/b/c", *(f"a/b/c/{name}" for name in FILES)}
    assert stat.S_IMODE(target.stat().st_mode) == 0o750


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_nothing_is_left_of_what_failed(short: Flight, tmp_path: Path, error: type[BaseException], there: bool) -> None:
    target = tmp_path / "a" / "b"
    if there:
        target.mkdir(parents=True)
    before = everything(tmp_path)

    def fail(_: Path) -> None:
        raise error

    with pytest.raises(error):
        short.save(target, extra=fail)
    assert everything(tmp_path) == before


def test_a_folder_that_is_not_empty_is_refused_and_then_replaced(short: Flight, folder: Path) -> None:
    before = digests(folder)
    with pytest.raises(FileExistsError, match="flight is not empty; choose another folder or give --overwrite"):
        short.save(folder)
    (folder / "score.json").write_text("old")
    (folder / "runs.parquet").write_text("of several flights")
    (folder / "plots").mkdir()
    (folder / "plots" / "old.png").touch()
    short.save(folder, overwrite=True)
    assert digests(folder) == before
    assert everything(folder) == FILES


def test_overwriting_spares_what_is_not_a_flights(short: Flight, tmp_path: Path) -> None:
    """`--overwrite` on a wrong folder, a home even, must not cost what is in it."""
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "to-a-friend").write_text("dear")
    (tmp_path / "notes.txt").write_text("mine")
    number = tmp_path.stat().st_ino
    places: list[Path] = []
    short.save(tmp_path, overwrite=True, extra=places.append)
    assert everything(tmp_path) == {*FILES, "letters", "letters/to-a-friend", "notes.txt"}
    assert tmp_path.stat().st_ino == number  # one may stand in it, or it may be mounted: it stays the same folder
    assert [place.parent for place in places] == [tmp_path]  # and a mounted one may lie in one that cannot be written


def test_a_failed_overwrite_leaves_the_old_flight(short: Flight, folder: Path) -> None:
    before = digests(folder)

    def fail(_: Path) -> None:
        raise RuntimeError

    with pytest.raises(RuntimeError):
        short.save(folder, overwrite=True, extra=fail)
    assert digests(folder) == before
    assert everything(folder) == FILES


def test_links_stay_and_lead_to_what_is_written(short: Flight, tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    for name, to in (("link", "real"), ("dangling", "new")):
        (tmp_path / name).symlink_to(to)
        short.save(tmp_path / name)
        assert (tmp_path / name).is_symlink()
        assert everything(tmp_path / to) == FILES


# -- a flight that goes wrong is a result ----------------------------------------------------------------------------


class _Breaking(JsbsimPlant):
    """An aircraft on which a moment that is no number acts from a step on."""

    breaks_at = 5000

    def step(self) -> None:
        if self.k == self.breaks_at:
            self._fdm.set_property_value("external_reactions/wing-inertia/l", float("nan"))
        super().step()


@pytest.mark.parametrize("breaks_at", [100, 5000])
def test_a_flight_that_diverges_keeps_what_was_flown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], breaks_at: int
) -> None:
    scenario = load_scenario("catapult", overrides=["duration=9"], seed=1)
    plant = _Breaking(plant_settings(scenario, draw(scenario)))
    plant.breaks_at = breaks_at
    simulation = Cosimulation(scenario, plant=plant)
    while not simulation.ended:
        simulation.advance(CHUNK)
    flight = simulation.finish()
    assert flight.score["outcome"] == "diverged"
    assert breaks_at < len(flight.truth) < breaks_at + 10
    assert flight.truth.iloc[: breaks_at + 1].notna().all(axis=None)
    target = flight.save(tmp_path / "flight", extra=lambda folder: save_plots(flight, folder / "plots") and None)
    assert any((target / "plots").iterdir())
    again = load(target)
    assert again.score == flight.score
    assert len(again.truth) == len(flight.truth)
    assert digests(replay(again).save(tmp_path / "again")) == digests(target)
    print_score(again)
    assert "diverged" in capsys.readouterr().out


def test_a_record_of_an_older_make_still_loads(folder: Path) -> None:
    """A requirement on a figure that the score no longer has is kept, and not met."""
    scenario: dict[str, Any] = tomllib.loads((folder / "scenario.toml").read_text(encoding="utf-8"))
    flight = load(folder)
    old = Flight({**scenario, "requirements": [{"key": "gone", "maximum": 1.0}]}, flight.tables, flight.events)
    assert replay(old).score["requirements"][0]["met"] is False


def test_a_record_without_the_columns_that_follow_from_others_loads_and_gets_them_by_replay(
    short: Flight, folder: Path
) -> None:
    """A flight of an earlier version has neither calibrated nor equivalent airspeed, nor a reason of null."""
    for name in ("truth", "estimate"):
        file = folder / f"{name}.parquet"
        pd.read_parquet(file).drop(columns=list(DERIVED)).to_parquet(file, index=False)
    old = load(folder)
    assert not set(DERIVED) & {*old.truth, *old.estimate}
    again = replay(old)
    for name in ("truth", "estimate"):
        pd.testing.assert_frame_equal(again.tables[name], short.tables[name])
    assert again.score["airspeed"] == short.score["airspeed"]


@pytest.mark.parametrize("t", [[], [0.0], [0.0, 0.0], [0.0, math.nan], [0.0, math.inf], [-1e308, 1e308], [1.0, 0.0]])
def test_times_of_a_truth_that_are_none(catapult: Flight, tmp_path: Path, t: list[float]) -> None:
    folder = catapult.save(tmp_path / "flight")
    table = catapult.truth.iloc[: len(t)].assign(t=t)
    table.to_parquet(folder / "truth.parquet", index=False)
    with pytest.raises(ValueError, match=r"truth\.parquet cannot be read: its column t must have at least two times"):
        load(folder)


@pytest.mark.parametrize("name", list(UNITS))
def test_a_flight_that_lacks_a_table_is_not_replayed(
    catapult: Flight, tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = catapult.save(tmp_path / "flight")
    (folder / f"{name}.parquet").unlink()
    monkeypatch.setattr("sys.argv", ["uavsim", "replay", str(folder), "--out", str(tmp_path / "again")])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert f"cannot be replayed: {name}.parquet is missing" in capsys.readouterr().err
    assert not (tmp_path / "again").exists()
