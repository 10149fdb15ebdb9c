"""Motor and propeller as JSBSim's XML."""

from .geometry import Geometry


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
