"""`uavsim survey`: what it prints and writes, and one line for what cannot be."""

import json
import re
import shutil

import pytest

import uavsim
from uavsim.cli import main
from uavsim.plants.hangar import hangar


def run(monkeypatch, capsys, *arguments):
    monkeypatch.setattr("sys.argv", ["uavsim", "survey", *map(str, arguments)])
    with pytest.raises(SystemExit) as leaving:
        main()
    captured = capsys.readouterr()
    return leaving.value.code, captured.out, captured.err


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flights") / "one"
    uavsim.fly("catapult", seed=3, overrides=["duration=9"]).save(folder)
    return folder


def edited(tmp_path, old, new, name="mine"):
    """An aircraft without a JSBSim model whose geometry differs in one line."""
    text = (hangar() / "fw8" / "geometry.toml").read_text(encoding="utf-8")
    assert old in text
    folder = tmp_path / name
    folder.mkdir()
    (folder / "geometry.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    return folder


def test_survey_of_a_flight(monkeypatch, capsys, tmp_path, flight):
    out = tmp_path / "deep" / "out"
    code, printed, error = run(
        monkeypatch, capsys, "fw8", "--flights", flight, "--sections", "panels", "--out", out, "--no-plots"
    )
    assert (code, error) == (0, "")
    assert "total port: nose, tube" in printed
    assert "static port: nose, boom 1.5 diameters ahead" in printed
    assert re.search(r"^ +[0-9]+ nose, tube .*% \*$", printed, re.MULTILINE)
    assert re.search(r"^ +[0-9]+ nose, boom 1.5 diameters ahead .*% \*$", printed, re.MULTILINE)  # though not the first
    table = printed[printed.index("total pressure") : printed.index("*: the port")]
    assert max(map(len, table.splitlines())) <= 80
    assert set(re.findall(r"% ([a-z])$", table, re.MULTILINE)) == set(re.findall(r"^([a-z]): ", table, re.MULTILINE))
    assert printed.rstrip().endswith(str(out))
    assert {path.name for path in out.iterdir()} == {
        "survey.json", "survey.csv", "position_error.toml", "position_error.csv",
    }  # fmt: skip
    assert json.loads((out / "survey.json").read_text(encoding="utf-8"))["envelope"]["flights"] == [str(flight)]
    first = (out / "survey.csv").read_bytes()
    code, _, error = run(monkeypatch, capsys, "fw8", "--flights", flight, "--out", out)
    assert code == 2
    assert "is not empty" in error
    code, _, _ = run(
        monkeypatch,
        capsys,
        "fw8",
        "--flights",
        flight,
        "--sections",
        "panels",
        "--out",
        out,
        "--overwrite",
        "--no-plots",
    )
    assert code == 0
    assert (out / "survey.csv").read_bytes() == first


def test_without_flights_it_flies(monkeypatch, capsys, tmp_path):
    """An own aircraft without a JSBSim model is surveyed over fw8's flights."""
    folder = edited(tmp_path, 'name = "fw8"', 'name = "mine"')
    out = tmp_path / "out"
    code, printed, error = run(monkeypatch, capsys, folder, "--sections", "panels", "--out", out)
    assert (code, error) == (0, "")
    assert "catapult (seed 1), gusty (seed 1)" in printed
    data = json.loads((out / "survey.json").read_text(encoding="utf-8"))
    assert data["aircraft"] == "mine"
    assert (out / "map.png").is_file()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[fuselage]", "[body]", "fuselage: the group [fuselage] is missing"),
        ("x        = [0.00, 0.05", "x        = [0.10, 0.05", "fuselage.x: must increase"),
        ("diameter = [0.00,", "diameter = [0.02,", "fuselage.diameter: 0 at the nose"),
        ("diameter = [0.00, 0.08,", "diameter = [0.00,", "as many numbers in both"),
        ('airfoil = "naca4412"', 'airfoil = "clarky"', "wing.airfoil: 'clarky'"),
        ('airfoil = "naca4412"', "airfoil = 4412", "wing.airfoil: must name a section"),
        ('airfoil = "naca4412"', 'airfoil = "naca4499"', "4 to 30 % thickness"),
        ("incidence_deg = 0.0", "incidence_deg = 90.0", "wing.incidence_deg: must be from -30 to 30"),
        ("chord = 0.1667               # m, rect", "chord = 1e9 # m, rect", "wing.chord: must be from -100 to 100"),
        ("length = 0.815 ", "length = -0.815 ", "wing.length: must be above 0"),
        ("pivot = [0.560, 0.085]", "pivot = [0.560]", "wing.pivot: x and y"),
        ("tip_y = 0.285", "tip_y = 0.001", "tail.tip_y: must be beyond tail.root_y"),
        ("chord = 0.1667               # m, rect", "chord = true # m, rect", "wing.chord: must be a number"),
        ("[fuselage]", "[fuselage", "geometry.toml"),
    ],
)
def test_wrong_geometry_is_one_line(monkeypatch, capsys, tmp_path, flight, old, new, said):
    folder = edited(tmp_path, old, new)
    code, printed, error = run(monkeypatch, capsys, folder, "--flights", flight, "--out", tmp_path / "out")
    assert (code, printed) == (2, "")
    assert error.startswith("Error: ")
    assert error.count("\n") == 1
    assert said in error
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fw9",), "packaged: fw25, fw8;"),
        (("x8",), "no geometry.toml for aircraft 'x8'"),
        (("fw8", "--sections", "xfoil"), "--sections"),
        (("fw8", "--flights", "nowhere"), "--flights: nowhere"),
        (("fw8", "--seed", "-1"), "--seed"),
        ((), "AIRCRAFT"),
    ],
)
def test_wrong_arguments_are_one_line(monkeypatch, capsys, tmp_path, arguments, said):
    monkeypatch.chdir(tmp_path)
    code, printed, error = run(monkeypatch, capsys, *arguments)
    assert (code, printed) == (2, "")
    assert error.count("\n") == 1
    assert said in error
    assert list(tmp_path.iterdir()) == []


def test_a_flight_without_truth_is_refused(monkeypatch, capsys, tmp_path, flight):
    blind = tmp_path / "blind"
    shutil.copytree(flight, blind)
    (blind / "truth.parquet").unlink()
    code, _, error = run(monkeypatch, capsys, "fw8", "--flights", blind, "--out", tmp_path / "out")
    assert code == 2
    assert "truth" in error
