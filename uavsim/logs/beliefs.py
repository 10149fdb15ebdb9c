"""What is believed of the sensors of a log.

What a named part's description says (`uavsim.beliefs`, the same as in flight), what the user says of the noise, or what
the log's quiet stretches show, each for the sensors that it is about. What no stretch at rest shows, and nobody has
said, is believed to be as large as it may be of usual parts; those numbers stand below, each with its reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot, inf

import numpy as np

from sensors import known_of_head
from sensors.bench_log import listed
from uavsim import airdata
from uavsim.beliefs import believed_air, believed_flow, believed_noise
from uavsim.cosim import Believed
from uavsim.logs.gusts import gust_of
from uavsim.logs.head import THICKEST, THINNEST, Channel, Head
from uavsim.logs.quiet import AVERAGED, Rests, Stretch, noise_of, noise_throughout, step_of
from uavsim.logs.recording import Recording
from uavsim.onboard.airspeed import EstimatorSettings, NoiseModel
from uavsim.onboard.airspeed.head_errors import HeadErrors
from uavsim.onboard.plausible import FASTEST
from uavsim.scenario import Scenario

KEYS = ("air_data", "accelerometer", "estimator", "flight_computer", "environment", "vibration", "mismatch", "detector")
"""Groups of a scenario's keys that mean something for a log."""

ACCELEROMETER_OFFSET = 0.5  # m/s²: 50 mg, three standard deviations of a calibrated part, one of a plain one
ACCELEROMETER_SCALE = 0.02  # consumer parts are specified within 1 to 3 %
POSITION = 0.02  # of q_c: what a static port on a fuselage is off by; autopilots calibrate it by a factor in flight
DIFFERENCE_SCALE = 0.01  # of a differential sensor: the total error band of usual parts
WARMTH, BOARD = 10.0, 5.0  # K: of a temperature that is assumed; of one that is read on a board
ABSOLUTE_PAIR, ONE_SENSOR = 60.0, 30.0  # Pa: two barometers that nobody has tared; a differential sensor
STATIC_OFFSET = 200.0  # Pa: 17 m, a barometer's absolute accuracy
HEIGHT_OFFSET = 5000.0  # Pa: 400 m, where a height is above a field that nobody has named
LEARNT = 3.0  # Pa, of the offset of a pair that is not tared, that may be learnt in flight. By hand
MOST_SHARE = 0.5  # of the impact pressure, that the rest of it counts as
WALK = 0.05  # Pa/√s, of the difference: 0.5 Pa in a hundred seconds. A log's rest cannot tell it from wind
GUST = 1.0  # m/s, of turbulence that nobody has declared and that the log does not show: σ_u of a moderate wind
OPEN_WIND = 3.0  # m/s, in which aircraft are launched, where nobody has declared one: a gentle breeze
STATIC_NEAR = 60.0  # Pa, 5 m: so near to its lowest place an aircraft hardly flies
LEAST_SD = 0.3  # Pa: no part of a UAV is quieter by more than a filter that hides it
SHAKEN = 0.05  # s, of means of a shaken force: longer ones hold what the aircraft does
LEAST_FORCE_SD = 0.3  # m/s²: what the model is off by at this rate


@dataclass(frozen=True, slots=True)
class Noise:
    """What the user says of the noise: standard deviations of one reading, SI; None: nothing."""

    total: float | None = None
    static: float | None = None
    temperature: float | None = None
    force: float | None = None


NAMES = {
    "p_total": "total", "p_difference": "total", "p_static": "static", "temperature": "temperature", "fx": "force",
}  # fmt: skip
MOST_NOISE = 1e5  # SI


def parse_noise(text: str) -> Noise:
    """Read ``p_total=2.4,p_static=1.2,temperature=0.5,fx=0.8``; ValueError, one line, if it is not of that form."""
    found: dict[str, float] = {}
    for part in text.split(","):
        name, sign, value = (piece.strip() for piece in part.partition("="))
        try:
            number = float(value)
        except ValueError:
            number = -inf
        if not sign or name not in NAMES or not 0.0 < number <= MOST_NOISE:
            raise ValueError(
                f"{part.strip()[:40]!r}: give it as NAME=SD,… in our units, NAME one of {listed(list(NAMES))} and SD "
                f"the standard deviation of a reading, above 0 and up to {MOST_NOISE:g}"
            )
        found[NAMES[name]] = number
    return Noise(**found)


@dataclass(frozen=True, slots=True)
class Sourced:
    """A belief, and a sentence each of where it comes from."""

    told: Believed
    said: tuple[str, ...]


def believed_of_log(
    recording: Recording,
    head: Head,
    scenario: Scenario,
    *,
    named: Sequence[str],
    noise: Noise,
    rests: Rests,
) -> Sourced:
    """What the onboard code believes of a log's sensors.

    Parameters
    ----------
    recording, head
        The log.
    scenario
        The packaged one with the user's keys.
    named
        Those keys, without their values.
    noise
        What the user says of it.
    rests
        Of the log.
    """
    of_parts, ours = believed_noise(scenario), _from_log(recording, head, rests)
    stretches = rests.still or rests.calm
    where = (
        f"{len(stretches)} quiet stretches"
        if len(stretches) > 1
        else "its quiet stretch"
        if stretches
        else "its flight"
    )
    fields: dict[str, object] = {}
    said = []
    for part, names, keys in _PARTS:
        chosen = [key for key in named if key.startswith(keys)]
        if chosen:
            fields |= {name: getattr(of_parts, name) for name in names}
        said.append(f"{part} by the description of {_part(scenario, part)}" if chosen else f"{part} by {where}")
    heads = {"total": ("air_data.total.", "air_data.differential."), "static": ("air_data.static.",)}
    both = [name for name, keys in heads.items() if any(key.startswith(keys) for key in named)]
    if len(both) == 2 or (both == ["total"] and head.differential):
        fields |= {name: getattr(of_parts, name) for name in _PAIR}
    elif any(key.startswith(("air_data.static_port", "air_data.total_port", "air_data.calibration")) for key in named):
        fields["head"] = of_parts.head
    by_user = {
        "total_sd": noise.total, "static_sd": noise.static,
        "temperature_sd": noise.temperature, "accelerometer_sd": noise.force,
    }  # fmt: skip
    fields |= {name: value for name, value in by_user.items() if value is not None}
    if any(value is not None for value in by_user.values()):
        said.append("--noise")
    elevation = scenario.flight_computer.rail_elevation_deg
    fields |= {
        "rail_elevation": None if elevation is None else of_parts.rail_elevation,
        "rail_elevation_sd": of_parts.rail_elevation_sd,
        "rail_roll": of_parts.rail_roll,
        "total_tuned_sd": None,
        "static_tuned_sd": None,
    }
    model = replace(ours, **fields)  # type: ignore[arg-type]
    flow = believed_flow(scenario) if head.differential and "total" in both else None
    length = scenario.estimator.aided.gust_length
    gust = gust_of(head, recording.readings, model, zero=_zero(head, stretches), length=length)
    air, of_air = _air(scenario, named, gust, _height(head) if stretches else 0.0)
    told = Believed(recording.rate, model, air, None, flow)
    numbers = (
        f"one reading has {model.total_sd:.2g} Pa ({'difference' if head.differential else 'total pressure'}), "
        f"{model.static_sd:.2g} Pa (static), {model.temperature_sd:.2g} K, {model.accelerometer_sd:.2g} m/s²"
    )
    return Sourced(told, (f"believed of the sensors: {'; '.join(said)}: {numbers}", of_air))


def known_age(scenario: Scenario, named: Sequence[str]) -> float:
    """How old a total pressure is at its time stamp by the description of its part, s; 0 where none is named."""
    if not any(key.startswith(("air_data.total.", "air_data.differential.")) for key in named):
        return 0.0
    known = known_of_head(scenario.air_data).total
    return 0.5 * known.window + known.lag


_PARTS = (
    (
        "total", ("total_sd", "total_window", "total_lag", "total_range", "total_step", "difference_scale_sd"),
        ("air_data.total.", "air_data.differential."),
    ),
    ("static", ("static_sd", "static_window", "static_lag", "static_range", "static_step", "static_offset_sd",
                "temperature_sd"), ("air_data.static.",)),
    (
        "accelerometer",
        ("accelerometer_sd", "accelerometer_scale_sd", "accelerometer_offset_sd", "lift_offset_sd", "accelerometer_lag",
         "accelerometer_range", "accelerometer_step", "accelerometer_white_sd", "side_offset_sd", "own_offset_sd",
         "own_side_offset_sd", "own_lift_offset_sd", "accelerometer_wander_sd"),
        ("accelerometer.",),
    ),
)  # fmt: skip
"""Sensors, what is believed of each, and the keys that name its part."""
_PAIR = (
    "walk", "difference_sd", "acceleration", "acceleration_sd", "head", "thermometer_recovery",
    "thermometer_recovery_sd",
)  # fmt: skip
"""What is believed of the head as a whole, where both of its sensors are named."""


def _part(scenario: Scenario, sensor: str) -> str:
    if sensor == "accelerometer":
        return scenario.accelerometer.preset
    return scenario.air_data.sensors()[0 if sensor == "total" else 1].preset


def _from_log(recording: Recording, head: Head, rests: Rests) -> NoiseModel:
    """What the log itself shows, and what is usual where it does not."""
    total, static = (
        max(LEAST_SD, noise_of(channel, rests, averaged), step_of(channel) / 12.0**0.5)
        for channel, averaged in ((head.total, 0.0), (head.static, AVERAGED))
    )
    made_height = "baro_height" in head.made
    force = _force_noise(recording)
    clipped = [abs(one.level) for one in recording.clipping() if one.axis == "fx"]
    ends = min(clipped, default=inf)
    return NoiseModel(
        total_sd=total,
        static_sd=static,
        temperature_sd=WARMTH if head.temperature is None else BOARD,
        walk=WALK,
        accelerometer_sd=max(LEAST_FORCE_SD, force),
        accelerometer_scale_sd=ACCELEROMETER_SCALE,
        accelerometer_offset_sd=ACCELEROMETER_OFFSET,
        lift_offset_sd=ACCELEROMETER_OFFSET,
        side_offset_sd=ACCELEROMETER_OFFSET,
        own_offset_sd=ACCELEROMETER_OFFSET,
        own_side_offset_sd=ACCELEROMETER_OFFSET,
        own_lift_offset_sd=ACCELEROMETER_OFFSET,
        accelerometer_rate=recording.rate,
        accelerometer_range=(-ends, ends),
        head_rate=1.0 / head.total.period,
        total_step=step_of(head.total),
        static_step=step_of(head.static),
        difference_sd=ONE_SENSOR if head.differential else ABSOLUTE_PAIR,
        static_offset_sd=HEIGHT_OFFSET if made_height else STATIC_OFFSET,
        head=HeadErrors(position_sd=POSITION),
        differential=head.differential,
        difference_scale_sd=DIFFERENCE_SCALE if head.differential else 0.0,
    )


def _force_noise(recording: Recording) -> float:
    """Standard deviation of a reading of f_x as white noise, vibration included, by the log as a whole, m/s²."""
    t, force = recording.readings[:, 0], recording.readings[:, 1]
    good = np.isfinite(force)
    return noise_throughout(Channel("fx", t[good], force[good], ""), SHAKEN)


def untared(noise: NoiseModel, head: Head) -> NoiseModel:
    """What is believed of a pair that no rest has tared.

    Its offset could be learnt in flight, by how the pressure follows the force. In slow waves of an airspeed that the
    bias of f_x follows, too, that goes astray: 3 m/s in 14 s, at a told standard deviation of 0.7 m/s. So all of the
    offset but `LEARNT` counts as a share of the impact pressure, as an error of the ports does.
    """
    differences = head.differences[np.isfinite(head.differences)]
    impact = float(np.median(differences)) if differences.size else 0.0
    share = min(MOST_SHARE, noise.difference_sd / impact) if impact > 0.0 else MOST_SHARE
    ports = replace(noise.head, position_sd=hypot(noise.head.position_sd, share))
    return replace(noise, difference_sd=min(LEARNT, noise.difference_sd), head=ports)


def _zero(head: Head, stretches: list[Stretch]) -> float:
    """The pair's difference at rest, Pa; 0 where the log has no rest."""
    t, differences = head.total.t, head.differences
    at_rest = [differences[(t >= stretch.start) & (t <= stretch.end)] for stretch in stretches]
    values = np.concatenate(at_rest) if at_rest else np.zeros(0)
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else 0.0


def _height(head: Head) -> float:
    """Median height of the log's flight above its lowest place, m; 0 where it hardly leaves that."""
    pressure = np.clip(head.static.values, THINNEST, THICKEST)
    ground = float(np.percentile(pressure, 98.0))
    above = pressure[pressure < ground - STATIC_NEAR]
    if above.size < 0.1 * pressure.size:
        return 0.0
    return float(airdata.hypsometric_height(float(np.median(above)), ground, head.assumed_temperature))


def _air(scenario: Scenario, named: Sequence[str], gust: float | None, height: float) -> tuple[EstimatorSettings, str]:
    """What is believed of air and aircraft, and where that is from: unless it is declared, what the log shows."""
    settings = believed_air(scenario)
    given = {key.removeprefix("estimator.aided.") for key in named if key.startswith("estimator.aided.")}
    usual: dict[str, float | None] = {"lift_slope": 0.0, "flight_force": None}
    if any(key.startswith("environment.") for key in named) or "gust_sd" in given:
        said = f"turbulence along the path as it is declared: {settings.aided.gust_sd:.2f} m/s"
    else:
        usual["gust_sd"] = max(settings.aided.gust_floor, GUST if gust is None else gust)
        by = "a moderate wind's is assumed" if gust is None else "by the log's flight"
        said = f"turbulence along the path {by}: {usual['gust_sd']:.2f} m/s"
        usual |= {"gust_height": height, "rail_wind_sd": OPEN_WIND}
    aided = replace(settings.aided, **{name: value for name, value in usual.items() if name not in given})  # type: ignore[arg-type]
    fastest = settings.fastest if "estimator.fastest" in named else FASTEST
    return replace(settings, aided=aided, fastest=fastest), said
