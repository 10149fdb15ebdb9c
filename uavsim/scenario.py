"""What to fly: a scenario, read from TOML, validated against the settings that each room declares.

A file holds only what differs from the defaults below. `--set KEY=VALUE` changes single keys after that. An unknown
key is an error that names the nearest known one; bounds stand with each setting where it is declared.
"""

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Interval

from sensors import AccelerometerSettings, AirDataSettings, VibrationSettings
from uavsim.flight import without_none
from uavsim.onboard.airspeed import EstimatorSettings
from uavsim.onboard.flight_computer import STANDARD_GRAVITY, FlightComputerSettings
from uavsim.onboard.launch import DetectorSettings
from uavsim.plants.hangar import find_aircraft
from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings

Outcome = Literal["cruise", "missed_launch", "false_launch", "crashed", "diverged", "timeout"]

PACKAGED = Path(__file__).resolve().parent / "scenarios"


@dataclass(frozen=True, slots=True)
class Requirement:
    """A bound on a key of the score (joined by dots): `minimum` ≤ value ≤ `maximum`."""

    key: str
    minimum: float | None = None
    maximum: float | None = None


@dataclass(frozen=True, slots=True)
class Scenario:
    """One flight from the rail to cruise, as it is meant to be flown.

    Attributes
    ----------
    name, description
        For people.
    duration
        Of the record, s; the wait on the rail is part of it.
    seed
        Of everything that is drawn.
    expect
        The outcome that counts as success.
    requirements
        Bounds on figures of the score.
    """

    name: str = "scenario"
    description: str = ""
    duration: Annotated[float, Interval(ge=1, le=3600)] = 35.0
    seed: Annotated[int, Interval(ge=0, le=2**63 - 1)] = 1
    expect: Outcome = "cruise"
    aircraft: AircraftSettings = field(default_factory=AircraftSettings)
    environment: EnvironmentSettings = field(default_factory=EnvironmentSettings)
    launcher: LauncherSettings = field(default_factory=LauncherSettings)
    vibration: VibrationSettings = field(default_factory=VibrationSettings)
    accelerometer: AccelerometerSettings = field(default_factory=AccelerometerSettings)
    air_data: AirDataSettings = field(default_factory=AirDataSettings)
    detector: DetectorSettings = field(default_factory=DetectorSettings)
    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    flight_computer: FlightComputerSettings = field(default_factory=FlightComputerSettings)
    requirements: tuple[Requirement, ...] = ()

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], where: str = "scenario") -> "Scenario":
        """Validate nested plain values.

        Raises
        ------
        ValueError
            One line that names the key and what is allowed.
        """
        _known_keys(values, cls, where)
        _finite(values, where)
        scenario = _validated(values, where)
        _plausible(scenario, where)
        return scenario

    def to_dict(self) -> dict[str, Any]:
        """Nested plain values without the keys that hold None; `from_dict` takes them back."""
        plain: dict[str, Any] = without_none(asdict(self))
        return plain

    def with_seed(self, seed: int) -> "Scenario":
        """The same scenario with other draws."""
        return Scenario.from_dict({**self.to_dict(), "seed": seed})

    def renamed(self, name: str) -> "Scenario":
        """The same scenario under another name."""
        return replace(self, name=name)


def packaged() -> dict[str, str]:
    """Names of the packaged scenarios and what they are."""
    files = sorted(PACKAGED.glob("*.toml"))
    return {file.stem: tomllib.loads(file.read_text(encoding="utf-8")).get("description", "") for file in files}


def load_scenario(source: str | Path, *, overrides: Iterable[str] = (), seed: int | None = None) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    source
        A packaged name or the path of a TOML file.
    overrides
        ``KEY=VALUE`` each, with the key joined by dots and the value as TOML has it (quotes may be left out).
    seed
        Instead of the scenario's own.

    Raises
    ------
    ValueError
        One line that names file, key and what is allowed.
    """
    path = _find(source)
    where = path.name if path.parent != PACKAGED else path.stem
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not valid TOML: {error}") from None
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    values.setdefault("name", path.stem)
    _known_keys(values, Scenario, where)
    for override in overrides:
        _apply(values, override)
    if seed is not None:
        values["seed"] = seed
    return Scenario.from_dict(values, where)


def keys(kind: type = Scenario, prefix: str = "") -> list[str]:
    """Every key of a scenario, joined by dots."""
    found: list[str] = []
    for name, hint in _hints(kind).items():
        if is_dataclass(hint):
            found += keys(hint, f"{prefix}{name}.")  # type: ignore[arg-type]  # a class, not an instance
        else:
            found.append(prefix + name)
    return found


def _find(source: str | Path) -> Path:
    name = str(source)
    if (PACKAGED / f"{name}.toml").is_file() and "/" not in name:
        return PACKAGED / f"{name}.toml"
    path = Path(source).expanduser()
    if path.is_file():
        return path
    if path.is_dir() and (path / "scenario.toml").is_file():
        return path / "scenario.toml"
    known = [file.stem for file in sorted(PACKAGED.glob("*.toml"))]
    near = get_close_matches(name, known, n=1, cutoff=0.3)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise ValueError(f"unknown scenario {name!r}; {hint}packaged: {', '.join(known)}; or the path of a TOML file")


def _hints(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind)
    return {f.name: hints[f.name] for f in fields(kind)}


def _known_keys(values: Mapping[str, Any], kind: type, where: str, prefix: str = "") -> None:
    hints = _hints(kind)
    for key, value in values.items():
        if key not in hints:
            raise ValueError(f"{where}: unknown key {prefix + key!r}{_nearest(prefix + key)}")
        if is_dataclass(hints[key]):
            if not isinstance(value, Mapping):
                raise ValueError(f"{where}: {prefix}{key} is a group of keys, not a value ({value!r})")
            _known_keys(value, hints[key], where, f"{prefix}{key}.")  # type: ignore[arg-type]


def _nearest(key: str) -> str:
    known = keys()
    near = get_close_matches(key, known, n=1, cutoff=0.5)
    if not near:  # a right name in the wrong group is the next most likely slip
        last = key.rpartition(".")[2]
        near = [k for k in known if k.rpartition(".")[2] == last][:1]
    return f"; did you mean {near[0]!r}?" if near else f"; the groups are {', '.join(_hints(Scenario))}"


def _finite(value: Any, where: str, key: str = "") -> None:
    if isinstance(value, Mapping):
        for name, item in value.items():
            _finite(item, where, f"{key}.{name}" if key else name)
    elif isinstance(value, list | tuple):
        for item in value:
            _finite(item, where, key)
    elif isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{where}: {key} = {value}: must be a finite number")


def _apply(values: dict[str, Any], override: str) -> None:
    key, equals, text = override.partition("=")
    key, text = key.strip(), text.strip()
    if not equals or not key:
        raise ValueError(f"--set {override!r}: give it as KEY=VALUE")
    free = "aircraft.properties."  # its keys are JSBSim's names, which hold slashes and may hold dots
    if key.startswith(free):
        parts = ["aircraft", "properties", key.removeprefix(free)]
    elif key in keys():
        parts = key.split(".")
    else:
        raise ValueError(f"--set: unknown key {key!r}{_nearest(key)}")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    group = values
    for part in parts[:-1]:
        group = group.setdefault(part, {})
    group[parts[-1]] = value


def _validated(values: Mapping[str, Any], where: str) -> Scenario:
    from pydantic import TypeAdapter, ValidationError  # noqa: PLC0415 (only when something is read)

    try:
        return TypeAdapter(Scenario).validate_python(dict(values))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"] if not _is_branch(str(part)))
        message = first["msg"].removeprefix("Input ").removeprefix("Value error, ")
        raise ValueError(f"{where}: {key} = {first['input']!r}: {message}") from None


def _is_branch(part: str) -> bool:
    """Pydantic adds the tried member of a union to the location; a user has no such key."""
    return "[" in part or part in {"float", "int", "str", "none"}


def _plausible(s: Scenario, where: str) -> None:
    """What single bounds cannot tell."""
    find_aircraft(s.aircraft.model)
    launcher, air = s.launcher, s.air_data
    if launcher.wait_max < launcher.wait_min:
        raise ValueError(
            f"{where}: launcher.wait_max = {launcher.wait_max}: must be at least wait_min = {launcher.wait_min} s"
        )
    if air.tare == "covered" and air.tare_duration + air.cover_off > launcher.wait_min:
        raise ValueError(
            f"{where}: air_data.tare_duration = {air.tare_duration} and cover_off = {air.cover_off} s must fit into "
            f"the shortest wait, launcher.wait_min = {launcher.wait_min} s"
        )
    if s.duration <= launcher.wait_max:
        raise ValueError(f"{where}: duration = {s.duration}: must be longer than the wait, {launcher.wait_max} s")
    _reachable(s, where)


def _reachable(s: Scenario, where: str) -> None:
    """Refuse a threshold that the accelerometer can never show, and names or modes that do not exist."""
    try:
        part = s.accelerometer.description()
        s.air_data.total.description()
        s.air_data.static.description()
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    extra = s.accelerometer.bias if isinstance(s.accelerometer.bias, tuple) else (s.accelerometer.bias,)
    bias = max(min(3.0 * sd, limit) for sd, limit in zip(part.bias_sd, part.bias_limit, strict=True))
    bias += max(abs(b) for b in extra)
    scale = min(3.0 * part.scale_sd, part.scale_limit)
    reach = part.range * (1.0 - scale) - bias - STANDARD_GRAVITY
    trigger = s.detector.threshold if s.detector.trigger is None else s.detector.trigger
    level = max(s.detector.threshold, trigger)
    if level >= reach:
        raise ValueError(
            f"{where}: detector.threshold = {level:g} m/s²: {part.name} at ±{part.range_g:g} g can never be sure to show "
            f"it; less 1 g of gravity, {bias:.2f} m/s² of bias and {100 * scale:.1f} % of scale error the limit is "
            f"{reach:.1f} m/s²"
        )
