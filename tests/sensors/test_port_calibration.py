"""A calibration's file is read as it is written, and what is wrong with it is said in one line.

Authority: the law of `sensors.probe`, evaluated by the probe itself; least squares of exact values give them back.
"""

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import pytest

from sensors import AirDataSettings, known_of_head
from sensors.port_calibration import PortCalibration, captured, port_calibration, read_coefficients
from sensors.port_table import COLUMNS, MOST_ROWS, fit
from sensors.probe import LIMITS, static_port, total_port
from sensors.settings import StaticPortSettings, TotalPortSettings
from sensors.sheet import Sheet

GOOD = """
kind = "head-calibration"
source = "wind tunnel, 12 to 35 m/s"

[static]
error = 0.03
error_sd = 0.003
error_alpha_per_rad = 0.1
error_alpha_sd_per_rad = 0.02
error_alpha2_per_rad2 = -0.6
error_alpha2_sd_per_rad2 = 0.05
error_beta2_per_rad2 = -0.5
error_beta2_sd_per_rad2 = 0.04
error_mach2 = 0.2
error_mach2_sd = 0.1

[total]
one_percent_angle_deg = 28

[slipstream]
total = 0.05
static = 0.04
sd_share = 0.2
"""
FOUND = PortCalibration(
    0.03, 0.1, -0.6, -0.5, 0.2, math.hypot(0.003, 0.009), 0.02, 0.05, 0.04, math.radians(28.0), (0.05, 0.04, 0.2)
)
PORT = StaticPortSettings(error=-0.1, error_alpha=0.2, error_alpha2=-1.5, error_beta2=-0.7, error_mach2=0.3)


def written(tmp_path: Path, content: str, name: str = "mine.toml") -> str:
    """Write a calibration and return its path."""
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    return str(path)


def survey(most_deg: float = 10.0, *, machs: tuple[float, ...] = (0.05, 0.1), betas: bool = True) -> str:
    """Return a table of what the simulated ports read, over angles up to this."""
    static, total = static_port(PORT), total_port(TotalPortSettings())
    assert static is not None
    assert total is not None
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(COLUMNS)
    angles = [math.radians(most_deg) * share for share in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    for mach in machs:
        for alpha in angles:
            for beta in angles if betas else [0.0]:
                arguments = (2e5, 1e5, mach, alpha, beta, 0.0)  # shares of 1e5 Pa
                rows.writerow([mach, alpha, beta, total(*arguments) / 1e5 - 1.0, static(*arguments) / 1e5 - 1.0])
    return out.getvalue()


def test_coefficients_are_read_as_they_are_written(tmp_path: Path) -> None:
    assert port_calibration(written(tmp_path, GOOD)) == FOUND
    short = GOOD[: GOOD.index("[total]")]
    assert read_coefficients(short) == replace(FOUND, limit=None, slipstream=None)


def test_the_documentations_example_is_a_calibration() -> None:
    page = (Path(__file__).parents[2] / "docs" / "sensors.md").read_text(encoding="utf-8")
    example = page.partition("### A calibration of your own")[2].partition("```toml\n")[2].partition("```")[0]
    found = read_coefficients(example)
    assert (found.error, found.alpha2_sd, found.slipstream) == (0.021, 0.1, (0.05, 0.04, 0.1))


def test_a_file_is_what_is_known_whatever_the_simulated_ports_do(tmp_path: Path) -> None:
    path = written(tmp_path, GOOD)
    ports = known_of_head(AirDataSettings(calibration=path, static_port=PORT)).ports
    assert (ports.error, ports.error_alpha, ports.error_alpha2, ports.error_beta2) == (0.03, 0.1, -0.6, -0.5)
    assert (ports.position_sd, ports.alpha_sd, ports.limit) == (FOUND.position_sd, 0.02, FOUND.limit)
    assert (ports.total_slipstream, ports.static_slipstream, ports.slipstream_sd) == (0.05, 0.04, 0.2)
    assert not ports.exact
    short = written(tmp_path, GOOD[: GOOD.index("[total]")])
    blown = AirDataSettings(calibration=short, total_port=TotalPortSettings(probe="kiel", slipstream=0.1))
    ports = known_of_head(blown).ports
    assert (ports.limit, ports.total_slipstream, ports.slipstream_sd) == (LIMITS["kiel"], 0.1, 1.0)


def test_a_table_gives_the_law_back_that_it_is_of(tmp_path: Path) -> None:
    found = port_calibration(written(tmp_path, survey(25.0), "table.csv"))
    expected = (PORT.error, PORT.error_alpha, PORT.error_alpha2, PORT.error_beta2, PORT.error_mach2)
    got = (found.error, found.error_alpha, found.error_alpha2, found.error_beta2, found.error_mach2)
    assert got == pytest.approx(expected, rel=1e-9)
    assert found.limit == pytest.approx(LIMITS["plain"], rel=1e-9)
    assert found.position_sd == pytest.approx(1e-3, rel=1e-6)
    assert found.alpha_sd == pytest.approx(0.02)
    assert found.beta2_sd == pytest.approx(0.07)


def test_what_a_table_does_not_tell_is_not_made_up() -> None:
    one = fit(survey(10.0, machs=(0.1,)))
    assert one.static[4] == 0.0
    assert one.static[0] == pytest.approx(PORT.error + PORT.error_mach2 * 0.01)
    assert one.limit is None  # it ends at 14° of flow
    lost = 1.0 - 0.01 * (4.1 / 10.0) ** 2
    assert 1.0 - lost > one.left > 0.0
    with pytest.raises(ValueError, match=r"fewer than 2 values of \|beta\|: what that angle makes cannot be told"):
        fit(survey(betas=False))


def test_what_the_law_leaves_of_a_table_is_not_known(tmp_path: Path) -> None:
    """Every second row 0.02 of q_c off: that has no place in the law."""
    head, *rows = survey().splitlines()
    for i in range(0, len(rows), 2):
        *before, static = rows[i].split(",")
        rows[i] = ",".join((*before, str(float(static) + 0.02)))
    found = port_calibration(written(tmp_path, "\n".join((head, *rows)), "table.csv"))
    assert found.position_sd == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('kind = "head-calibration"', "", r"key kind is missing"),
        ("head-calibration", "pressure", r"key kind is 'pressure': a calibration of a head has 'head-calibration'"),
        ("error_sd = 0.003", "", r"key static\.error_sd is missing"),
        ("[total]", "[totale]", r"key 'totale' is unknown; nearest: total"),
        ("error_alpha_per_rad", "error_alpha_per_deg", r"wrong unit; wanted: static\.error_alpha_per_rad"),
        ("error_alpha_per_rad", "error_alpha", r"wrong unit; wanted: static\.error_alpha_per_rad"),
        ("error = 0.03", "error_pa = 3.0", r"wrong unit; wanted: static\.error, a share of q_c"),
        ("error = 0.03", "error = 3.0", r"key static\.error is 3; it must be -0\.5 to 0\.5"),
        ("error = 0.03", "error = nan", r"key static\.error must be a finite number"),
        ("error = 0.03", "error = inf", r"key static\.error must be a finite number"),
        ("error = 0.03", 'error = "0.03"', r"key static\.error must be a number, not text"),
        ("error_sd = 0.003", "error_sd = 0", r"key static\.error_sd is 0; it must be above 0"),
        ("error_sd = 0.003", "error_sd = -1", r"key static\.error_sd is -1; it must be above 0"),
        ("angle_deg = 28", "angle_deg = 0.5", r"key total\.one_percent_angle_deg is 0\.5; it must be above 10"),
        ("angle_deg = 28", "angle_rad = 0.5", r"wrong unit; wanted: total\.one_percent_angle_deg"),
        ("sd_share = 0.2", "sd_share = 20", r"key slipstream\.sd_share is 20"),
        ("[total]", "[total", r"not valid TOML"),
        ("wind tunnel", "x" * 2000, r"key source has 2\d+ characters"),
    ],
)
def test_a_file_that_is_wrong_is_refused_in_one_line(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert old in GOOD
    with pytest.raises(ValueError, match=told) as error:
        captured(written(tmp_path, GOOD.replace(old, new, 1)))
    assert str(error.value).startswith("mine.toml: ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: "", "is empty"),
        (lambda t: t.replace("alpha", "alpha_deg", 1), "column 'alpha_deg' has the wrong unit; wanted: alpha, rad"),
        (lambda t: t.replace("static_share", "static_pa", 1), "wrong unit; wanted: static_share, a share of q_c"),
        (lambda t: t.replace("static_share", "cp", 1), "column 'cp' is unknown"),
        (lambda t: t.replace(",static_share", "", 1), "column static_share is missing"),
        (lambda t: t.replace("mach,", "mach,mach,", 1), "has a column twice"),
        (lambda t: t.replace("\n0.05,", "\n0.05,1,", 1), "line 2 has 6 cells; there are 5 columns"),
        (lambda t: t.replace("\n0.05,", "\nfast,", 1), "line 2: mach 'fast' is no number"),
        (lambda t: t.replace("\n0.05,", "\nnan,", 1), "line 2: mach must be 0 to 0.95, not nan"),
        (lambda t: t.replace("\n0.05,-0.17", "\n0.05,-10.17", 1), "alpha must be -1.57 to 1.57 rad, not -10.17"),
        (lambda t: "\n".join(t.splitlines()[:4]), "has 3 rows; the law has 5 coefficients"),
        (lambda t: t + "0.1,0,0,1,0\n" * MOST_ROWS, f"has more than {MOST_ROWS} rows"),
    ],
)
def test_a_table_that_is_wrong_is_refused_in_one_line(tmp_path: Path, change, told: str) -> None:
    with pytest.raises(ValueError, match=r"^table\.csv: ") as error:
        captured(written(tmp_path, change(survey()), "table.csv"))
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_a_table_whose_law_no_port_has_is_refused(tmp_path: Path) -> None:
    """Pressures in percent of q_c, say."""
    table = "\n".join((",".join(COLUMNS), *(f"0.1,{a},{b},1,1.9" for a in (-0.1, 0, 0.1) for b in (0, 0.1))))
    with pytest.raises(ValueError, match=r"error, as the table has it, is 1\.9; it must be -0\.5 to 0\.5"):
        captured(written(tmp_path, table, "table.csv"))


def test_paths_that_are_none(tmp_path: Path) -> None:
    assert captured("unit") == "unit"
    assert captured("none") == "none"
    (tmp_path / "folder.toml").mkdir()
    large = written(tmp_path, "#" * 1_000_001, "large.toml")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    for name, told in (
        ("units", "calibration 'units' is unknown; nearest: unit"),
        (str(tmp_path / "mine.yaml"), "must end in .toml or .csv"),
        (str(tmp_path / "missing.toml"), "there is no such file"),
        (str(tmp_path / "folder.toml"), "there is no such file"),
        ("x" * 300 + ".toml", "there is no such file"),
        ("x\0.csv", "there is no such file"),
        (large, "large.toml: is larger than"),
        (str(binary), "binary.toml: is not text in UTF-8"),
    ):
        with pytest.raises(ValueError, match=r"calib|large|binary") as error:
            captured(name)
        assert told in str(error.value)
        assert "\n" not in str(error.value)
    sheet = captured(written(tmp_path, GOOD))
    assert isinstance(sheet, Sheet)
    assert captured(sheet) == sheet
