"""What JSBSim is asked each step: property, place in the raw row, and the factor to SI.

JSBSim speaks in feet, pounds, slugs, inches and degrees Rankine; this table and the plant beside it are the only places
that do. The raw row is kept as it is read and packed into the record, so a column's place is its place in both.
"""

import struct
from operator import itemgetter

FT = 0.3048  # m, exact
INCH = 0.0254  # m, exact
LBF = 4.4482216152605  # N, exact
SLUG = LBF / FT  # kg
SLUG_FT2 = SLUG * FT**2  # kg m^2
PSF = LBF / FT**2  # Pa
RANKINE = 5.0 / 9.0  # K

RAW = {
    "airspeed": ("velocities/vtrue-fps", FT),
    "mach": ("velocities/mach", 1.0),
    "p_static": ("atmosphere/P-psf", PSF),
    "temperature": ("atmosphere/T-R", RANKINE),
    "force_x": ("forces/fbx-total-lbs", LBF),
    "force_y": ("forces/fby-total-lbs", LBF),
    "force_z": ("forces/fbz-total-lbs", LBF),
    "mass": ("inertia/mass-slugs", SLUG),
    "cg_x": ("inertia/cg-x-in", INCH),
    "cg_y": ("inertia/cg-y-in", INCH),
    "cg_z": ("inertia/cg-z-in", INCH),
    "p": ("velocities/p-rad_sec", 1.0),
    "q": ("velocities/q-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "p_dot": ("accelerations/pdot-rad_sec2", 1.0),
    "q_dot": ("accelerations/qdot-rad_sec2", 1.0),
    "r_dot": ("accelerations/rdot-rad_sec2", 1.0),
    "north": ("position/from-start-neu-n-ft", FT),
    "east": ("position/from-start-neu-e-ft", FT),
    "altitude": ("position/h-sl-ft", FT),
    "vn": ("velocities/v-north-fps", FT),
    "ve": ("velocities/v-east-fps", FT),
    "vd": ("velocities/v-down-fps", FT),
    "wind_n": ("atmosphere/total-wind-north-fps", FT),
    "wind_e": ("atmosphere/total-wind-east-fps", FT),
    "wind_d": ("atmosphere/total-wind-down-fps", FT),
    "roll": ("attitude/phi-rad", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
    "heading": ("attitude/psi-rad", 1.0),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "wing": ("fcs/wing-pos-norm", 1.0),
    "throttle": ("fcs/throttle-pos-norm", 1.0),
}
"""What is read each step: the column, its JSBSim property, and the factor to SI."""

INDEX = {name: i for i, name in enumerate(RAW)}
ALTITUDE, WING, THROTTLE = INDEX["altitude"], INDEX["wing"], INDEX["throttle"]
MOTION = itemgetter(*(INDEX[n] for n in ("north", "east", "altitude", "vn", "ve", "vd")))
ATTITUDE = itemgetter(*(INDEX[n] for n in ("roll", "pitch", "heading")))
CENTRE = itemgetter(*(INDEX[n] for n in ("cg_x", "cg_y", "cg_z")))
AIR, AIR_OFFSET = struct.Struct("3d"), 8 * INDEX["mach"]  # mach, p_static, temperature stand together in RAW
AT_HEAD = ("airspeed", "mach", "p_static", "temperature", "cg_x", "cg_y", "cg_z", "p", "q", "r", "alpha", "beta")
OF_ROW = itemgetter(*(INDEX[n] for n in AT_HEAD))
OF_RECORD = struct.Struct("".join("d" if n in AT_HEAD else "8x" for n in RAW))  # the same, in the order of RAW
FELT = slice(INDEX["force_x"], INDEX["r_dot"] + 1)  # what the specific force is made of stands together in RAW
OWN = ("catapult_force", "fx", "fy", "fz")  # N and m/s^2: what is recorded beside them, in SI already
ROW = struct.Struct(f"{len(RAW) + len(OWN)}d")
