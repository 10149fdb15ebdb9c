"""What drives the aircraft, as JSBSim's XML: motor and propeller, or a turbine and its jet."""

from .geometry import Geometry
from .turbine import HEIGHTS, MACHS, thrust_ratios

NEWTON = 1 / 4.4482216152605  # lbf, exact
GRAVITY = 9.80665  # lb/(lbf h) per kg/(N h), exact
NO_IDLE_THRUST = 0.4  # Mach number at which the jet of an idling turbine is as fast as the stream. By hand


def engine_files(geometry: Geometry) -> dict[str, str]:
    """Files below engine/ and what stands in them."""
    name = geometry["name"]
    if "turbine" in geometry:
        return {
            f"{name}_turbine.xml": turbine_xml(geometry),
            f"{name}_jet.xml": f'<direct name="{name} jet">\n</direct>\n',
        }
    return {f"{name}_motor.xml": motor_xml(geometry), f"{name}_propeller.xml": propeller_xml(geometry)}


def turbine_xml(geometry: Geometry) -> str:
    """Write the turbine: thrust at full speed from its cycle, idle thrust falling with the Mach number.

    JSBSim's thrust is idle + (full - idle) n², n of 0 to 1 between idle and full speed, and n follows the throttle as
    its own spool does: some 4 s from idle to full.
    """
    turbine = geometry["turbine"]
    idle = turbine["idle_thrust"] / turbine["thrust"]
    return (
        f'<turbine_engine name="{geometry["name"]} turbine">\n'
        f'  <milthrust unit="LBS">{turbine["thrust"] * NEWTON:.6f}</milthrust>\n'
        "  <bypassratio>0</bypassratio>\n"
        f"  <tsfc>{turbine['consumption'] * GRAVITY:.6f}</tsfc>\n"
        f"  <idlen1>{turbine['idle_speed']}</idlen1>\n  <idlen2>{turbine['idle_speed']}</idlen2>\n"
        "  <maxn1>100</maxn1>\n  <maxn2>100</maxn2>\n  <augmented>0</augmented>\n  <injected>0</injected>\n"
        + _over_flight("IdleThrust", [[idle * (1 - mach / NO_IDLE_THRUST) for _ in HEIGHTS] for mach in MACHS])
        + _over_flight("MilThrust", thrust_ratios(geometry))
        + "</turbine_engine>\n"
    )


def _over_flight(name: str, values: list[list[float]]) -> str:
    """Write a table over Mach number and density altitude, ft."""
    rows = [" " * 8 + "".join(f"{height:>10.0f}" for height in HEIGHTS)]
    rows += [f"{mach:>8.2f}" + "".join(f"{v:>10.5f}" for v in row) for mach, row in zip(MACHS, values, strict=True)]
    lines = "\n".join(rows)
    return (
        f'  <function name="{name}"><table>\n    <independentVar lookup="row">velocities/mach</independentVar>\n'
        '    <independentVar lookup="column">atmosphere/density-altitude</independentVar>\n'
        f"    <tableData>\n{lines}\n    </tableData></table></function>\n"
    )


def motor_xml(geometry: Geometry) -> str:
    """Write the three constants of the brushless motor."""
    motor = geometry["motor"]
    return (
        f'<brushless_dc_motor name="{geometry["name"]} motor">\n'
        f"  <maxvolts>{motor['max_voltage']}</maxvolts>\n"
        f"  <velocityconstant>{motor['velocity_constant']}</velocityconstant>\n"
        f"  <coilresistance>{motor['coil_resistance']}</coilresistance>\n"
        f"  <noloadcurrent>{motor['no_load_current']}</noloadcurrent>\n"
        "</brushless_dc_motor>\n"
    )


def propeller_xml(geometry: Geometry) -> str:
    """Write the fixed-pitch propeller with its tables over the advance ratio."""
    prop = geometry["propeller"]

    def table(name: str, key: str) -> str:
        rows = "".join(f"    {j:6.3f} {c:9.5f}\n" for j, c in zip(prop["advance_ratio"], prop[key], strict=True))
        return f'  <table name="{name}" type="internal"><tableData>\n{rows}  </tableData></table>\n'

    return (
        f'<propeller name="{geometry["name"]} propeller">\n  <ixx unit="KG*M2">{prop["inertia"]}</ixx>\n'
        f'  <diameter unit="M">{prop["diameter"]}</diameter>\n  <numblades>{prop["blades"]}</numblades>\n'
        "  <minpitch>0</minpitch>\n  <maxpitch>0</maxpitch>\n"
        + table("C_THRUST", "thrust_coefficient")
        + table("C_POWER", "power_coefficient")
        + "</propeller>\n"
    )
