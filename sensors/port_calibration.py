"""A calibration of a head that somebody measured: the coefficients of both ports' errors, each with its deviation.

The law is that of `sensors.probe`, in shares of the impact pressure q_c = p_t − p_s:

    static port    c₀ + c_α z + c_αα z² + c_ββ y² + c_M M²           z = sin α cos β,  y = sin β
    total port     1 − 0.01 ((θ − 10°)/(θ_1 − 10°))² beyond 10°      cos θ = cos α cos β

A TOML file names them with their units and standard deviations (`read_coefficients`); a CSV table has both ports'
shares at Mach numbers and angles, and the law is fitted to it (`sensors.port_table`). Both are data only, and what is
not as it should be is refused in one line. The numbers are believed as they stand: nobody compares them with the head
that flies.
"""

import os
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, radians
from pathlib import Path
from typing import Any

from sensors.choice import choose, nearest, shown
from sensors.data_files import parse_toml, read_text
from sensors.port_table import fit
from sensors.rules import Rule, number, table, text
from sensors.sheet import Sheet

WORDS = ("unit", "none")
CALIBRATED = 1e-3  # of q_c, what a calibration of a head against a reference tube leaves: 0.05 % of the airspeed
CALIBRATED_SHARE = 0.1  # what it leaves of what angles and propeller make
USUAL_MACH = 0.3  # at which what is not known of a dependence on the Mach number counts
KIND = "head-calibration"
SENTENCE = 1000  # characters of the source

# A port that reads more than half of q_c is no static port; what angles make has the bounds of the simulated port.
_STATIC: dict[str, Rule] = {
    "error": number(-0.5, 0.5),
    "error_sd": number(0.0, 0.5, above=0.0),
    "error_alpha_per_rad": number(-10.0, 10.0),
    "error_alpha_sd_per_rad": number(0.0, 10.0),
    "error_alpha2_per_rad2": number(-100.0, 100.0),
    "error_alpha2_sd_per_rad2": number(0.0, 100.0),
    "error_beta2_per_rad2": number(-100.0, 100.0),
    "error_beta2_sd_per_rad2": number(0.0, 100.0),
    "error_mach2": number(-10.0, 10.0),
    "error_mach2_sd": number(0.0, 10.0),
}
_TOTAL: dict[str, Rule] = {"one_percent_angle_deg": number(10.0, 90.0, above=10.0)}
_SLIPSTREAM: dict[str, Rule] = {
    "total": number(-0.9, 5.0),
    "static": number(-0.9, 5.0),
    "sd_share": number(0.0, 1.0),
}
_TABLES = {"static": _STATIC, "total": _TOTAL, "slipstream": _SLIPSTREAM}
_OPTIONAL = ("total", "slipstream")
_UNITS = ("per_rad2", "per_rad", "per_deg2", "per_deg", "rad", "deg", "pa", "hpa", "percent", "mps")  # the longer first


@dataclass(frozen=True, slots=True)
class PortCalibration:
    """What a calibration found of both ports' errors.

    Attributes
    ----------
    error, error_alpha, error_alpha2, error_beta2, error_mach2 : float
        Coefficients of the static port.
    position_sd : float
        Standard deviation of what of c₀ and c_M M² is not known, a share of q_c.
    alpha_sd, alpha2_sd, beta2_sd : float
        Those of the three coefficients of the angles.
    limit : float or None
        Angle at which the total port loses one hundredth, rad; infinite of one that loses nothing; None: as its probe.
    slipstream : (total, static, sd) or None
        What the propeller adds at full throttle, and its standard deviation as a share of it; None: not measured.
    """

    error: float
    error_alpha: float
    error_alpha2: float
    error_beta2: float
    error_mach2: float
    position_sd: float
    alpha_sd: float
    alpha2_sd: float
    beta2_sd: float
    limit: float | None = None
    slipstream: tuple[float, float, float] | None = None


def captured(name: str) -> str:
    """Return "unit" or "none" as it is, and the path of a calibration's file with what stands in it.

    Raises
    ------
    ValueError
        As of `port_calibration`.
    """
    if name in WORDS:
        return name
    own = _sheet(name)
    port_calibration(own)
    return own


def port_calibration(name: str) -> PortCalibration:
    """Return what a calibration's file says, by its path.

    Raises
    ------
    ValueError
        One line that names the file and what is wrong: there is none, a key or column is missing, unknown or of the
        wrong unit, a number is none or beyond what can be.
    """
    own = _sheet(name)
    try:
        return _read(own.text, is_table=own.path.suffix == ".csv")
    except ValueError as error:
        raise ValueError(f"{own.path.name}: {error}") from None


def _sheet(name: str) -> Sheet:
    if isinstance(name, Sheet):
        return name
    path = _path_of(name)
    try:
        return Sheet(str(path.resolve()), read_text(path))
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None


def _path_of(name: str) -> Path:
    separators = filter(None, ("/", os.sep, os.altsep))
    if not name.endswith((".toml", ".csv")):
        if any(separator in name for separator in separators):
            raise ValueError(f"{shown(name)} is no calibration: its file's name must end in .toml or .csv")
        choose("calibration", name, (*WORDS, "FILE.toml", "FILE.csv"))
    path = Path(name)
    if not os.path.isfile(name):  # pathlib's raises for a name that is too long
        raise ValueError(f"calibration {shown(name)} is unknown: there is no such file")
    return path


@lru_cache(maxsize=64)  # a flight asks several times; by text, so that an edited file is read anew
def _read(content: str, *, is_table: bool) -> PortCalibration:
    return of_table(content) if is_table else read_coefficients(content)


def of_table(content: str) -> PortCalibration:
    """Return the law that comes nearest to a table; ValueError as of `fit`, or a coefficient is beyond what can be.

    A table states no deviations: those of a calibration against a reference tube are taken, `CALIBRATED` and
    `CALIBRATED_SHARE`, and what the law leaves of the table is added to the first.
    """
    found = fit(content)
    values = zip((key for key in _STATIC if "_sd" not in key), found.static, strict=True)
    for key, value in values:
        _STATIC[key](f"{key}, as the table has it,", value)
    error, alpha, alpha2, beta2, mach2 = found.static
    return PortCalibration(
        error=error,
        error_alpha=alpha,
        error_alpha2=alpha2,
        error_beta2=beta2,
        error_mach2=mach2,
        position_sd=hypot(CALIBRATED, found.left),
        alpha_sd=CALIBRATED_SHARE * abs(alpha),
        alpha2_sd=CALIBRATED_SHARE * abs(alpha2),
        beta2_sd=CALIBRATED_SHARE * abs(beta2),
        limit=found.limit,
    )


# -- coefficients ----------------------------------------------------------------------------------------------------


def read_coefficients(content: str) -> PortCalibration:
    """Return what a text in TOML says; ValueError, one line that names the key, if it is not as it should be."""
    sheet = parse_toml(content)
    if "kind" not in sheet:
        raise ValueError(f'key kind is missing: a calibration of a head has kind = "{KIND}"')
    if sheet["kind"] != KIND:
        raise ValueError(f"key kind is {shown(sheet['kind'])}: a calibration of a head has {KIND!r}")
    _keys("", sheet, ("kind", "source", *_TABLES), ("kind", "source", "static"))
    text(SENTENCE)("source", sheet["source"])
    for name, rules in _TABLES.items():
        if name not in sheet and name in _OPTIONAL:
            continue
        table(name, sheet[name])
        _keys(f"{name}.", sheet[name], tuple(rules), tuple(rules))
        for key, rule in rules.items():
            rule(f"{name}.{key}", sheet[name][key])
    s, total, blown = sheet["static"], sheet.get("total"), sheet.get("slipstream")
    return PortCalibration(
        error=float(s["error"]),
        error_alpha=float(s["error_alpha_per_rad"]),
        error_alpha2=float(s["error_alpha2_per_rad2"]),
        error_beta2=float(s["error_beta2_per_rad2"]),
        error_mach2=float(s["error_mach2"]),
        position_sd=hypot(s["error_sd"], s["error_mach2_sd"] * USUAL_MACH**2),
        alpha_sd=float(s["error_alpha_sd_per_rad"]),
        alpha2_sd=float(s["error_alpha2_sd_per_rad2"]),
        beta2_sd=float(s["error_beta2_sd_per_rad2"]),
        limit=None if total is None else radians(total["one_percent_angle_deg"]),
        slipstream=None if blown is None else (float(blown["total"]), float(blown["static"]), float(blown["sd_share"])),
    )


def _keys(where: str, found: dict[str, Any], allowed: tuple[str, ...], wanted: tuple[str, ...]) -> None:
    """Refuse keys that are unknown, of another unit, or missing."""
    for key in found:
        if key in allowed:
            continue
        for known in allowed:
            if _stem(key) == _stem(known):
                raise ValueError(f"key {shown(where + key)} has the wrong unit; wanted: {where}{known}{_unit(known)}")
        raise ValueError(f"key {shown(where + key)} is unknown; nearest: {where}{nearest(key, allowed, cutoff=0.0)}")
    missing = [where + key for key in wanted if key not in found]
    if missing:
        raise ValueError(
            f"keys {', '.join(missing)} are missing" if len(missing) > 1 else f"key {missing[0]} is missing"
        )


def _stem(key: str) -> str:
    return next((key.removesuffix(f"_{unit}") for unit in _UNITS if key.endswith(f"_{unit}")), key)


def _unit(key: str) -> str:
    return ", a share of q_c" if _stem(key) == key else ""
