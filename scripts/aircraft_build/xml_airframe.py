"""The airframe as JSBSim's XML: reference quantities, mass, propulsion's place, and the forces from outside."""

from collections.abc import Iterable

from .factors import excess_thrust_xml
from .geometry import Geometry, place
from .mass import fixed_body, panel_masses


def metrics_xml(geometry: Geometry) -> str:
    """Write reference quantities; the eyepoint is the place of the inertial sensor."""
    ref = geometry["reference"]
    return (
        "  <metrics>\n"
        f'    <wingarea unit="M2">{ref["area"]}</wingarea>\n    <wingspan unit="M">{ref["span"]}</wingspan>\n'
        f'    <chord unit="M">{ref["chord"]}</chord>\n'
        f"    {_location(ref['point'], 'AERORP')}\n"
        f"    {_location(geometry['imu']['position'], 'EYEPOINT')}\n"
        f"    {_location((0.0, 0.0, 0.0), 'VRP')}\n"
        "  </metrics>\n"
    )


def mass_xml(geometry: Geometry) -> str:
    """Write what stays as the empty aircraft, and point masses: 0, 1 right and 2, 3 left panels, folded; ballast."""
    body = fixed_body(geometry)
    # x and z both change sign from structural to body axes, so Σ m x z stays; "negated" wants it as in the tensor
    inertia = {"ixx": body.ixx, "iyy": body.iyy, "izz": body.izz, "ixz": -body.ixz}
    lines = [f'    <{name} unit="KG*M2">{value:.8f}</{name}>' for name, value in inertia.items()]
    lines += [f'    <emptywt unit="KG">{body.mass:.6f}</emptywt>', f"    {_location(body.centre, 'CG')}"]
    for side, sign in (("right", 1), ("left", -1)):
        for end, (m, out, forward) in zip(("inner", "outer"), panel_masses(geometry), strict=True):
            x, y = place(geometry, 0.0, out, forward)
            lines.append(
                f'    <pointmass name="{side}-{end}"><weight unit="KG">{m:.6f}</weight>'
                f"{_location((x, sign * y, 0.0))}</pointmass>"
            )
    lines += [
        f'    <pointmass name="ballast-{end}"><weight unit="KG">0</weight>{_location(body.centre)}</pointmass>'
        for end in ("fore", "aft")
    ]
    return '  <mass_balance negated_crossproduct_inertia="true">\n' + "\n".join(lines) + "\n  </mass_balance>\n"


def propulsion_xml(geometry: Geometry) -> str:
    """Write motor and propeller at their place, without tanks, or a turbine with its tank."""
    if "turbine" in geometry:
        return _turbine(geometry)
    name, sense = geometry["name"], geometry["propeller"]["sense"]
    where = _location(geometry["motor"]["position"])
    return (
        f'  <propulsion>\n    <engine file="{name}_motor">\n'
        f'      <thruster file="{name}_propeller">{where}<sense>{sense}</sense></thruster>\n'
        "    </engine>\n  </propulsion>\n"
    )


def _turbine(geometry: Geometry) -> str:
    """Write turbine and tank."""
    name, turbine = geometry["name"], geometry["turbine"]
    return (
        f'  <propulsion>\n    <engine file="{name}_turbine">\n      <feed>0</feed>\n'
        f'      <thruster file="{name}_jet">{_location(turbine["position"])}</thruster>\n    </engine>\n'
        f'    <tank type="FUEL">{_location(turbine["tank"])}<capacity unit="KG">{turbine["fuel"]}</capacity>'
        f'<contents unit="KG">{turbine["fuel"]}</contents></tank>\n  </propulsion>\n'
    )


def reactions_xml(geometry: Geometry) -> str:
    """Write what the launcher and the opening wing do to the aircraft.

    Positive: push forwards, shoes lift the aircraft or push it right, the rail's moment rolls it right. The wing's
    moment has magnitude 1 and the components l, m, n, which systems/wing.xml sets. The excess thrust is what
    factor/thrust adds to the propeller's or the jet's, at its place and along the body's axis as that is.
    """
    forces = [("push", "push", (1, 0, 0))]
    for shoe in ("front", "rear"):
        forces.append((f"{shoe}-shoe-normal", f"{shoe}_shoe", (0, 0, -1)))
        forces.append((f"{shoe}-shoe-lateral", f"{shoe}_shoe", (0, 1, 0)))
    lines = [
        f'    <force name="{name}" frame="BODY">{_location(geometry["rail"][at])}{_direction(way)}</force>'
        for name, at, way in forces
    ]
    lines += [
        f'    <force name="excess-thrust" frame="BODY">{excess_thrust_xml()}'
        f"{_location(_thrust_at(geometry))}{_direction((1, 0, 0))}</force>",
        f'    <moment name="rail-roll" frame="BODY">{_direction((1, 0, 0))}</moment>',
        '    <moment name="wing-inertia" frame="BODY"><function><value>1</value></function>'
        f"{_direction((0, 0, 0))}</moment>",
    ]
    return "  <external_reactions>\n" + "\n".join(lines) + "\n  </external_reactions>\n"


def _thrust_at(geometry: Geometry) -> Iterable[float]:
    where: Iterable[float] = geometry["turbine" if "turbine" in geometry else "motor"]["position"]
    return where


def _location(position: Iterable[float], name: str = "") -> str:
    """Write a place in the structural frame."""
    named = f' name="{name}"' if name else ""
    return f'<location{named} unit="M">{_xyz(position)}</location>'


def _direction(way: Iterable[float]) -> str:
    return f"<direction>{_xyz(way)}</direction>"


def _xyz(values: Iterable[float]) -> str:
    return "".join(f"<{axis}>{value:.6g}</{axis}>" for axis, value in zip("xyz", values, strict=True))
