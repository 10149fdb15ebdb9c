"""What every plant hands on: the fields of the truth, their units and frames.

A plant steps at a fixed interval and records one row a step. The columns below are what a flight on disk holds;
positions are NED relative to the point of release, attitudes are Euler angles (yaw-pitch-roll), rates and specific
force are in body axes (forward, right, down).
"""

UNITS: dict[str, str] = {
    "t": "s",
    "airspeed": "m/s",  # of the centre of gravity relative to the air with its wind, gusts and turbulence
    "mach": "1",
    "p_static": "Pa",  # of the undisturbed air at the aircraft
    "p_total": "Pa",  # isentropic, from p_static and mach: at the centre of gravity, as alpha and beta
    "temperature": "K",  # static, of the air
    "fx": "m/s^2",  # specific force at the accelerometer: what an ideal one feels, without vibration
    "fy": "m/s^2",
    "fz": "m/s^2",
    "north": "m",
    "east": "m",
    "altitude": "m",  # above mean sea level
    "vn": "m/s",
    "ve": "m/s",
    "vd": "m/s",
    "wind_n": "m/s",  # velocity of the air over the ground, turbulence and gusts included
    "wind_e": "m/s",
    "wind_d": "m/s",
    "roll": "rad",
    "pitch": "rad",
    "heading": "rad",  # continuous: it does not jump where a compass goes from 360° to 0
    "p": "rad/s",
    "q": "rad/s",
    "r": "rad/s",
    "alpha": "rad",
    "beta": "rad",
    "wing": "1",  # 0 folded, 1 out
    "throttle": "1",
    "rail_s": "m",  # way along the rail since rest; after the last shoe has left it keeps its value
    "catapult_force": "N",  # mean over the step that begins with the row
    "mean_wind_n": "m/s",  # of wind_n: the mean wind at the aircraft's height; the rest is turbulence and gusts
    "mean_wind_e": "m/s",
    "gust_n": "m/s",  # of wind_n: the gusts that the scenario sets
    "gust_e": "m/s",
    "gust_d": "m/s",
    "air_p": "rad/s",  # how fast the air turns about the body's axes, by the turbulence
    "air_q": "rad/s",
    "air_r": "rad/s",
}
"""Name of each numeric truth column and its unit, in the order they are written; `phase` (text) follows."""

OF_AIR = ("mean_wind_n", "mean_wind_e", "gust_n", "gust_e", "gust_d", "air_p", "air_q", "air_r")
"""The columns that say what the air's motion is made of. A plant of somebody else's need not know."""

FELT = (
    "fx", "fy", "fz", "p_static", "p_total", "temperature", "airspeed", "mach", "alpha", "beta", "p", "q", "r",
)  # fmt: skip
"""The columns that sensors read; what the head reads comes from the flow and the rates of turn.

Nothing else of the truth may have any influence on what happens on board.
"""

STANDARD_GRAVITY = 9.80665  # m/s^2, ISO 80000-3; the g in which launch levels are quoted
