"""Presets in the terminal, and what a record on the bench shows of one: units and sources, in 80 columns."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sensors import presets
from sensors.bench import on_bench
from sensors.bench_log import read_bench_log
from sensors.catalogue import FOLDER, accelerometer, sheet
from sensors.noise_fit import Coefficient
from uavsim.studies.sensor_bench import Bench, put_on_bench
from uavsim.views import datasheets

Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def _plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("FORCE_COLOR", "NO_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)


def widest(text: str) -> int:
    return max(len(line) for line in text.splitlines())


# -- presets ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", presets())
def test_a_preset_shows_every_value_with_unit_and_source(name: str, capsys: Capture) -> None:
    datasheets.print_preset(name)
    out = capsys.readouterr().out
    head, body = out.split("\n\n", 1)
    file = sheet(name)
    title, document, *reach = head.splitlines()
    assert (title, document) == (f"{name}: {file['part']}", file["document"])
    assert bool(reach) == (file["kind"] == "differential")
    assert widest(body) <= 80
    assert body.count("…") == sum(source.count("…") for source in file["sources"].values())  # nothing is cut
    flat = re.sub(r"\W+", "", body)
    for key in file["values"]:
        assert datasheets._words(key) in body
    for source in file["sources"].values():
        assert re.sub(r"\W+", "", source)[:12] in flat
    assert "_" not in "".join(line.split("  ")[0] for line in body.splitlines())


def test_a_differential_part_says_at_which_airspeed_it_ends(capsys: Capture) -> None:
    """1 psi is Mach 0.308 in the standard air: 6895 Pa of 101 325 (NACA 1135, p_t/p = 1.0644 at Mach 0.30)."""
    datasheets.print_preset("ms4525do")
    assert "It ends at 104.9 m/s of airspeed at sea level and 121.1 m/s at 3000 m.\n" in capsys.readouterr().out
    datasheets.print_preset("sdp33")
    assert "where it reads 27 % less than the difference." in capsys.readouterr().out
    rows = {row["name"]: row["part"] for row in datasheets.preset_rows()}
    assert rows["sdp33"].endswith("; to 48 m/s")
    assert "m/s" not in rows["bmp390"]


def test_units_of_a_preset_are_those_that_are_read(capsys: Capture) -> None:
    datasheets.print_preset("lsm6dso32")
    out = capsys.readouterr().out
    part = accelerometer("lsm6dso32")
    assert re.search(r"^ranges +4, 8, 16, 32 g ", out, re.MULTILINE)
    assert re.search(rf"^default rate +{part.rate:g} Hz ", out, re.MULTILINE)
    assert re.search(r"^noise density +120, 130, 160, 220 ", out, re.MULTILINE)
    assert re.search(r"^bandwidth +\(6\.25, 13, 26, ", out, re.MULTILINE)
    assert "µg/√Hz" in out


def test_every_unit_belongs_to_a_key_that_exists() -> None:
    keys: set[str] = set()
    for file in FOLDER.glob("*.toml"):
        part = sheet(file.stem)
        keys |= {*part["values"], *(key for mode in part.get("modes", []) for key in mode)}
    assert set(datasheets.PRESET_UNITS) <= keys
    without = {
        "default_mode", "default_filter", "filters", "poles", "iir_coefficients", "iir_weights", "scale", "scale_limit",
        "name",
    }  # fmt: skip
    assert keys - set(datasheets.PRESET_UNITS) == without


def test_an_unknown_preset_is_named() -> None:
    with pytest.raises(ValueError, match="nearest: adxl3"):
        datasheets.print_preset("adxl")


def test_a_file_of_ones_own_is_shown_by_its_path(tmp_path: Path, capsys: Capture) -> None:
    text = (FOLDER / "bmp390.toml").read_text(encoding="utf-8")
    part = next(line for line in text.splitlines() if line.startswith("part = "))
    (tmp_path / "mine.toml").write_text(text.replace(part, 'part = "a [part] of mine"'), encoding="utf-8")
    datasheets.print_preset(str(tmp_path / "mine.toml"))
    assert capsys.readouterr().out.startswith("mine: a [part] of mine\n")


def test_presets_are_a_line_each(capsys: Capture) -> None:
    datasheets.print_presets()
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == presets()


# -- the bench -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """Return an accelerometer with a log that has a hole, a word and a long name."""
    part = on_bench("adxl345")
    rng = np.random.default_rng(1)
    t = np.arange(20_000) / 100.0
    rows = np.column_stack((t, rng.normal(0.0, 0.02, (t.size, 3)) - np.array((0.0, 0.0, 9.8))))
    lines = [",".join(f"{x:.6f}" for x in row) for row in np.delete(rows, slice(500, 510), axis=0)]
    lines[3] = "0.03,nothing,0,0"
    log = tmp_path_factory.mktemp("log") / "a-log-with-a-name-that-is-rather-long.csv"
    log.write_text("\n".join(["t,fx,fy,fz", *lines]))
    read = read_bench_log(log, ("t", "fx", "fy", "fz"))
    return put_on_bench(part, hours=0.02, seed=1, log=read)


def rows_of(out: str, heading: str) -> list[list[str]]:
    """Return the cells of a quantity, a row for each axis."""
    lines = out.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(heading))
    rows = [lines[first][len(heading) :]]
    for line in lines[first + 1 :]:
        if not line.startswith(" ") or not line.strip().startswith(("fy", "fz")):
            break
        rows.append(line)
    return [re.split(r"  +", row.strip()) for row in rows]


def test_promised_and_found_stand_side_by_side_in_80_columns(compared: Bench, capsys: Capture) -> None:
    datasheets.print_bench(compared)
    out = capsys.readouterr().out
    assert widest(out) <= 80
    assert "adxl345 on the bench: ±16 g, 800 Hz, filter rate/2" in out
    head = next(line for line in out.splitlines() if "promised" in line)
    assert head.split() == ["promised", "simulated", "…-is-rather-long.csv"]
    rest = out.partition(head)[2].partition("Note:")[0]
    assert "…" not in rest.replace(" … ", "")  # nothing is cut
    found = rows_of(out, "white noise N, mm/s²·√s")
    assert [row[0] for row in found] == ["fx", "fy", "fz"]
    for row, promise, simulated, log in zip(
        found, compared.promises, compared.simulated, compared.compared, strict=True
    ):
        assert simulated.fit is not None
        assert log.fit is not None
        assert float(row[1]) == pytest.approx(1e3 * promise.N, rel=1e-3)
        for cell, fit in ((row[2], simulated.fit), (row[3], log.fit)):
            value, half = map(float, cell.split(" ± "))
            assert value == pytest.approx(1e3 * fit.N.value, abs=half / 5)
            assert half == pytest.approx(500.0 * (fit.N.high - fit.N.low), rel=0.05)
    density = rows_of(out, "density n = √2 N, µg/√Hz")
    assert float(density[2][1]) == pytest.approx(2**0.5 * compared.promises[2].N / 9.80665e-6, rel=1e-3)


def test_what_a_record_does_not_show_is_a_bound(compared: Bench, capsys: Capture) -> None:
    datasheets.print_bench(compared)
    out = capsys.readouterr().out
    cells = rows_of(out, "bias instability B, mm/s²")[0]
    fit = compared.simulated[0].fit
    assert fit is not None
    assert not fit.B.resolved
    assert cells[2] == f"below {1e3 * fit.B.high:.2g}"
    assert "the record does not show the term" in " ".join(out.split())


def test_what_was_done_to_a_log_is_told(compared: Bench, capsys: Capture) -> None:
    datasheets.print_bench(compared)
    out = " ".join(capsys.readouterr().out.split())
    assert "1 rows hold something else than numbers" in out
    assert "11 readings are missing in 2 gaps: filled in by straight lines" in out
    assert "weather" not in out  # of a barometer only


def test_a_record_that_does_not_move_has_no_figures(capsys: Capture) -> None:
    still = put_on_bench(on_bench("adxl345", noise_scale=0.0), hours=0.01, seed=1, unit="ideal")
    datasheets.print_bench(still)
    out = capsys.readouterr().out
    assert "a record that does not move has nothing to fit" in " ".join(out.split())
    assert "nan" not in out


@pytest.mark.parametrize(
    ("coefficient", "factor", "text"),
    [
        (Coefficient(1.5290, 1.5222, 1.5359, resolved=True), 1.0, "1.5290 ± 0.0069"),
        (Coefficient(1.5290, 1.5222, 1.5359, resolved=True), 1e3, "1529.0 ± 6.9"),
        (Coefficient(2.0, 1.002, 2.998, resolved=True), 1.0, "2.0 ± 1.0"),
        (Coefficient(250.0, 220.0, 290.0, resolved=True), 1.0, "250 ± 35"),
        (Coefficient(2.0, 2.0, 2.0, resolved=True), 1.0, "2.000 ± 0.000"),
        (Coefficient(0.4, 0.0, 0.512, resolved=False), 1.0, "below 0.51"),
        (Coefficient(0.51, 0.4, 1.31, resolved=True), 1.0, "0.4 … 1.3"),
    ],
)
def test_an_interval_has_the_digits_that_it_deserves(coefficient: Coefficient, factor: float, text: str) -> None:
    assert datasheets._with_interval(coefficient, factor) == text


def test_a_quantised_integral_is_told_if_it_shows(compared: Bench, capsys: Capture) -> None:
    one = compared.simulated[0]
    assert one.fit is not None
    shown = replace(one, fit=replace(one.fit, Q=Coefficient(1e-5, 0.9e-5, 1.1e-5, resolved=True)))
    datasheets.print_bench(replace(compared, simulated=(shown, *compared.simulated[1:])))
    assert rows_of(capsys.readouterr().out, "quantisation Q, mm/s²·s")[0][2] == "0.0100 ± 0.0010"
