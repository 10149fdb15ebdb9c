"""What to fly: a scenario, read from TOML, validated against the settings that each room declares.

A file holds only what differs from the defaults below. `--set KEY=VALUE` changes single keys after that. An unknown
key is an error that names the nearest known one; bounds stand with each setting where it is declared, and what they
cannot tell one by one is checked here.
"""

import math
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from annotated_types import Interval

from sensors import (
    AccelerometerSettings,
    AirDataSettings,
    DifferentialSettings,
    PressureSettings,
    VibrationSettings,
    port_calibration,
)
from sensors.catalogue import captured
from sensors.choice import nearest, shown
from sensors.data_files import parse_toml, read_toml
from sensors.settings import Fault, PortFault
from sensors.vibration import check as check_vibration
from uavsim import inputs, settings
from uavsim.files import without_none
from uavsim.onboard.airspeed import EstimatorSettings
from uavsim.onboard.flight_computer import STANDARD_GRAVITY, FlightComputerSettings
from uavsim.onboard.launch import DetectorSettings
from uavsim.onboard.launch.kinds import Need
from uavsim.onboard.launch.settings import kind_of, unread
from uavsim.plants.air.weather import PRESETS
from uavsim.plants.airframe import Airframe, read_airframe
from uavsim.plants.airframe.properties import OF_SIMULATOR
from uavsim.plants.choice import PlantSettings
from uavsim.plants.hangar import find_aircraft, hangar
from uavsim.plants.launchers.kinds import KEYS
from uavsim.plants.launchers.push import IDEAL
from uavsim.plants.plant import STEP_RATES
from uavsim.plants.rail import CONTACT_FREQUENCY, DAMPING_RATIO
from uavsim.plants.settings import AircraftSettings, EnvironmentSettings, LauncherSettings
from uavsim.plugins import PluginError, Source, check_options, find, of_class, plugged_in, source_of
from uavsim.requirements import Requirement
from uavsim.requirements import check as check_requirements
from uavsim.score_keys import Outcome
from uavsim.settings import SettingError
from uavsim.spread import Correlation, Dispersion
from uavsim.spread.check import check as check_spread
from uavsim.spread.key import find as find_key

if TYPE_CHECKING:
    from uavsim.flight import Flight

Belief = Annotated[float, Interval(ge=0.0, le=1000.0)]
Drawn = Annotated[int, Interval(ge=0, le=2**63 - 1)]

PACKAGED = Path(__file__).resolve().parent / "scenarios"
PROPERTIES = "aircraft.properties."
OF_THE_AIR = "air"  # root of what the plant tells an aircraft of the air's rotation
OPTIONS = ("detector.options.", "estimator.options.", "plant.options.")  # keys that a plug-in declares
WEATHER = "environment.preset"
MOST_STEPS = 3_600_000  # of the plant in a flight, an hour at the coarsest step; their truth takes 2 GB
MOST_READINGS = 6_000_000  # of one sensor in a flight, which take 1.4 GB and a minute
NAME = r"(?!.*[\u115f\u1160\u3164\uffa0])[^\W_][\w .+-]{0,99}"  # without the letters of Unicode that have no ink


@dataclass(frozen=True, slots=True)
class MismatchSettings:
    """What the filter believes of its sensors over what their descriptions say: 1 is the truth about them.

    A noise that is changed in `air_data` is known to the filter; one that is changed here is not.

    Attributes
    ----------
    total_noise, static_noise : float
        Factor on the standard deviation of a reading of the pressure.
    temperature : float
        Factor on the standard deviation of the temperature.
    drift : float
        Factor on the random walk of the pair's difference.
    lag : float
        Factor on the age of a pressure when its conversion ends: half the conversion, port, tube and digital filter.
    acceleration : float
        Factor on what is known of the pressure error per specific force: the air column in the tubes, and membranes.
    acceleration_sd : float
        Factor on the standard deviation of what is not known of it.
    acceleration_calibration : float
        Error of a calibration of the membranes' sensitivity, as a share of what is usual for the part.
    position : float
        Factor on what is known of the ports' errors: the probe's angle apart, position error and slipstream.
    position_sd : float
        Factor on the standard deviation of what is not known of them.
    accelerometer_noise : float
        Factor on the standard deviation of a reading of specific force, vibration included.
    accelerometer_scale : float
        Factor on the standard deviation of its scale error.
    accelerometer_offset : float
        Factor on the standard deviation of its offset.
    accelerometer_lag : float
        Factor on the age of a reading of specific force at its time stamp.
    difference_scale : float
        Factor on the standard deviation of the scale error of what flight adds to the pressures' difference.
    flow_through : float
        Share of what a thermal differential sensor loses by thin air and in its tubes that is undone; 0: nothing.
    gust : float
        Factor on the standard deviation of the turbulence that the environment declares, and on the mean wind's growth.
    wind : float
        Factor on the wind on the rail that the environment declares, and on its standard deviation; 0: none is known.
    humidity : float
        Factor on the share of vapour in the air.
    """

    total_noise: Belief = 1.0
    static_noise: Belief = 1.0
    temperature: Belief = 1.0
    drift: Belief = 1.0
    lag: Annotated[float, Interval(ge=0.0, le=10.0)] = 1.0
    acceleration: Annotated[float, Interval(ge=-10.0, le=10.0)] = 1.0
    acceleration_sd: Belief = 1.0
    acceleration_calibration: Annotated[float, Interval(ge=0.0, le=10.0)] = 0.3
    position: Annotated[float, Interval(ge=-10.0, le=10.0)] = 1.0
    position_sd: Belief = 1.0
    accelerometer_noise: Belief = 1.0
    accelerometer_scale: Belief = 1.0
    accelerometer_offset: Belief = 1.0
    accelerometer_lag: Annotated[float, Interval(ge=0.0, le=10.0)] = 1.0
    difference_scale: Belief = 1.0
    flow_through: Annotated[float, Interval(ge=0.0, le=10.0)] = 1.0
    gust: Belief = 1.0
    wind: Annotated[float, Interval(ge=0.0, le=10.0)] = 1.0
    humidity: Annotated[float, Interval(ge=0.0, le=10.0)] = 1.0


@dataclass(frozen=True, slots=True)
class Scenario:
    """One flight from the rail to cruise, as it is meant to be flown.

    Attributes
    ----------
    name, description
        For people.
    duration
        Of the record, s; longer than the wait on the rail, which is part of it.
    seed
        Of everything that is drawn.
    index
        Number of the flight under this seed: each draws its own.
    expect
        The outcome that counts as success.
    dispersions
        What is drawn anew for each flight; a flight's own scenario has them drawn, and none left.
    correlations
        How those go together.
    requirements
        Bounds on figures of the score, of each flight or of many.
    plugins
        Who flies that is not ours; written into a flight's folder, and then only they may fly it.
    """

    name: str = "scenario"
    description: str = ""
    duration: Annotated[float, Interval(ge=1, le=3600)] = 35.0
    seed: Drawn = 1
    index: Drawn = 0
    expect: Outcome = "cruise"
    plant: PlantSettings = field(default_factory=PlantSettings)
    aircraft: AircraftSettings = field(default_factory=AircraftSettings)
    environment: EnvironmentSettings = field(default_factory=EnvironmentSettings)
    launcher: LauncherSettings = field(default_factory=LauncherSettings)
    vibration: VibrationSettings = field(default_factory=VibrationSettings)
    accelerometer: AccelerometerSettings = field(default_factory=AccelerometerSettings)
    air_data: AirDataSettings = field(default_factory=AirDataSettings)
    detector: DetectorSettings = field(default_factory=DetectorSettings)
    estimator: EstimatorSettings = field(default_factory=EstimatorSettings)
    mismatch: MismatchSettings = field(default_factory=MismatchSettings)
    flight_computer: FlightComputerSettings = field(default_factory=FlightComputerSettings)
    dispersions: tuple[Dispersion, ...] = ()
    correlations: tuple[Correlation, ...] = ()
    requirements: tuple[Requirement, ...] = ()
    plugins: tuple[Source, ...] = ()

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], where: str = "scenario") -> "Scenario":
        """Validate nested plain values.

        Raises
        ------
        ValueError
            One line that names `where`, the key and what is allowed.
        """
        try:
            return _checked(values)
        except SettingError as error:
            raise ValueError(f"{where}: {error.problem}") from None

    def to_dict(self) -> dict[str, Any]:
        """Nested plain values without the keys that hold None; `from_dict` takes them back."""
        plain: dict[str, Any] = without_none(asdict(self))
        return plain

    @property
    def launch_axis(self) -> str:
        """Signed body axis of the launch: +x of an aircraft; of a rig the detector's, if it is one."""
        axes = self.detector.axes
        return "+x" if self.plant.chosen.flies or isinstance(axes, str) or len(axes) != 1 else axes[0]

    @property
    def push_factor(self) -> float:
        """What the push gives, over the specific force that the catapult is set for; it knows no aircraft's mass.

        Of a machine: its drive over the nominal one.
        """
        factor = self.launcher.force_factor
        ideal = self.launcher.kind == IDEAL
        return factor / self.aircraft.mass_factor if self.plant.chosen.flies and ideal else factor

    def with_seed(self, seed: int) -> "Scenario":
        """The same scenario with other draws; only the seed is checked, a flight of many costs no more than that.

        Raises
        ------
        ValueError
            One line: what a seed may be.
        """
        try:
            return replace(self, seed=settings.read(_Seed, {"seed": seed}).seed)
        except SettingError as error:
            raise ValueError(f"scenario: {error.problem}") from None

    def checked(self) -> "Scenario":
        """The same, checked like one that was read: one that was made in Python, or by `replace`, was not.

        Raises
        ------
        ValueError
            As `from_dict`.
        """
        return Scenario.from_dict(self.to_dict())


@dataclass(frozen=True, slots=True)
class _Seed:
    seed: Drawn


def scenario_of(flight: "Flight") -> Scenario:
    """The scenario of a flight, with its outside inputs as they were read then.

    Each key is read as declared. How the keys go together was checked before the flight.

    Raises
    ------
    ValueError
        One line that names the key and what is allowed.
    """
    try:
        return _with_inputs(settings.read(Scenario, flight.scenario), flight.scenario)
    except SettingError as error:
        raise ValueError(f"scenario: {error.problem}") from None


def packaged() -> dict[str, str]:
    """Names of the packaged scenarios and what they are."""
    return {name: _parsed(PACKAGED / f"{name}.toml").get("description", "") for name in packaged_names()}


def packaged_names() -> list[str]:
    """Names of the packaged scenarios."""
    return sorted(file.stem for file in PACKAGED.glob("*.toml"))


def load_scenario(
    source: str | Path, *, overrides: Iterable[str] = (), seed: int | None = None, seed_name: str = "seed"
) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    source
        A packaged name, the path of a TOML file, or a flight's folder.
    overrides
        ``KEY=VALUE`` each, with the key joined by dots and the value as TOML has it (quotes may be left out).
    seed
        Instead of the scenario's own.
    seed_name
        What the seed is called where the user gave it, for the error.

    Raises
    ------
    ValueError
        One line that names the file, ``--set`` or the seed's name, the key and what is allowed.
    """
    path = _find(source)
    where = path.stem if path.parent == PACKAGED else str(path)
    recorded = {"name": path.stem, **_parsed(path)}
    try:
        values = inputs.read(path.parent, recorded)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    origins: dict[str, str] = {}
    try:
        settings.read(Scenario, values)
        for override in overrides:
            origins[_apply(values, override)] = "--set"
        if seed is not None:
            values["seed"], origins["seed"] = seed, seed_name
        scenario = _checked(values)
        check_requirements(scenario.requirements)  # a record keeps what it was judged by, whatever a score has now
    except SettingError as error:
        given = [origin for key in error.keys for k, origin in origins.items() if _within(k, key) or _within(key, k)]
        raise ValueError(f"{[*given, where][0]}: {error.problem}") from None
    return scenario


def _within(key: str, group: str) -> bool:
    return f"{key}.".startswith(f"{group}.")


def keys() -> list[str]:
    """Every key of a scenario, joined by dots."""
    return settings.keys(Scenario)


# -- reading ---------------------------------------------------------------------------------------------------------


def _find(source: str | Path) -> Path:
    name = str(source)
    if name in packaged_names():
        return PACKAGED / f"{name}.toml"
    path = Path(os.path.expanduser(name))  # os.path's, for pathlib's raise for unknown users and for long names
    if name and os.path.isdir(path):
        if not os.path.exists(path / "scenario.toml"):
            raise ValueError(f"{name}: this folder holds no scenario.toml")
        return path / "scenario.toml"
    if name and os.path.exists(path):
        return path
    if "/" in name or name.endswith(".toml"):
        raise ValueError(f"{name}: there is no such file")
    near = nearest(name, packaged_names(), cutoff=0.3)
    hint = f"did you mean {near!r}? " if near else ""
    raise ValueError(
        f"unknown scenario {shown(name)}; {hint}packaged: {', '.join(packaged_names())}; or the path of a TOML file"
    )


def _parsed(path: Path) -> dict[str, Any]:
    try:
        return read_toml(path)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _apply(values: dict[str, Any], override: str) -> str:
    """Change one key; return it."""
    key, equals, text = (part.strip() for part in override.partition("="))
    if not equals or not key:
        raise ValueError(f"--set {shown(override)}: give it as KEY=VALUE")
    declared = not key.startswith((PROPERTIES, *OPTIONS))  # JSBSim's names hold slashes and may hold dots
    if declared and key not in keys():
        raise ValueError(f"--set: {settings.unknown(Scenario, key).problem}")
    value = value_of_text(text)
    is_text = declared and settings.hint_of(Scenario, key) is str
    _set(values, key, text if is_text and not isinstance(value, str) else value)
    return key


def _set(values: dict[str, Any], key: str, value: Any) -> None:
    """Put a value under a key joined by dots."""
    free = key.startswith(PROPERTIES)
    *groups, last = [*PROPERTIES.split(".")[:2], key.removeprefix(PROPERTIES)] if free else key.split(".")
    group = values
    for part in groups:
        group = group.setdefault(part, {})
        if not isinstance(group, dict):
            raise SettingError(f"--set {shown(key)}: {part} is a value, not a group")
    if key == WEATHER and value in list(PRESETS):  # one that is asked for comes before what the file says of the same
        for name in PRESETS[value].keys:
            group.pop(name, None)
    group[last] = value


def value_of_text(text: str) -> Any:
    """Read a value as TOML has it; what is none is text."""
    try:
        found = parse_toml(f"value = {text}")
    except ValueError:
        return text
    return found["value"] if list(found) == ["value"] else text


# -- checking --------------------------------------------------------------------------------------------------------


def _checked(values: Mapping[str, Any]) -> Scenario:
    """Validate, and look at what single bounds cannot tell.

    Raises
    ------
    SettingError
        On the first thing that is wrong.
    """
    values = _with_weather(values)
    scenario = _with_plugins(_with_inputs(settings.read(Scenario, values), values))
    _check_together(scenario)
    check_spread(scenario, _with_values)
    return scenario


def _check_together(scenario: Scenario) -> None:
    """Refuse what single bounds cannot tell.

    Raises
    ------
    SettingError
        On the first thing that is wrong.
    """
    for check in (
        _check_name, _check_properties, _check_step, _check_times, _check_launcher, _check_air, _check_sensors,
        _check_cost, _check_vibration,
        _check_directions, _check_faults, _check_detector,
    ):  # fmt: skip
        check(scenario)


def with_values(s: Scenario, values: Mapping[str, Any]) -> Scenario:
    """The same scenario with other values of some keys, and what came from outside as it was read.

    Parameters
    ----------
    s
        A scenario that was checked.
    values
        By key (`uavsim.spread.key`): joined by dots, an entry of a list as `KEY[0]`, a property by its name.

    Raises
    ------
    ValueError
        One line that names the key and what is allowed; `keys` are those concerned.
    """
    try:
        return _with_values(s, values)
    except SettingError as error:
        raise ImpossibleError(error) from None


class ImpossibleError(ValueError):
    """Values that a scenario cannot have; one line.

    Attributes
    ----------
    keys
        Those concerned.
    """

    def __init__(self, error: SettingError) -> None:
        super().__init__(error.problem)
        self.keys = error.keys


def _with_values(s: Scenario, values: Mapping[str, Any]) -> Scenario:
    """As `with_values`, with the errors of settings."""
    if WEATHER in values:
        s = _with_other_weather(s, values[WEATHER])
    for name, value in values.items():
        key = find_key(s, name)
        given = key.checked(value)
        if name in _CAPTURES:
            try:
                given = _CAPTURES[name](given)
            except ValueError as error:
                raise SettingError(f"{name}: {error}", name) from None
        s = key.put(s, given)
    if any(name.endswith(".kind") or name.startswith(OPTIONS) for name in values):
        s = _with_plugins(s)
    _check_together(s)
    return s


def _with_other_weather(s: Scenario, name: Any) -> Scenario:
    """The same with another weather by its name in place of the one that it has."""
    plain = EnvironmentSettings()
    was = PRESETS[s.environment.preset].keys if s.environment.preset in PRESETS else {}
    keys_ = {key: getattr(plain, key) for key, value in was.items() if _same(getattr(s.environment, key), value)}
    if name in list(PRESETS):
        keys_ |= {key: getattr(_weather(name), key) for key in PRESETS[name].keys}
    elif name != "":
        _with_weather({"environment": {"preset": name}})  # says what there is
    return replace(s, environment=replace(s.environment, **keys_))


def _weather(name: str) -> EnvironmentSettings:
    return settings.read(EnvironmentSettings, PRESETS[name].keys)


def _same(value: Any, plain: Any) -> bool:
    return bool(value == (tuple(plain) if isinstance(plain, list) else plain))


def _with_weather(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """The same with what a weather says by its name, where nothing else is said."""
    name = inputs.value_of(values, WEATHER)
    if not isinstance(name, str) or not name:
        return values
    if name not in PRESETS:
        near = nearest(name, PRESETS)
        hint = f"did you mean {near!r}? " if near else ""
        raise SettingError(f"{WEATHER} = {shown(name)}: is unknown; {hint}there are {', '.join(PRESETS)}", WEATHER)
    return {**values, "environment": {**PRESETS[name].keys, **values["environment"]}}


def _check_name(s: Scenario) -> None:
    if not re.fullmatch(NAME, s.name):
        raise SettingError(
            f"name = {s.name[:60]!r}: it names a folder, so it must begin with a letter or digit and go on with at "
            "most 99 of those, spaces and .+-_",
            "name",
        )


def _with_inputs(s: Scenario, values: Mapping[str, Any]) -> Scenario:
    """The same with what comes from outside as it was read: by `values`, or now."""
    for key, capture in _CAPTURES.items():
        given = inputs.value_of(values, key)
        found = inputs.value_of(asdict(s), key) if given is None else given
        try:
            s = _replaced(s, key.split("."), capture(found))
        except ValueError as error:
            raise SettingError(f"{key}: {error}", key) from None
    return s


def _with_plugins(s: Scenario) -> Scenario:
    """The same with each kind's own options as it declares them, and with who it is, if it is not ours."""
    named = {"detector": s.detector.kind, "estimator": s.estimator.kind, "plant": s.plant.kind}
    for what, name in named.items():
        key, was = f"{what}.kind", next((p for p in s.plugins if (p.group, p.name) == (f"uavsim.{what}s", name)), None)
        try:
            kind = find(what, name)
        except PluginError as error:
            if was is None:
                raise SettingError(f"{key} = {error}", key) from None
            raise SettingError(
                f"{key} = {name!r} is not registered here; it was flown with {was}; "
                + ("give that file to --plugin" if was.version is None else "install that package"),
                key,
            ) from None
        group = getattr(s, what)
        s = replace(s, **{what: replace(group, options=check_options(what, kind.options, group.options))})
        if was is not None and not was.is_(now := source_of(what, kind)):
            raise SettingError(
                f"{key}: was flown with {was}, and here is {now}; take [[plugins]] out of its scenario to fly it "
                "with this one",
                key,
                "plugins",
            )
    return replace(s, plugins=plugged_in(named))


def with_kinds(s: Scenario, **chosen: Any) -> Scenario:
    """The same scenario with other kinds, by name or class: `detector`, `estimator`, `plant`; None leaves it.

    Raises
    ------
    ValueError
        One line: it is not registered, no such class, or does not suit the scenario.
    """
    chosen = {what: named for what, named in chosen.items() if named is not None}
    if not chosen:
        return s
    values = s.to_dict()
    for what, named in chosen.items():
        name = named if isinstance(named, str) else of_class(what, named)
        own = values[what] if name == values[what]["kind"] else {}
        kept = {"axes": values[what]["axes"]} if what == "detector" else {}
        values[what] = {**own, **kept, "kind": name}
    return Scenario.from_dict(values, s.name) if values != s.to_dict() else s


def _airframe(model: str) -> str:
    """An aircraft of one's own with its files, checked; the name of a packaged one."""
    if isinstance(model, Airframe):
        return model
    folder = find_aircraft(model)
    return model if folder.parent == hangar().resolve() else read_airframe(folder)


_CAPTURES: dict[str, Callable[[str], str]] = {
    inputs.AIRCRAFT: _airframe,
    **dict.fromkeys(inputs.PRESETS, captured),
    inputs.CALIBRATION: port_calibration.captured,
}
"""What reads what comes from outside, by its key."""


def _replaced(group: Any, path: list[str], value: Any) -> Any:
    """The same settings with another value at a path."""
    name, *rest = path
    return replace(group, **{name: _replaced(getattr(group, name), rest, value) if rest else value})


def _check_properties(s: Scenario) -> None:
    for name in s.aircraft.properties:
        root = name.strip("/").partition("/")[0].partition("[")[0]
        if root == OF_THE_AIR:
            raise SettingError(
                f"{PROPERTIES}{name}: is how the air turns, which turbulence says; it may not be set", PROPERTIES + name
            )
        if root in OF_SIMULATOR:
            raise SettingError(
                f"{PROPERTIES}{name}: is JSBSim's own, not a property of an aircraft; it may not set {root}/…",
                PROPERTIES + name,
            )


def _check_step(s: Scenario) -> None:
    """Refuse steps that the rail's springs do not survive, and those that are no half of another."""
    rate, rates = s.plant.step_rate, f"{', '.join(map(str, STEP_RATES))} Hz"
    if rate in STEP_RATES:
        return
    coarse = f"the springs of the rail ({CONTACT_FREQUENCY:g} Hz, damping {DAMPING_RATIO:g}) do not survive it; "
    raise SettingError(
        f"plant.step_rate = {rate}: {coarse if rate < STEP_RATES[0] else ''}must be one of {rates}", "plant.step_rate"
    )


def _check_times(s: Scenario) -> None:
    launcher, air = s.launcher, s.air_data
    if launcher.wait_max < launcher.wait_min:
        raise SettingError(
            f"launcher.wait_max = {launcher.wait_max:g}: must be at least wait_min = {launcher.wait_min:g} s",
            "launcher.wait_max",
            "launcher.wait_min",
        )
    run = s.plant.length
    if run and s.duration < launcher.wait_max + run:
        raise SettingError(
            f"duration = {s.duration:g}: must hold the longest wait, launcher.wait_max = {launcher.wait_max:g} s, and "
            f"the run of plant.kind = {s.plant.kind!r}, {run:g} s",
            "duration",
            "launcher.wait_max",
            "plant",
        )
    if s.duration <= launcher.wait_max:
        raise SettingError(
            f"duration = {s.duration:g}: must be longer than the longest wait, launcher.wait_max = "
            f"{launcher.wait_max:g} s",
            "duration",
            "launcher.wait_max",
        )
    if air.tare != "none" and air.tare_duration + air.cover_off > launcher.wait_min:
        raise SettingError(
            f"air_data.tare_duration = {air.tare_duration:g} and cover_off = {air.cover_off:g} s: must fit into the "
            f"shortest wait, launcher.wait_min = {launcher.wait_min:g} s",
            "air_data.tare_duration",
            "air_data.cover_off",
            "launcher.wait_min",
            "air_data.tare",
        )


def _check_launcher(s: Scenario) -> None:
    """Refuse keys of the launcher that are of another kind, and machines where nothing is launched."""
    launcher, plain = s.launcher, LauncherSettings()
    for name in (name for kind, names in KEYS.items() if kind != launcher.kind for name in names):
        if getattr(launcher, name) != getattr(plain, name):
            raise SettingError(
                f"launcher.{name}: is not read by launcher.kind = {launcher.kind!r}",
                f"launcher.{name}",
                "launcher.kind",
            )
    own = ["kind"] if launcher.kind != IDEAL else []
    own += [name for name in ("hang_fire", "ends_at", "misfire") if getattr(launcher, name) != getattr(plain, name)]
    if own and s.plant.chosen.ours and not s.plant.chosen.flies:
        raise SettingError(
            f"launcher.{own[0]}: is not read by plant.kind = {s.plant.chosen.name!r}, a rig",
            f"launcher.{own[0]}",
            "plant.kind",
        )
    if launcher.ends_at is not None and launcher.ends_at >= launcher.stroke:
        raise SettingError(
            f"launcher.ends_at = {launcher.ends_at:g} m: must be below launcher.stroke = {launcher.stroke:g} m",
            "launcher.ends_at",
            "launcher.stroke",
        )
    times = [time for time, _ in launcher.electromechanical.curve]
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise SettingError(
            "launcher.electromechanical.curve: its times must rise from point to point",
            "launcher.electromechanical.curve",
        )


def _check_air(s: Scenario) -> None:
    """Refuse a law of wind that has none at the launcher."""
    air, height = s.environment, s.launcher.height
    if air.wind_profile == "log" and air.wind_speed > 0.0 and height <= air.roughness:
        raise SettingError(
            f"environment.roughness = {air.roughness:g} m: must be below launcher.height = {height:g} m: the "
            "logarithmic law has no wind under it",
            "environment.roughness",
            "launcher.height",
        )


def _check_sensors(s: Scenario) -> None:
    """Refuse parts, ranges, rates, filters and modes that do not exist, and what breaks a sensor that is not there."""
    air = s.air_data
    idle = "total" if air.kind == "differential" else "differential"
    if getattr(air, idle).faults:
        raise SettingError(
            f"air_data.{idle}.faults: a head of air_data.kind = {air.kind!r} has no such sensor",
            f"air_data.{idle}.faults",
            "air_data.kind",
        )
    for key, part in _parts(s):
        try:
            part.description()
        except ValueError as error:
            raise SettingError(f"{key}: {error}", key) from None


def _check_cost(s: Scenario) -> None:
    """Refuse a flight of more readings than a computer holds."""
    if s.duration * s.plant.step_rate > MOST_STEPS:
        raise SettingError(
            f"duration = {s.duration:g}: at plant.step_rate = {s.plant.step_rate} Hz it would give "
            f"{s.duration * s.plant.step_rate:.3g} rows of truth, and {MOST_STEPS} are the most; "
            f"{MOST_STEPS / s.plant.step_rate:g} s can be flown",
            "duration",
            "plant.step_rate",
        )
    for key, part in _parts(s):
        rate = part.description().rate
        if s.duration * rate > MOST_READINGS:
            raise SettingError(
                f"duration = {s.duration:g}: {key} at {rate:g} Hz would give {s.duration * rate:.3g} readings, and "
                f"{MOST_READINGS} are the most; {MOST_READINGS / rate:.0f} s can be flown",
                "duration",
                key,
            )


def _check_vibration(s: Scenario) -> None:
    low, high = s.vibration.band_hz
    if low >= high:
        raise SettingError(f"vibration.band_hz = [{low:g}, {high:g}]: must be a band, low first", "vibration.band_hz")
    try:
        check_vibration(s.vibration, 1.0 / s.plant.step_rate)
    except ValueError as error:
        raise SettingError(str(error), "vibration") from None


def _check_directions(s: Scenario) -> None:
    """Refuse vectors that only give a direction and have no length."""
    air = s.air_data
    for key, vector in (
        ("total.normal", air.total.normal),
        ("differential.normal", air.differential.normal),
        ("static.normal", air.static.normal),
        ("total_port.tube.direction", air.total_port.tube.direction),
        ("static_port.tube.direction", air.static_port.tube.direction),
    ):
        if vector is not None and not any(vector):
            raise SettingError(f"air_data.{key} = {list(vector)}: must have a length", f"air_data.{key}")


def _check_faults(s: Scenario) -> None:
    """Refuse faults that end before they begin."""
    for key, part in _parts(s):
        _check_order(f"{key}.faults", part.faults)
    _check_order("air_data.total_port.faults", s.air_data.total_port.faults)
    _check_order("air_data.static_port.faults", s.air_data.static_port.faults)
    _check_order("air_data.port_faults", s.air_data.port_faults)
    _check_order("air_data.thermometer_faults", s.air_data.thermometer_faults)


def _check_order(key: str, faults: Iterable[Fault | PortFault]) -> None:
    for i, fault in enumerate(faults):
        if fault.stop <= fault.start:
            raise SettingError(f"{key}[{i}].stop = {fault.stop:g}: must be after its start, {fault.start:g} s", key)
        band = fault.between_heights if isinstance(fault, PortFault) else None
        if band is not None and band[0] >= band[1]:
            raise SettingError(
                f"{key}[{i}].between_heights = [{band[0]:g}, {band[1]:g}]: must be a band, low first", key
            )


def _parts(
    s: Scenario,
) -> tuple[tuple[str, AccelerometerSettings | PressureSettings | DifferentialSettings], ...]:
    """Sensors that fly and the keys that they stand under."""
    first, static = s.air_data.sensors()
    return (
        ("accelerometer", s.accelerometer),
        ("air_data.differential" if isinstance(first, DifferentialSettings) else "air_data.total", first),
        ("air_data.static", static),
    )


def _check_detector(s: Scenario) -> None:
    """Refuse what the detector that was chosen does not read, can never see, or sees only after the stroke."""
    kind = kind_of(s.detector)
    for key in unread(s.detector):
        raise SettingError(
            f"detector.{key}: is not read by kind = '{kind.name}', which reads {', '.join((*kind.reads, 'axes'))}",
            f"detector.{key}",
            "detector.kind",
        )
    if not kind.many_axes and (s.detector.axes == "any" or len(s.detector.axes) != 1):
        raise SettingError(f"detector.axes: must be one signed axis for kind = '{kind.name}'", "detector.axes")
    if kind.need is None:
        return
    if s.launcher.kind != IDEAL:  # what a machine gives is known with the aircraft's mass
        return
    push = s.launcher.peak_specific_force_g * STANDARD_GRAVITY * (1.0 + s.launcher.force_spread) * s.push_factor
    need = kind.need(s.detector, push)
    if need.level_key == "trigger" and need.level < s.detector.threshold:
        raise SettingError(
            f"detector.trigger = {need.level:g}: must be at least the threshold, {s.detector.threshold:g} m/s²",
            "detector.trigger",
            "detector.threshold",
        )
    _check_reach(s, need)
    shortest = math.sqrt(2.0 * s.launcher.stroke / push)  # all of the push from the start, nothing against it
    if need.time >= shortest:
        raise SettingError(
            f"detector.{need.time_key}: takes {1e3 * need.time:.0f} ms, and a stroke of {s.launcher.stroke:g} m at "
            f"{push:.1f} m/s² lasts no more than {1e3 * shortest:.0f} ms",
            f"detector.{need.time_key}",
            "launcher.stroke",
            "launcher.peak_specific_force_g",
        )


def _check_reach(s: Scenario, need: Need) -> None:
    """Refuse a level that the accelerometer can never be sure to show."""
    part = s.accelerometer.description()
    own = s.accelerometer.bias if isinstance(s.accelerometer.bias, tuple) else (s.accelerometer.bias,)
    bias = max(min(3.0 * sd, limit) for sd, limit in zip(part.bias_sd, part.bias_limit, strict=True))
    bias += max(abs(b) for b in own)
    scale = min(3.0 * part.scale_sd, part.scale_limit)
    reach = part.range * (1.0 - scale) - bias - STANDARD_GRAVITY
    if need.level >= reach:
        raise SettingError(
            f"detector.{need.level_key} = {need.level:g} m/s²: {part.name} at ±{part.range_g:g} g can never be "
            f"sure to show it; less 1 g of gravity, {bias:.2f} m/s² of bias and {100 * scale:.1f} % of scale error the "
            f"limit is {reach:.1f} m/s²",
            f"detector.{need.level_key}",
            "accelerometer",
        )
