"""Short flights whose figures are kept: the net that sees any change of a number.

    python tests/golden_flights.py      # flies them, says what differs, and writes golden_flights.json anew

Each flight has its keys away from their defaults, so that a term which a default hides (a factor of 1, an angle of 0,
two equal windows) is at work in at least one of them. Kept of each flight are its events, the numbers of its score and,
of each column of each table, two sums: the root mean square, and the mean weighted with 1 + cos(√2 k), k the row's
number, which a shift by one row or an exchange of two rows changes, too.

A number that differs says that something computes otherwise than before; it does not say which of the two is right.
If the change is meant, write the file anew in the commit that makes it, and say there what changed and why.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import uavsim
from uavsim.flight import Flight

KEPT = Path(__file__).with_name("golden_flights.json")
CALIBRATION = Path(__file__).parent / "references" / "head_calibration.toml"
CLOSE = 1e-9  # of a column's root mean square, or of a figure of the score

PLACE = (
    "environment.ground_elevation=420", "environment.temperature_offset=14", "environment.latitude_deg=-33",
    "environment.wind_speed=4", "environment.wind_from_deg=60", "environment.turbulence_wind_20ft=3.5",
    "environment.turbulence_severity=5", 'environment.turbulence_model="mil-hdbk-1797"', "environment.wind_veer=25",
    'environment.wind_profile="power"', "environment.wind_exponent=0.21", "environment.sea_level_pressure=98700",
    "environment.humidity=0.6",
)  # fmt: skip
RAIL = (
    "launcher.heading_deg=35", "launcher.elevation_deg=17", "launcher.peak_specific_force_g=9.5", "launcher.rise=0.021",
    "launcher.fall=0.043", "launcher.stroke=4.4", "launcher.height=2.6", "launcher.friction=0.06",
    "launcher.force_spread=0.05", "launcher.force_factor=1.07",
    "launcher.wait_min=1.7", "launcher.wait_max=2.3", "plant.step_rate=2000",
)  # fmt: skip
SHAKING = (
    "vibration.waiting_rms_g=0.09", "vibration.stroke_rms_g=0.6", "vibration.flight_rms_g=0.12",
    "vibration.band_hz=[9,170]", "vibration.ring_hz=85", "vibration.ring_fraction=0.2", "vibration.ring_decay=0.08",
    'vibration.tones=[{frequency_hz=47,amplitude_g=[0.2,0.1,0.3],phase_deg=40,when="flight"},'
    '{frequency_hz=31,amplitude_g=[0.3,0.2,0.1],when="stroke"}]',
    'vibration.spectra=[{psd=[[20,0.0004],[90,0.0009],[180,0.0002]],when="waiting"}]',
)  # fmt: skip
MOUNTED = (
    "accelerometer.mounting_deg=[4,-7,91]", "accelerometer.mounting_error_deg=[0.4,-0.6,0.8]",
    "accelerometer.position=[0.12,-0.05,0.07]", "accelerometer.rate_error_percent=1.3", "accelerometer.jitter=0.0001",
    "accelerometer.delay=0.0016", "accelerometer.delay_jitter=0.0002", "accelerometer.bias=[0.05,-0.1,0.15]",
    "accelerometer.noise_scale=1.4", "accelerometer.vibration_scale=0.8", "accelerometer.thermal.self_heating=6",
    "accelerometer.thermal.lag=20", "accelerometer.thermal.powered_for=5", "accelerometer.errors.scale=1.5",
)  # fmt: skip
TUBES = (
    "air_data.position=[0.5,0.2,-0.1]", "air_data.rate=83", "air_data.tare_duration=0.7", "air_data.cover_off=0.4",
    "air_data.acceleration_sensitivity=true",
    'air_data.static.preset="ms5611"', 'air_data.static.mode="x1024/x1024"', "air_data.total.iir=2",
    "air_data.total.noise_scale=1.3", "air_data.static.noise_scale=0.8", "air_data.total.offset_pa=35",
    "air_data.total.rate_error_percent=1.5", "air_data.static.rate_error_percent=-2",
    "air_data.total_port.tube.length=0.4", "air_data.total_port.tube.diameter=0.0012",
    "air_data.total_port.tube.volume=9e-8", "air_data.static_port.tube.length=0.25",
    "air_data.static_port.tube.diameter=0.0016", "air_data.static_port.tube.direction=[-0.6,0.1,0.8]",
    'air_data.total_port.probe="plain"', "air_data.total_port.slipstream=0.02", "air_data.static_port.slipstream=0.03",
    "air_data.static_port.error=0.004", "air_data.static_port.error_alpha=0.03",
    "air_data.static_port.error_alpha2=0.1",
    "air_data.static_port.error_beta2=0.2", "air_data.static_port.error_mach2=0.05",
    "air_data.thermal.self_heating=5", "air_data.thermal.lag=25", "air_data.thermal.powered_for=8",
)  # fmt: skip
HELD = (
    "flight_computer.airspeed=30", "flight_computer.level_pitch_deg=1.2", "flight_computer.launch_pitch_deg=6.5",
    "flight_computer.climb_pitch_deg=4.5", "flight_computer.speed_margin=2.5", "flight_computer.height=22",
    "flight_computer.height_gain=0.009", "flight_computer.throttle_level=0.5", "flight_computer.throttle_gain=0.2",
    "flight_computer.throttle_rate=0.07", "flight_computer.throttle_climb=2.1", "flight_computer.wing_delay=0.13",
    "flight_computer.motor_delay=0.2", "flight_computer.stroke_end_level_g=1.3",
    "flight_computer.stroke_end_mean=0.014",
    "flight_computer.stroke_end_hold=0.026", "flight_computer.safe_throttle=0.62", "flight_computer.loss_time=0.16",
    "flight_computer.rail_elevation_deg=16.6", "flight_computer.rail_elevation_sd_deg=0.8",
    "flight_computer.rail_roll_deg=0.4",
)  # fmt: skip
BELIEVED = (
    "mismatch.total_noise=1.2", "mismatch.static_noise=0.9", "mismatch.drift=1.5", "mismatch.lag=0.8",
    "mismatch.acceleration=0.9", "mismatch.acceleration_sd=1.3", "mismatch.accelerometer_noise=1.1",
    "mismatch.accelerometer_scale=1.2", "mismatch.accelerometer_lag=1.1", "mismatch.temperature=1.4",
    "mismatch.gust=1.3", "mismatch.accelerometer_offset=1.2", "mismatch.wind=0.9", "mismatch.position=0.95",
    "mismatch.position_sd=1.5",
    "estimator.wind_sd=4", "estimator.aided.bias_time=4", "estimator.aided.gust_length=170",
    "estimator.aided.slope_time=4", "estimator.aided.replay=0.25", "estimator.vapour_fraction=0.01",
)  # fmt: skip
UNITS = (
    "accelerometer.range_g=16", 'accelerometer.filter="rate/10"', "accelerometer.errors.bias=0.5",
    "accelerometer.errors.cross_axis=2", "accelerometer.errors.nonlinearity=3", "accelerometer.errors.temperature=4",
    "accelerometer.errors.drift=5", "accelerometer.errors.random_walk=3", "accelerometer.errors.clock=1.5",
    'accelerometer.errors.drift_model="flicker"', "accelerometer.errors.saturation=false",
    "accelerometer.errors.quantisation=false", "accelerometer.thermal.self_heating=3",
    "air_data.acceleration_sensitivity=true", "air_data.total.normal=[0.8,0.1,0.6]", "air_data.static.normal=[0.3,0,1]",
    "air_data.static.iir=2", "air_data.static.offset_pa=-25", "air_data.thermal.self_heating=4",
    "air_data.thermal.lag=10", "air_data.thermal.powered_for=2",
    *(f"air_data.{sensor}.errors.{term}={factor}" for sensor, more in (("total", 1.0), ("static", 1.3))
      for term, factor in (("offset", 0.7 * more), ("solder", 1.2 * more), ("scale", 1.5 * more), ("drift", 2.0 * more),
                           ("temperature", 3.0 * more), ("acceleration", 1.6 * more), ("thermometer", 1.4 * more),
                           ("clock", 1.1 * more), ("random_walk", 2.5 * more), ("drift_model", '"flicker"'),
                           ("saturation", "false"), ("quantisation", "false"))),
    "air_data.total_port.tube.length=0.2", "air_data.total_port.tube.direction=[-0.9,0.2,0.3]",
    "air_data.static_port.tube.length=0.3", "air_data.static_port.tube.volume=8e-8",
)  # fmt: skip
AIDED = (
    "estimator.fastest=90", "estimator.aided.shear=1.3", "estimator.aided.gust_sd=0.7",
    "estimator.aided.gust_floor=0.3",
    "estimator.aided.gust_height=25", "estimator.aided.slope_rate=0.9", "estimator.aided.bias_sd=0.45",
    "estimator.aided.bias_rate=0.003", "estimator.aided.static_walk=0.4", "estimator.aided.on_rail=25",
    "estimator.aided.shear_along=0.4", "estimator.aided.launch_height=1.7", "estimator.aided.rail_wind_along=0.5",
    "estimator.aided.rail_wind_side=-0.4", "estimator.aided.rail_wind_down=0.1", "estimator.aided.rail_wind_sd=0.6",
    "estimator.aided.lift_slope=9.1", "estimator.aided.lift_zero=-0.06",
    "estimator.aided.lift_slope_sd=0.8", "estimator.aided.lift_zero_sd=0.02", "estimator.aided.lift_gust_sd=0.1",
    'air_data.calibration="none"',
    "air_data.thermometer_recovery=0.8",
    "estimator.aided.unfolding_time=0.5", "estimator.aided.unfolding_rate=1.3", "estimator.aided.flight_force=70",
    "mismatch.acceleration_calibration=0.5", "flight_computer.speed_gain_min=12",
    "aircraft.properties.ap/gain/pitch=0.3", "aircraft.mass_factor=1.06", "aircraft.cg_shift=-0.008",
    "aircraft.lift_factor=0.95", "aircraft.drag_factor=1.15", "aircraft.pitch_factor=1.1",
    "aircraft.thrust_factor=0.93",
    "aircraft.properties.inertia/pointmass-weight-lbs[1]=0.9",  # the right wing, which is 0.57 lb else: nothing is even
)  # fmt: skip
CLIMB = ("flight_computer.height=200", "flight_computer.climb_pitch_deg=5", "flight_computer.height_gain=0.01")
DISPERSED = (
    'dispersions=[{key="aircraft.mass_factor",distribution="normal",sd=0.02},'
    '{key="launcher.friction",distribution="truncated-normal",mean=0.02,sd=0.02,low=0},'
    '{key="aircraft.lift_factor",distribution="normal",sd=0.05,relative=true},'
    '{key="launcher.elevation_deg",distribution="uniform",low=11,high=14},'
    '{key="air_data.static.iir",distribution="choice",values=[0,2,4],weights=[1,2,1]}]'
)
NOT_TWICE = ("launcher.wait_min=1.7", "launcher.wait_max=1.9")  # a short wait: the flight is what is wanted


def port(which: str, fault: str) -> str:
    """Return the override that gives a port a fault."""
    return f"air_data.{which}_port.faults=[{{{fault}}}]"


Wanted = tuple[str, int, tuple[str, ...]]
FLIGHTS: dict[str, Wanted] = {
    "away": ("catapult", 11, (*PLACE, *RAIL, *SHAKING, *MOUNTED, *TUBES, *HELD, *BELIEVED, "duration=9")),
    "other-units": ("catapult", 29, (*UNITS, *AIDED, *NOT_TWICE, "duration=8")),
    "gust": ("gusty", 12, (
        *NOT_TWICE, "duration=9", "environment.wind_from_deg=-25", "environment.gust_delay=1",
        "environment.gust_length_s=1.7", 'environment.gust_at="rail-exit"', 'environment.gust_direction="left"',
        'environment.gust_shape="step"', "environment.roughness=0.3", "environment.turbulence_wind_20ft=5",
        'environment.gusts=[{speed=-3,direction="up",at="wings-commanded",delay=0.05,length_s=0.4}]',
        'accelerometer.preset="adxl345"', "air_data.pipe=0.05",
        'air_data.tare="open"', "estimator.aided.gust_height=0", "launcher.elevation_deg=9",
    )),
    "knock-and-launch": ("catapult", 13, (
        "launcher.wait_min=3.4", "launcher.wait_max=3.5", "duration=7.5", "flight_computer.rearm_delay=0.8",
        'accelerometer.faults=[{kind="offset",start=1.3,stop=1.36,size=95,axis="x"},'
        '{kind="dropout",start=4.4,stop=4.5,probability=0.5},{kind="spike",start=5,size=40,probability=0.01,axis="z"}]',
    )),
    "total-blocked-in-a-climb": ("catapult", 14, (
        *NOT_TWICE, *CLIMB, "duration=13", port("total", 'kind="blocked",start=6.5,stop=10.5'),
    )),
    "static-blocked-in-a-climb": ("catapult", 15, (
        *NOT_TWICE, *CLIMB, "duration=13", "flight_computer.level_pitch_deg=1", "air_data.static_port.tube.length=0.2",
        port("static", 'kind="blocked",start=6.5,stop=10'),
    )),
    "total-leaks": ("catapult", 16, (
        *NOT_TWICE, "duration=11", "air_data.total_port.tube.length=0.3", "air_data.static_port.error=0.002",
        'air_data.total_port.faults=[{kind="leak",start=5.5,time_constant=1.5},{kind="blocked",start=5.5}]',
    )),
    "slow-leak-in-gusts": ("gusty", 28, (
        *NOT_TWICE, "duration=15", "environment.gust_speed=0", "environment.turbulence_wind_20ft=6.5",
        'air_data.total_port.faults=[{kind="leak",start=9,time_constant=2},{kind="blocked",start=9}]',
        'air_data.total.faults=[{kind="dropout",start=5,stop=5.25}]',
    )),
    "ice-and-water": ("catapult", 17, (
        *NOT_TWICE, "duration=9", "air_data.total_port.tube.length=0.35", "air_data.static_port.tube.length=0.3",
        port("static", 'kind="water",start=4,stop=7,water_length=0.02'),
        port("total", 'kind="ice",start=5,stop=8,duration=2'),
    )),
    "pressures-jump": ("catapult", 32, (
        *NOT_TWICE, "duration=12", 'air_data.total.faults=[{kind="offset",start=5.5,stop=7,size=400}]',
        'air_data.static.faults=[{kind="offset",start=9,stop=10.5,size=-300}]',
    )),
    "knock-after-release": ("weak-launch", 33, (
        *NOT_TWICE, "duration=5.5", "flight_computer.rearm_delay=0.5",
        'accelerometer.faults=[{kind="offset",start=2.1,stop=2.16,size=60,axis="x"}]',
    )),
    "readings-go-wrong": ("cheap-sensors", 18, (
        *NOT_TWICE, "duration=9", 'environment.preset="humid"', "mismatch.humidity=0.4",
        'air_data.total.faults=[{kind="spike",start=3,stop=6,size=400,probability=0.03},{kind="stuck",start=7,stop=8}]',
        'air_data.static.faults=[{kind="invalid",start=5,stop=5.4},{kind="dropout",start=6,probability=0.3}]',
        'accelerometer.faults=[{kind="stuck",start=6,stop=6.2}]',
    )),
    "pressures-alone": ("catapult", 19, (
        *NOT_TWICE, "duration=7", 'estimator.kind="jump-adaptive"', "estimator.calibration=1.02",
        'detector.kind="multi-level-window"', "environment.wind_speed=3", "environment.wind_from_deg=200",
    )),
    "published": ("untared", 20, (
        *NOT_TWICE, "duration=7", 'estimator.kind="paper"', 'estimator.model="bernoulli"', "estimator.gain_total=0.6",
        "estimator.gain_static=0.4", "launcher.peak_specific_force_g=12",
    )),
    "constant-velocity": ("rough-rail", 21, (
        *NOT_TWICE, "index=3", "duration=6", 'estimator.kind="constant-velocity"', DISPERSED,
        'correlations=[{between=["aircraft.mass_factor","aircraft.lift_factor"],coefficient=0.6}]',
    )),
    "thermal-difference": ("gusty", 34, (
        *NOT_TWICE, "duration=9", 'air_data.kind="differential"', 'air_data.differential.preset="sdp33"',
        'air_data.differential.mode="average"', "air_data.differential.noise_scale=1.5", "air_data.pipe=0.2",
        "air_data.differential.offset_pa=-4", "air_data.differential.rate_error_percent=2",
        "environment.ground_elevation=1500", "mismatch.flow_through=0.8", "mismatch.difference_scale=1.3",
        *(f"air_data.differential.errors.{term}={factor}" for term, factor in (
            ("offset", 1.1), ("solder", 1.2), ("scale", 0.9), ("temperature", 1.4), ("thermometer", 1.5),
            ("drift", 1.6), ("random_walk", 1.7), ("clock", 1.8),
        )),
        'air_data.differential.errors.drift_model="flicker"',
        'air_data.differential.faults=[{kind="stuck",start=7,stop=7.5}]',
    )),
    "swapped-difference": ("catapult", 35, (
        *NOT_TWICE, "duration=6", 'air_data.kind="differential"', 'air_data.differential.polarity="reversed"',
        'air_data.differential.unit="typical"', "air_data.differential.normal=[0.9,0,0.2]",
        "air_data.acceleration_sensitivity=true", "air_data.differential.errors.acceleration=1.2",
        "air_data.differential.errors.saturation=false", "air_data.differential.errors.quantisation=false",
    )),
    "opens-on-the-rail": ("catapult", 26, (
        "launcher.wait_min=2.8", "launcher.wait_max=2.9", "duration=5",
        'accelerometer.faults=[{kind="offset",start=1.2,stop=1.45,size=95,axis="x"},{kind="dropout",start=3.3,stop=4}]',
    )),
    "into-the-ground": ("catapult", 27, (
        *NOT_TWICE, "duration=9", "launcher.peak_specific_force_g=5.5", "environment.wind_speed=11",
        "environment.wind_from_deg=170", "launcher.elevation_deg=3",
    )),
    "not-recognised": ("weak-launch", 22, ("duration=5", *NOT_TWICE)),
    "tunnel": ("wind-tunnel", 23, (
        "duration=9", "plant.wind_tunnel.speeds=[12,33,21]", "plant.wind_tunnel.hold=1.5", "plant.wind_tunnel.ramp=0.4",
        *NOT_TWICE, "plant.wind_tunnel.settling=0.2",
        "plant.wind_tunnel.turbulence=0.01", "plant.wind_tunnel.temperature_drift=0.05",
        "plant.wind_tunnel.alpha_deg=6", "plant.wind_tunnel.beta_deg=-4", "air_data.static_port.error_alpha=0.02",
        'air_data.total_port.probe="kiel"',
    )),
    "centrifuge": ("centrifuge-15g", 24, (
        "plant.centrifuge.arm=1.3", "plant.centrifuge.radius_error=0.02", "plant.centrifuge.spin_up=2",
        "plant.centrifuge.hold=2", "plant.centrifuge.spin_down=1.5", "duration=8", *NOT_TWICE,
        "accelerometer.mounting_deg=[0,3,0]",
    )),
    "launch-curve": ("launch-curve", 25, (
        "duration=4", *NOT_TWICE, 'plant.launch_curve.shape="trapezoid"', "plant.launch_curve.rise=0.01",
        "plant.launch_curve.noise_sd_g=0.5", "plant.launch_curve.length=0.25", "plant.launch_curve.fall=0.03",
        "accelerometer.errors.bandwidth=false",
    )),
    "launch-curve-that-rings": ("launch-curve", 30, (
        "duration=4", *NOT_TWICE, "plant.launch_curve.ring_fraction=0.4", "plant.launch_curve.ring_hz=90",
        "plant.launch_curve.ring_phase_deg=200", "plant.launch_curve.ring_decay=0.08",
    )),
    "torn-and-wet": ("catapult", 36, (
        *NOT_TWICE, "duration=9", "air_data.static_port.tube.length=0.25", "air_data.batch=0.6",
        port("total", 'kind="leak",start=6,stop=7.5,area=0.6'), port("static", 'kind="leak",start=7,area=2'),
        'air_data.thermometer_faults=[{kind="invalid",start=5,stop=5.4},{kind="dead",start=8,size=400}]',
    )),
    "cover-left-on": ("catapult", 37, (*NOT_TWICE, "duration=6", "air_data.cover_left_on=true")),
    "tubes-swapped": ("catapult", 38, (
        *NOT_TWICE, "duration=6", "air_data.swapped_tubes=true", 'accelerometer.faults=[{kind="dead",start=5,size=2}]',
    )),
    "both-iced": ("catapult", 39, (
        *NOT_TWICE, *CLIMB, "duration=12",
        'air_data.port_faults=[{kind="ice",start=5,duration=1.5,between_heights=[12,200]}]',
        'air_data.total.faults=[{kind="dead",start=10,size=90000}]',
    )),
    "calibrated-by-a-file": ("gusty", 40, (
        *NOT_TWICE, "duration=8", f"air_data.calibration={CALIBRATION}", "environment.wind_speed=7",
        "environment.wind_from_deg=50", "air_data.total_port.slipstream=0.04", "air_data.static_port.slipstream=0.03",
    )),
    "course": ("manoeuvres", 34, (
        *NOT_TWICE, "duration=15", "plant.flight_path.push=motor", "plant.flight_path.burn=2.5",
        "launcher.peak_specific_force_g=5.5", "environment.wind_speed=5", "environment.wind_from_deg=80",
        "environment.turbulence_wind_20ft=4", "plant.flight_path.wing_loading=20", "plant.flight_path.lift_slope=5.2",
        "plant.flight_path.zero_lift_deg=-3", "plant.flight_path.span=2.4", "air_data.total_port.slipstream=0.03",
        "plant.flight_path.legs=[{duration=2,airspeed=70,climb_deg=3,throttle=1},{duration=2,load_g=3,bank_deg=30},"
        "{duration=2,load_g=0},{duration=3,bank_deg=-50,climb_deg=2}]",
    )),
    "thrown": ("manoeuvres", 35, (
        *NOT_TWICE, "duration=6", "plant.flight_path.push=throw", "plant.flight_path.swing=0.25",
        "launcher.peak_specific_force_g=9", "plant.flight_path.wing_loading=6",
        "plant.flight_path.legs=[{duration=2,airspeed=17,climb_deg=8}]",
    )),
    "by-air": ("catapult", 61, (
        *NOT_TWICE, "duration=4.5", 'launcher.kind="pneumatic"', "launcher.hang_fire=0.15", "aircraft.mass_factor=1.1",
        "launcher.pneumatic.pressure=7.5e5", "launcher.pneumatic.vessel=0.017", "launcher.pneumatic.valve=0.031",
        "launcher.pneumatic.discharge=0.65", "launcher.pneumatic.opening=0.04", "launcher.pneumatic.bore=0.084",
        "launcher.pneumatic.dead=0.0003", "launcher.pneumatic.ratio=3.9", "launcher.pneumatic.travel=4.8",
        "launcher.pneumatic.efficiency=0.88", "launcher.pneumatic.carriage=3.1", "launcher.pneumatic.friction=31",
    )),
    "by-cord": ("catapult", 62, (
        *NOT_TWICE, "duration=4.5", 'launcher.kind="bungee"', "launcher.stroke=7.4", "launcher.ends_at=6.1",
        "launcher.bungee.stiffness=118", "launcher.bungee.stretch=7.3", "launcher.bungee.hysteresis=0.22",
        "launcher.bungee.mass=1.4", "launcher.force_factor=1.05",
    )),
    "by-motor": ("catapult", 63, (
        *NOT_TWICE, "duration=4.5", 'launcher.kind="electromechanical"', "launcher.stroke=6.2",
        "launcher.electromechanical.curve=[[0.04,60],[0.3,70],[0.5,0]]", "launcher.electromechanical.bandwidth=5",
        "launcher.electromechanical.largest_force=850", "launcher.electromechanical.carriage=4",
        "launcher.electromechanical.friction=22",
    )),
    "no-push": ("catapult", 64, (*NOT_TWICE, "duration=3", "launcher.misfire=true")),
    "tunnel-by-mach": ("mach06", 31, (
        "plant.wind_tunnel.machs=[0.2,0.45]", "plant.wind_tunnel.hold=1.5", "plant.wind_tunnel.ramp=0.3",
        "duration=7", *NOT_TWICE,
        "plant.wind_tunnel.turbulence=0.005", "plant.wind_tunnel.turbulence_length=0.8",
        'estimator.kind="constant-velocity"', "estimator.q_total=40", "estimator.q_static=20",
    )),
}  # fmt: skip


def fly(name: str) -> Flight:
    """Fly one of them."""
    scenario, seed, overrides = FLIGHTS[name]
    return uavsim.fly(scenario, seed=seed, overrides=overrides)


def sums(column: np.ndarray) -> list[float]:
    """Return how many are a number, their root mean square, and the mean that knows of their order."""
    values = np.asarray(column, dtype=float)
    known = np.isfinite(values)
    if not known.any():
        return [0]
    weights = 1.0 + np.cos(np.sqrt(2.0) * np.flatnonzero(known))
    values = values[known]
    return [int(known.sum()), float(np.sqrt(np.mean(values**2))), float(np.mean(weights * values))]


def numbers(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the leaves of nested plain values by their dotted keys."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if inner is None:
        yield key, value
        return
    for name, item in inner:
        yield from numbers(item, f"{key}.{name}" if key else str(name))


def figures(flight: Flight) -> dict[str, Any]:
    """Return what is kept of a flight."""
    score = {k: v for k, v in flight.score.items() if k != "versions"}
    found: dict[str, Any] = {"score": dict(numbers(score)), "events": dict(numbers(flight.events))}
    for table, frame in flight.tables.items():
        words = [name for name in frame.columns if frame[name].dtype.kind not in "biuf"]
        found[table] = {name: sums(frame[name].to_numpy()) for name in frame.columns if name not in words}
        for name in words:
            kinds, counts = np.unique(frame[name].to_numpy().astype(str), return_counts=True)
            found[table][name] = dict(zip(kinds.tolist(), counts.tolist(), strict=True))
    return found


def differs(kept: Any, found: Any) -> bool:
    """Whether two kept values are not the same but for rounding; of sums, against the root mean square."""
    if isinstance(kept, list) and isinstance(found, list) and len(kept) == len(found) == 3:
        scale = CLOSE * max(abs(kept[1]), 1e-12)
        return kept[0] != found[0] or abs(kept[1] - found[1]) > scale or abs(kept[2] - found[2]) > scale
    if isinstance(kept, float) and isinstance(found, int | float):
        return abs(kept - found) > CLOSE * max(abs(kept), 1e-3)
    return bool(kept != found)


def differences(kept: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """Say what differs, a line each."""
    lines = []
    for group in sorted(kept.keys() | found.keys()):
        before, now = kept.get(group, {}), found.get(group, {})
        for key in [*before, *(k for k in now if k not in before)]:
            if key not in before or key not in now or differs(before[key], now[key]):
                lines.append(f"{group} {key}: {before.get(key)} before, {now.get(key)} now")
    return lines


def read() -> dict[str, Any]:
    """Return what is kept."""
    kept: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8"))
    return kept


def write(all_figures: dict[str, Any]) -> None:
    """Keep figures, a line a table, so that a change is seen where it is."""
    flights = []
    for name, groups in all_figures.items():
        lines = (f"  {json.dumps(group)}: {json.dumps(values)}" for group, values in groups.items())
        flights.append(f" {json.dumps(name)}: {{\n" + ",\n".join(lines) + "\n }")
    KEPT.write_text("{\n" + ",\n".join(flights) + "\n}\n", encoding="utf-8")


def main() -> None:
    """Fly all, say what differs, write."""
    kept = read() if KEPT.exists() else {}
    found = {name: json.loads(json.dumps(figures(fly(name)))) for name in FLIGHTS}
    for name, groups in found.items():
        lines = differences(kept.get(name, {}), groups)
        outcome = groups["score"]["outcome"]
        sys.stdout.write("\n  ".join([f"{name}: {outcome}, {len(lines)} figures differ", *lines[:6]]) + "\n")
    write(found)


if __name__ == "__main__":
    main()
