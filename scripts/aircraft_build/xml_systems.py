"""What the hand-written systems need as JSBSim's XML: constants in its units, and the trim over the wing position."""

import math

from .aerodynamics import Tables
from .factors import factors_xml
from .geometry import WING_POSITIONS, Geometry
from .mass import panel_masses
from .trim import trim_deflections
from .xml_engine import NEWTON

INCHES = 1 / 0.0254  # in/m, exact
KG_TO_LB = 1.0 / 0.45359237  # exact, international pound
LB_PER_SLUG = 32.174049  # standard gravity in ft/s²
PA_TO_PSF = 1.0 / 47.880259  # lbf/ft²
SEA_LEVEL_DENSITY = 1.225  # kg/m³, standard atmosphere

AIR = "".join(f'    <property value="0">air/{axis}-rad_sec</property>\n' for axis in "pqr")
"""Rotation of the air about the body's axes, which the simulation sets: the damping is of the difference."""


def systems_xml(geometry: Geometry, t: Tables) -> str:
    """Write the system of constants and trim, and name the hand-written ones."""
    return (
        f'  <system name="constants">\n{_constants(geometry)}{AIR}{factors_xml()}{_trim(geometry, t)}'
        f"{_started(geometry)}  </system>\n"
        '  <system file="wing"/>\n  <system file="stabiliser"/>\n'
    )


def _constants(geometry: Geometry) -> str:
    values = _wing(geometry) | _tail(geometry) | _stabiliser(geometry)
    return "".join(f'    <property value="{value:.9g}">{name}</property>\n' for name, value in values.items())


def _wing(geometry: Geometry) -> dict[str, float]:
    wing = geometry["wing"]
    inner, outer = panel_masses(geometry)
    return {
        "wing/opening-rate-per_sec": 1 / wing["opening_time"],
        "wing/sweep-folded-rad": math.radians(wing["sweep_folded_deg"]),
        "wing/sweep-travel-rad": math.radians(wing["sweep_out_deg"] - wing["sweep_folded_deg"]),
        "wing/pivot-x-in": wing["pivot"][0] * INCHES,
        "wing/pivot-y-in": wing["pivot"][1] * INCHES,
        "wing/inner-mass-out-in": inner.out * INCHES,
        "wing/outer-mass-out-in": outer.out * INCHES,
        "wing/masses-forward-in": inner.forward * INCHES,
        "wing/point-mass-slug": inner.mass * KG_TO_LB / LB_PER_SLUG,
    }


def _tail(geometry: Geometry) -> dict[str, float]:
    tail = geometry["tail"]
    return {
        "tail/deflection-max-rad": math.radians(tail["deflection_max_deg"]),
        "tail/deflection-rate-max-rad_sec": math.radians(tail["deflection_rate_max_deg"]),
    }


def _stabiliser(geometry: Geometry) -> dict[str, float]:
    gains = geometry["stabiliser"]
    return {
        "ap/gain/reference-qbar-psf": 0.5 * SEA_LEVEL_DENSITY * gains["reference_airspeed"] ** 2 * PA_TO_PSF,
        "ap/gain/least-qbar-psf": 0.5 * SEA_LEVEL_DENSITY * gains["least_airspeed"] ** 2 * PA_TO_PSF,
        "ap/gain/pitch": gains["pitch"],
        "ap/gain/pitch-integral-per_sec": gains["pitch_integral"],
        "ap/gain/pitch-rate-sec": gains["pitch_rate"],
        "ap/gain/roll-folded": gains["roll_folded"],
        "ap/gain/roll-gain-on-opening": gains["roll_out"] - gains["roll_folded"],
        "ap/gain/roll-integral-per_sec": gains["roll_integral"],
        "ap/gain/roll-rate-sec": gains["roll_rate"],
    }


def _started(geometry: Geometry) -> str:
    """Write that a turbine runs from the start, idles until the throttle opens, and burns what it should.

    JSBSim lets no turbine burn less than 107 lb/h (thrust/lbf)^0.2, which a small one does not at full thrust: what is
    too much flows back into the tank.
    """
    if "turbine" not in geometry:
        return ""
    turbine, hour = geometry["turbine"], 3600.0
    idle = turbine["idle_flow"] * KG_TO_LB
    full = turbine["consumption"] * turbine["thrust"] / hour * KG_TO_LB
    per_thrust = (full - idle) / (turbine["thrust"] * NEWTON)
    return (
        '    <channel name="turbine">\n'
        '      <fcs_function name="fcs/turbine-runs"><function><value>1</value></function>\n'
        "        <output>propulsion/engine/set-running</output></fcs_function>\n"
        '      <fcs_function name="fcs/turbine-spares"><function><difference>\n'
        f"        <property>propulsion/engine/fuel-flow-rate-pps</property><value>{idle:.7g}</value>\n"
        f"        <product><value>{per_thrust:.7g}</value><max><value>0</value>"
        "<property>propulsion/engine/thrust-lbs</property></max></product>\n"
        "        </difference></function><output>propulsion/tank/external-flow-rate-pps</output></fcs_function>\n"
        "    </channel>\n"
    )


def _trim(geometry: Geometry, t: Tables) -> str:
    """Write the stabiliser's feed-forward over the wing position."""
    rows = "".join(
        f"          {w:6.3f} {d:9.5f}\n" for w, d in zip(WING_POSITIONS, trim_deflections(geometry, t), strict=True)
    )
    return (
        '    <channel name="trim"><fcs_function name="ap/tail-trim-rad"><function><table>\n'
        '        <independentVar lookup="row">fcs/wing-pos-norm</independentVar>\n'
        f"        <tableData>\n{rows}        </tableData></table></function></fcs_function></channel>\n"
    )
