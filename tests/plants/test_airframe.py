"""Aircraft's files are data: what is not the description of an aircraft is refused before JSBSim opens it.

Every aircraft here is read in a child process that is watched: how it ends, which sockets and files it leaves.
"""

import json
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import hostile_aircraft as hostile
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsbsim import FGFDMExec

import uavsim
from uavsim.cosim import replay
from uavsim.plants.airframe import read_airframe
from uavsim.plants.airframe.check import check_files
from uavsim.plants.airframe.grammar import COMPONENTS, RULES
from uavsim.plants.airframe.properties import OF_AIRCRAFT, OF_SIMULATOR, TAKEN, is_path, may_name_function, may_set
from uavsim.plants.hangar import find_airframe, is_packaged
from uavsim.plants.jsbsim import load_airframe

STEPS = 200  # before and after the commands


def flown(folder: Path, scratch: Path) -> str:
    """Read an aircraft as the plant does, and let JSBSim fly it with all that it can be told."""
    scratch.mkdir()
    try:
        tempfile.tempdir = str(scratch)  # in this child process
        fdm = load_airframe(read_airframe(folder))
        fdm.set_dt(0.001)
        fdm.set_property_value("ic/h-sl-ft", 300.0)
        fdm.set_property_value("ic/vt-fps", 100.0)
        KEPT.append(fdm)
        if not fdm.run_ic():
            return "does not start"
        _run(fdm)
        for name in ("fcs/throttle-cmd-norm", "fcs/wing-cmd-norm", "ap/engaged", "fcs/elevator-cmd-norm"):
            fdm.set_property_value(name, 1.0)
        _run(fdm)
    except ValueError as error:
        return f"refused: {error}"
    except RuntimeError as error:  # JSBSim's own, which the plant takes for the end of the flight
        return f"failed: {error}"
    finally:
        scratch.rmdir()
    return "flown"


KEPT: list[FGFDMExec] = []


def _run(fdm: FGFDMExec) -> None:
    for _ in range(STEPS):
        fdm.run()


def tried(files: hostile.Files, name: str, tmp_path: Path) -> str:
    """Return what became of an aircraft."""
    folder = hostile.write(files, tmp_path / "given" / name)
    place = tmp_path / "here"
    try:
        return hostile.watched(lambda: flown(folder, place / "scratch"), place)
    finally:
        shutil.rmtree(folder)


def ended_well(said: str) -> bool:
    """Whether an aircraft was refused in one line, or flown, and left nothing."""
    line = "\n" not in said and len(said) < 1000
    return (
        line
        and said.startswith(("flown", "refused: ", "failed: ", "does not start"))
        and "SOCKETS" not in said
        and "FILES" not in said
    )


ATTACKS = hostile.attacks(Path("/tmp/victim-of-an-aircraft"))


@pytest.mark.parametrize("name", sorted(ATTACKS))
def test_attacks_are_refused_in_one_line_and_leave_nothing(name: str, tmp_path: Path) -> None:
    victim = tmp_path / "victim.csv"
    victim.write_text("mine")
    files = hostile.attacks(victim)[name]
    if "entity" in name or "utf" in name or name in {"not a file", "empty", "huge"}:
        assert files["fw8.xml"] != hostile.packaged()["fw8.xml"]
    said = tried(files, "fw8", tmp_path)
    assert victim.read_text() == "mine"
    assert not (tmp_path.parent / "victim.csv").exists()
    assert ended_well(said)
    assert said.startswith("refused: ") == (name not in HARMLESS), said


HARMLESS = {"31 sums", "system angle of nothing"}
"""What JSBSim can do, and does no harm."""


def test_a_refusal_names_file_line_element_and_what_is_allowed(tmp_path: Path) -> None:
    folder = hostile.write(hostile.attacks(tmp_path / "v")["output file"], tmp_path / "fw8")
    with pytest.raises(
        ValueError, match=r"fw8\.xml: line \d+: <output>: is not part of an aircraft, as it writes files"
    ) as told:
        read_airframe(folder)
    number = int(str(told.value).partition("line ")[2].partition(":")[0])
    assert "<output" in (folder / "fw8.xml").read_text().splitlines()[number - 1]


def test_links_out_of_the_folder_are_refused(tmp_path: Path) -> None:
    folder = hostile.write(hostile.packaged(), tmp_path / "fw8")
    outside = tmp_path / "wing.xml"
    (folder / "systems" / "wing.xml").rename(outside)
    (folder / "systems" / "wing.xml").symlink_to(outside)
    with pytest.raises(ValueError, match=r"systems/wing\.xml: is a link that leads out"):
        read_airframe(folder)


def test_pipes_and_folders_are_no_files(tmp_path: Path) -> None:
    folder = hostile.write(hostile.packaged(), tmp_path / "fw8")
    (folder / "systems" / "wing.xml").unlink()
    os.mkfifo(folder / "systems" / "wing.xml")
    with pytest.raises(ValueError, match=r"the file 'wing\.xml' is not in the aircraft's folder"):
        read_airframe(folder)


def test_jsbsim_opens_what_was_checked_whatever_becomes_of_the_original(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = hostile.write(hostile.packaged(), tmp_path / "fw8")
    airframe = read_airframe(folder)
    (folder / "fw8.xml").write_bytes(hostile.attacks(tmp_path / "victim")["output file"]["fw8.xml"])
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    load_airframe(airframe)
    assert not (tmp_path / "victim").exists()
    assert not list(scratch.iterdir())
    with pytest.raises(ValueError, match="<output>"):
        read_airframe(folder)  # a changed file is checked anew


def test_an_airframe_carries_its_files(tmp_path: Path) -> None:
    folder = hostile.write(hostile.packaged() | {"stranger.xml": b"<x/>"}, tmp_path / "fw8")
    airframe = read_airframe(folder)
    again = pickle.loads(pickle.dumps(airframe))
    assert again == str(folder)
    assert again.checked == airframe.checked
    assert "stranger.xml" not in airframe.checked.files  # nobody names it
    assert not is_packaged(airframe)
    assert is_packaged(find_airframe("fw8"))


@pytest.mark.parametrize("name", ["c172x", "f16"])
def test_aircraft_of_jsbsim_pass_once_mended(name: str, tmp_path: Path) -> None:
    assert tried(hostile.complete(name), name, tmp_path) == "flown"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("c172x", "c172x.xml: line 1222: <output>: is not part of an aircraft"),
        ("f16", "'sim/model/pushback/kd' are properties that neither JSBSim"),
    ],
)
def test_aircraft_of_jsbsim_as_they_are(name: str, why: str, tmp_path: Path) -> None:
    said = tried(hostile.complete(name, mended=False), name, tmp_path)
    assert said.startswith("refused: ")
    assert why in said


def test_an_engine_that_is_shared_must_be_copied(tmp_path: Path) -> None:
    files = hostile.below(hostile.STOCK / "aircraft" / "f16")
    said = tried(files, "f16", tmp_path)
    assert (
        "<engine>: the file 'F100-PW-229.xml' is not in the aircraft's folder: copy it into Engines/ or engine/" in said
    )


def test_roots_of_properties_are_those_that_jsbsim_has() -> None:
    airframe = find_airframe("fw8")
    loaded = {line.rpartition(" ")[0] for line in load_airframe(airframe).get_property_catalog()}
    roots = {name.split("/")[0] for name in loaded} - {"air", "tail", "wing", "factor", "ballast"}  # its own
    assert roots <= set(OF_AIRCRAFT) | set(OF_SIMULATOR)
    for root, names in TAKEN.items():
        assert {f"{root}/{name}" for name in names} <= loaded


@pytest.mark.parametrize(
    ("name", "path", "settable", "function"),
    [
        ("fcs/mine", True, True, True),
        ("mine/of/wing", True, True, True),
        ("simulation/reset", True, False, False),
        ("simulation[0]/reset", True, False, False),
        ("/simulation/reset", True, False, False),
        ("//simulation/reset", False, False, False),
        ("./simulation/reset", False, False, False),
        ("fcs/../simulation/reset", False, False, False),
        ("fcs/.", False, False, False),
        ("ic/h-sl-ft", True, False, False),
        ("atmosphere/delta-T", True, False, False),
        ("attitude/sensor/phi", True, True, True),
        ("attitude/phi-rad", True, False, False),
        ("inertia/print-mass-properties", True, False, False),
        ("inertia/pointmass-weight-lbs[2]", True, True, False),
        ("aero/qbar-psf", True, True, False),
        ("simulation", True, False, False),
        ("fcs", True, False, False),
        ("a\n/b", False, False, False),
        ("a" * 201, False, False, False),
    ],
)
def test_names_of_properties(name: str, path: bool, settable: bool, function: bool) -> None:
    assert is_path(name) == path
    assert may_set(name) == settable
    assert may_name_function(name) == function


def test_the_grammar_is_whole() -> None:
    named = {rule for r in RULES.values() for rule in r.children.values()}
    assert named <= set(RULES)
    for rule in RULES.values():
        assert {*rule.needs, *rule.some} <= set(rule.children)
        assert set(rule.needs_attributes) <= set(rule.attributes)
    assert {f"component {name}" for name in COMPONENTS} <= set(RULES)


def test_all_aircraft_of_jsbsim_pass_or_are_refused_in_one_line() -> None:
    passed, refused = 0, []
    for folder in sorted((hostile.STOCK / "aircraft").iterdir()):
        if (folder / f"{folder.name}.xml").is_file():
            files = hostile.complete(folder.name)
            try:
                check_files(folder.name, files.get)
                passed += 1
            except ValueError as error:
                refused.append(f"{folder.name}: {error}")
    assert passed >= 39, refused
    assert all("\n" not in line and len(line) < 400 for line in refused)


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32))
def test_mutants_are_refused_or_fly(seed: int, tmp_path: Path) -> None:
    _mutant_ends_well(seed, tmp_path)


@pytest.mark.slow
@settings(max_examples=1000, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32))
def test_a_thousand_mutants_are_refused_or_fly(seed: int, tmp_path: Path) -> None:
    _mutant_ends_well(seed, tmp_path)


def _mutant_ends_well(seed: int, tmp_path: Path) -> None:
    name = ("fw8", "fw8", "c172x", "f16")[seed % 4]
    assert ended_well(said := tried(hostile.mutate(BASES[name], seed), name, tmp_path)), (seed, name, said)


BASES = {"fw8": hostile.packaged(), "c172x": hostile.complete("c172x"), "f16": hostile.complete("f16")}


def test_a_function_that_fails_at_the_start_is_a_line(tmp_path: Path) -> None:
    """In a process of its own, which JSBSim would end when the aircraft is taken down: one line, status 2."""
    index = "<sum><value>5</value><property>fcs/wing-pos-norm</property></sum>"
    function = f'<aerodynamics><function name="aero/mine"><switch>{index}<value>1</value></switch></function>'
    good = hostile.packaged()
    main = good["fw8.xml"].replace(b"<aerodynamics>", function.encode())
    folder = hostile.write(good | {"fw8.xml": main}, tmp_path / "fw8")
    command = ["fly", "catapult", "--set", f"aircraft.model={folder}", "--no-plots", "--out", str(tmp_path / "out")]
    done = subprocess.run([sys.executable, "-m", "uavsim.cli", *command], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("Error: ")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_function_that_fails_in_the_air_ends_the_flight_with_a_reason(tmp_path: Path) -> None:
    """In a process of its own: JSBSim would end it when it is taken down."""
    index = "<product><value>5</value><property>fcs/wing-pos-norm</property></product>"
    function = f'<aerodynamics><function name="aero/mine"><switch>{index}<value>1</value></switch></function>'
    good = hostile.packaged()
    main = good["fw8.xml"].replace(b"<aerodynamics>", function.encode())
    line = main[: main.index(b"<switch>")].count(b"\n") + 1
    folder = hostile.write(good | {"fw8.xml": main}, tmp_path / "fw8")
    out = tmp_path / "out"
    command = ["fly", "catapult", "--set", f"aircraft.model={folder}", "--no-plots", "--out", str(out)]
    done = subprocess.run([sys.executable, "-m", "uavsim.cli", *command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (1, "")
    score = json.loads((out / "score.json").read_text())
    assert score["outcome"] == "diverged"
    assert score["reason"].startswith(f"In file fw8/fw8.xml: line {line} The switch function index")
    assert "Reason: In file fw8/fw8.xml" in done.stdout
    again = replay(uavsim.load(out)).save(tmp_path / "again")
    assert (again / "score.json").read_bytes() == (out / "score.json").read_bytes()


def test_what_uavsim_reads_is_no_function_of_the_aircraft(tmp_path: Path) -> None:
    """What fails in a function that is read from Python ends the process."""
    function = '<aerodynamics><function name="fcs/wing-pos-norm"><value>1</value></function>'
    good = hostile.packaged()
    main = good["fw8.xml"].replace(b"<aerodynamics>", function.encode())
    folder = hostile.write(good | {"fw8.xml": main}, tmp_path / "fw8")
    with pytest.raises(ValueError, match="'fcs/wing-pos-norm' is a function, and uavsim reads or sets it"):
        uavsim.fly("catapult", overrides=[f"aircraft.model={folder}"])


@pytest.mark.parametrize(
    "name",
    [
        "atmosphere/updownburst/number-of-cells",
        "position/h-sl-ft",
        "ic/h-sl-ft",
        "/simulation/reset",
        "forces/hold-down",
    ],
)
def test_a_scenario_sets_no_more_than_an_aircraft(name: str) -> None:
    with pytest.raises(ValueError, match=r"is JSBSim's own, not a property of an aircraft"):
        uavsim.fly("catapult", overrides=[f"aircraft.properties.{name}=1e9"])
