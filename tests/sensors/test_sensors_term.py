"""Terms of a description: optional ones may be missing in a user's file, required ones are named all at once."""

from dataclasses import fields, replace
from math import inf
from pathlib import Path
from typing import Any

import pytest

from sensors import (
    Accelerometer,
    AccelerometerDescription,
    AccelerometerErrors,
    PressureDescription,
    PressureErrors,
    PressureSensor,
    Streams,
    preset,
    presets,
)
from sensors.catalogue import sheet
from sensors.datasheet_bounds import ACCELEROMETER, MODE, PRESSURE
from sensors.datasheet_check import check
from sensors.term import optional, terms

KINDS = {AccelerometerDescription: "mpu-6050", PressureDescription: "bmp390"}
FACTORS = {AccelerometerDescription: AccelerometerErrors, PressureDescription: PressureErrors}
SHIPPED = {  # optional terms that every shipped file has
    AccelerometerDescription: {
        "noise_rate_floor", "scale_tc_percent", "scale_tc_limit_percent", "cross_axis_percent",
        "cross_axis_limit_percent", "nonlinearity_percent", "rectification_ug", "rate_percent", "rate_limit_percent",
    },
    PressureDescription: {
        "solder_pa", "acceleration_pa", "acceleration_limit_pa", "rate_percent", "rate_limit_percent",
    },
}  # fmt: skip


def without(name: str, keys: set[str], folder: Path) -> Path:
    """A user's own file: a shipped one that lacks some keys and their sources."""
    lines = (Path(__file__).parents[2] / "sensors" / "datasheets" / f"{name}.toml").read_text(encoding="utf-8")
    own = folder / "own.toml"
    own.write_text(
        "\n".join(line for line in lines.splitlines() if line.partition(" = ")[0] not in keys), encoding="utf-8"
    )
    return own


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_lacks_newer_terms_has_none_of_them(kind: type[Any], tmp_path: Path) -> None:
    """Deviations are 0, limits none; everything else is as in the shipped file."""
    shipped = preset(KINDS[kind])
    own = preset(str(without(KINDS[kind], optional(kind), tmp_path)))
    for name, term in terms(kind).items():
        if term.key not in SHIPPED[kind] - {"noise_rate_floor"}:
            continue
        neutral = inf if name.endswith("_limit") else (0.0, 0.0) if name == "solder" else 0.0
        assert getattr(own, name) == neutral, name
        assert getattr(shipped, name) != neutral, name
    lacking = {name: getattr(own, name) for name, term in terms(kind).items() if term.key in optional(kind)}
    assert own == replace(shipped, name="own", **lacking)


def test_a_unit_without_newer_terms_has_no_such_error(tmp_path: Path) -> None:
    own = preset(str(without("mpu-6050", optional(AccelerometerDescription), tmp_path)))
    assert isinstance(own, AccelerometerDescription)
    unit = Accelerometer(own, Streams(1))
    assert not any(map(any, (unit.scale_tc, unit.rectification, unit.nonlinearity, *unit.cross_axis)))
    assert unit.bias == Accelerometer(preset_of("mpu-6050"), Streams(1)).bias  # no draw of another term changes
    barometer = preset(str(without("bmp390", optional(PressureDescription), tmp_path)))
    assert isinstance(barometer, PressureDescription)
    head = PressureSensor(barometer, Streams(1))
    assert (head.solder, head.acceleration, head.rate_error) == (0.0, (0.0, 0.0, 0.0), 0.0)


def preset_of(name: str) -> AccelerometerDescription:
    part = preset(name)
    assert isinstance(part, AccelerometerDescription)
    return part


@pytest.mark.parametrize("name", presets())
def test_the_shipped_files_keep_their_terms(name: str) -> None:
    """Those that may be missing elsewhere, too; a term that is younger needs no shipped file."""
    assert sheet(name)["values"].keys() >= SHIPPED.get(type(preset(name)), set())


@pytest.mark.parametrize("kind", KINDS)
def test_a_deviation_without_a_limit_is_not_bounded(kind: type[Any], tmp_path: Path) -> None:
    limits = {key for key in optional(kind) if "limit" in key}
    own = preset(str(without(KINDS[kind], limits, tmp_path)))
    found = {name: getattr(own, name) for name, term in terms(kind).items() if term.key in limits}
    assert set(found.values()) == {inf}
    for factor, limit in ((0.0, 0.0), (3.0, inf)):
        errors = FACTORS[kind](**{f.name: factor for f in fields(FACTORS[kind]) if isinstance(f.default, float)})
        scaled = own.scaled(1.0, errors)  # type: ignore[arg-type]  # each kind has its own errors
        assert {getattr(scaled, name) for name in found} == {limit}


def test_a_limit_of_nothing_is_refused() -> None:
    part = sheet("mpu-6050")
    for table in ("values", "sources"):
        del part[table]["cross_axis_percent"]
    with pytest.raises(ValueError, match=r"values\.cross_axis_limit_percent limits values\.cross_axis_percent, which"):
        check(part)


@pytest.mark.parametrize(("kind", "rules"), [("accelerometer", ACCELEROMETER), ("pressure", PRESSURE)])
def test_all_required_keys_are_named_at_once(kind: str, rules: dict[str, Any]) -> None:
    """Of a file that says what kind it is and nothing else: one message, with it there is nothing left to name."""
    of = AccelerometerDescription if kind == "accelerometer" else PressureDescription
    with pytest.raises(ValueError, match=r"^keys .* are missing$") as caught:
        check({"kind": kind})
    named = str(caught.value).removeprefix("keys ").removesuffix(" are missing").split(", ")
    modes = [f"modes.{key}" for key in MODE] if kind == "pressure" else []
    wanted = [f"values.{key}" for key in rules if key not in optional(of)]
    tables = ["part", "document", "values", "sources", *(["modes"] if modes else [])]
    assert sorted(named) == sorted([*tables, *wanted, *modes])


@pytest.mark.parametrize("kind", FACTORS)
def test_a_factor_multiplies_its_terms_and_no_other(kind: type[Any]) -> None:
    shipped = preset(KINDS[kind])
    part = replace(shipped, **{name: 0.5 for name in terms(kind) if getattr(shipped, name) in (0.0, inf)})
    for field in fields(FACTORS[kind]):
        if not isinstance(field.default, float):
            continue
        twice = part.scaled(1.0, FACTORS[kind](**{field.name: 2.0}))  # type: ignore[arg-type]
        changed = {name for name in terms(kind) if getattr(twice, name) != getattr(part, name)}
        assert changed == {name for name, term in terms(kind).items() if term.factor == field.name}
