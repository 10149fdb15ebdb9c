"""Build an aircraft's JSBSim file from its derivatives: python scripts/build_from_derivatives.py aircraft/x8.

Writes AIRCRAFT_DIR/NAME.xml and the engine and propeller beside it; nothing in them is edited by hand. The header has
the SHA-256 of derivatives.toml, which a test compares. The systems that it names are written by hand.

Forces and moments are those of linear derivatives, with the drag's squares, and the lift goes over to a flat plate's
beyond the stall (Beard and McLain 2012, 4.2):

    C_L = (1 − σ)(C_L0 + C_Lα α) + 2 σ sgn α sin² α cos α + C_Lq q c/2V + C_Lδe δe
    σ(α) = (1 + e^(−M(α − α₀)) + e^(M(α + α₀)))/((1 + e^(−M(α − α₀)))(1 + e^(M(α + α₀))))
    C_D = (1 − σ)(C_D0 + C_Dα α + C_Dα² α²) + 2 σ |sin³ α| + C_Dβ β + C_Dβ² β² + C_Dδe² δe²

σ, C_L and C_D are tables over α, C_T and C_P = 2π C_Q of the propeller over J. Lift and drag are in the frame that α
turns, the side force along the body's axis.
"""

import hashlib
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

PASCAL = 1.0 / 47.880258980336  # psf
ANGLES = np.array([-180, -150, -120, -90, -60, -40, -30, -24, -20, -18, *range(-17, 19), 20, 24, 30, 40, 60, 90, 120,
                   150, 180], dtype=float)  # fmt: skip

# J, C_T and C_P of a propeller without power, that folds: as those of fw8, by hand
FOLDED = [(1.0, -0.002, 0.003), (2.0, -0.001, 0.0005), (5.0, 0.0, 0.0001)]


def blend(alpha: np.ndarray, stall: float, sharpness: float) -> np.ndarray:
    """σ, 0 for attached flow, 1 for a flat plate."""
    up = np.exp(np.clip(-sharpness * (alpha - stall), -300, 300))
    down = np.exp(np.clip(sharpness * (alpha + stall), -300, 300))
    return (1.0 + up + down) / ((1.0 + up) * (1.0 + down))


def polar(d: dict[str, Any], alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C_L and C_D over α, rad, with nothing deflected."""
    lift, drag = d["lift"], d["drag"]
    sigma = blend(alpha, lift["stall_alpha"], lift["stall_sharpness"])
    flat = 2.0 * np.sign(alpha) * np.sin(alpha) ** 2 * np.cos(alpha)
    attached = drag["zero"] + drag["alpha"] * alpha + drag["alpha2"] * alpha**2
    return (
        (1.0 - sigma) * (lift["zero"] + lift["alpha"] * alpha) + sigma * flat,
        (1.0 - sigma) * attached + sigma * 2.0 * np.abs(np.sin(alpha)) ** 3,
    )


def _table(name: str, values: np.ndarray) -> str:
    rows = "\n".join(f"          {angle:8g} {value:10.6f}" for angle, value in zip(ANGLES, values, strict=True))
    return (
        f'<table name="{name}"><independentVar lookup="row">aero/alpha-deg</independentVar><tableData>\n{rows}\n'
        "        </tableData></table>"
    )


def _term(value: float, *names: str) -> str:
    inside = "".join(f"<property>{name}</property>" for name in names)
    return f"<product><value>{value:.8g}</value>{inside}</product>"


def _function(name: str, factor: str, length: str, terms: list[str]) -> str:
    scale = f"<property>{factor}</property>" if factor else ""
    arm = f"<property>{length}</property>" if length else ""
    body = "".join(f"\n        {term}" for term in terms)
    return (
        f'      <function name="aero/{name}"><product>{scale}<property>aero/qbar-psf</property>'
        f"<property>metrics/Sw-sqft</property>{arm}<sum>{body}\n      </sum></product></function>\n"
    )


def _axis(name: str, frame: str, function: str) -> str:
    where = f' frame="{frame}"' if frame else ""
    return f'    <axis name="{name}"{where}>\n{function}    </axis>\n'


def aerodynamics(d: dict[str, Any]) -> str:
    """Write the forces and moments."""
    lift, drag, pitch = d["lift"], d["drag"], d["pitch"]
    side, roll, yaw = d["side"], d["roll"], d["yaw"]
    lifts, drags = polar(d, np.radians(ANGLES))
    rate = {
        name: f'    <function name="aero/{name}-hat"><product><property>aero/{half}</property><difference>'
        f"<property>velocities/{name}-aero-rad_sec</property><property>air/{name}-rad_sec</property></difference>"
        "</product></function>\n"
        for name, half in (("p", "bi2vel"), ("q", "ci2vel"), ("r", "bi2vel"))
    }
    limit = d["limits"]["alpha"]
    held = (
        '    <function name="aero/alpha-held-rad"><min><max><property>aero/alpha-rad</property>'
        f"<value>{-limit}</value></max><value>{limit}</value></min></function>\n"
    )
    lateral = ("aero/beta-rad", "aero/p-hat", "aero/r-hat", "fcs/aileron-rad")

    def terms(group: dict[str, float]) -> list[str]:
        names = ("beta", "roll_rate", "yaw_rate", "aileron")
        return [_term(group[name], read) for name, read in zip(names, lateral, strict=True)]

    x = _function("drag", "factor/drag", "", [
        _table("aero/table/CD", drags), _term(drag["beta"], "aero/beta-rad"),
        _term(drag["beta2"], "aero/beta-rad", "aero/beta-rad"),
        _term(drag["elevator2"], "fcs/elevator-rad", "fcs/elevator-rad"),
    ])  # fmt: skip
    z = _function("lift", "factor/lift", "", [
        _table("aero/table/CL", lifts), _term(lift["pitch_rate"], "aero/q-hat"),
        _term(lift["elevator"], "fcs/elevator-rad"),
    ])  # fmt: skip
    m = _function("pitch", "factor/pitch", "metrics/cbarw-ft", [
        f"<value>{pitch['zero']:.8g}</value>", _term(pitch["alpha"], "aero/alpha-held-rad"),
        _term(pitch["pitch_rate"], "aero/q-hat"), _term(pitch["elevator"], "fcs/elevator-rad"),
    ])  # fmt: skip
    return (
        "  <aerodynamics>\n"
        + "".join(rate.values())
        + held
        + _axis("X", "STABILITY", x)
        + _axis("Y", "STABILITY", _function("side", "", "", terms(side)))
        + _axis("Z", "STABILITY", z)
        + _axis("ROLL", "", _function("roll", "", "metrics/bw-ft", terms(roll)))
        + _axis("PITCH", "", m)
        + _axis("YAW", "", _function("yaw", "", "metrics/bw-ft", terms(yaw)))
        + "  </aerodynamics>\n"
    )


def _place(tag: str, x: float, z: float = 0.0, name: str = "") -> str:
    named = f' name="{name}"' if name else ""
    return f'<{tag}{named} unit="M"><x>{x:g}</x><y>0</y><z>{z:g}</z></{tag}>'


def airframe(d: dict[str, Any]) -> str:
    """Write sizes, masses and what the launcher takes hold of."""
    ref, mass, shoes = d["reference"], d["mass"], d["shoes"]
    centre = mass["centre"]
    ballast = "".join(
        f'    <pointmass name="ballast-{end}"><weight unit="KG">0</weight>{_place("location", centre)}</pointmass>\n'
        for end in ("fore", "aft")
    )
    forces = [("push", centre, 0.0, (1, 0, 0))]
    for end in ("front", "rear"):
        for kind, way in (("normal", (0, 0, -1)), ("lateral", (0, 1, 0))):
            forces.append((f"{end}-shoe-{kind}", *shoes[end], way))
    pushed = "".join(
        f'    <force name="{name}" frame="BODY">{_place("location", x, z)}<direction><x>{a}</x><y>{b}</y><z>{c}</z>'
        "</direction></force>\n"
        for name, x, z, (a, b, c) in forces
    )
    return (
        f'  <metrics>\n    <wingarea unit="M2">{ref["area"]:g}</wingarea>\n'
        f'    <wingspan unit="M">{ref["span"]:g}</wingspan>\n    <chord unit="M">{ref["chord"]:g}</chord>\n    '
        + "\n    ".join(_place("location", x, 0.0, name) for name, x in
                        (("AERORP", centre), ("EYEPOINT", centre), ("VRP", 0.0)))
        + '\n  </metrics>\n  <mass_balance negated_crossproduct_inertia="true">\n'
        + "".join(f'    <{i} unit="KG*M2">{mass[i]:g}</{i}>\n' for i in ("ixx", "iyy", "izz", "ixz"))
        + f'    <emptywt unit="KG">{mass["mass"]:g}</emptywt>\n    {_place("location", centre, 0.0, "CG")}\n'
        + ballast
        + "  </mass_balance>\n  <ground_reactions></ground_reactions>\n  <external_reactions>\n"
        + pushed
        + '    <force name="excess-thrust" frame="BODY"><function><product><difference>'
        "<property>factor/thrust</property><value>1</value></difference><property>propulsion/engine/thrust-lbs</property></product></function>"
        + _place("location", d["motor"]["place"])
        + "<direction><x>1</x><y>0</y><z>0</z></direction></force>\n"
        '    <moment name="rail-roll" frame="BODY"><direction><x>1</x><y>0</y><z>0</z></direction></moment>\n'
        "  </external_reactions>\n"
    )  # fmt: skip


def systems(d: dict[str, Any]) -> str:
    """Write the engine and the constants that the systems read."""
    s, limits, name = d["stabiliser"], d["limits"], d["name"]
    constants = {
        "elevon/deflection-max-rad": limits["elevon"],
        "elevon/deflection-rate-max-rad_sec": limits["elevon_rate"],
        "elevon/lag-per_sec": limits["elevon_lag"],
        "ap/gain/reference-qbar-psf": s["reference_pressure"] * PASCAL,
        "ap/gain/least-qbar-psf": s["least_pressure"] * PASCAL,
        "ap/gain/trim-rad": s["trim"],
        "ap/gain/pitch": s["pitch"],
        "ap/gain/pitch-integral-per_sec": s["pitch_integral"],
        "ap/gain/pitch-rate-sec": s["pitch_rate"],
        "ap/gain/roll": s["roll"],
        "ap/gain/roll-integral-per_sec": s["roll_integral"],
        "ap/gain/roll-rate-sec": s["roll_rate"],
        **dict.fromkeys(("air/p-rad_sec", "air/q-rad_sec", "air/r-rad_sec"), 0.0),
        **dict.fromkeys(("factor/lift", "factor/drag", "factor/pitch", "factor/thrust"), 1.0),
        "ballast/fore-pointmass": 0.0,
        "ballast/aft-pointmass": 1.0,
    }
    return (
        f'  <propulsion>\n    <engine file="{name}_motor">\n      <thruster file="{name}_propeller">'
        + _place("location", d["motor"]["place"])
        + "<sense>1.0</sense></thruster>\n    </engine>\n  </propulsion>\n"
        '  <system name="constants">\n'
        + "".join(f'    <property value="{value:.9g}">{key}</property>\n' for key, value in constants.items())
        + '  </system>\n  <system file="stabiliser"/>\n'
    )


def motor(d: dict[str, Any]) -> str:
    """Write the motor."""
    m = d["motor"]
    return (
        f'<brushless_dc_motor name="{d["name"]} motor">\n  <maxvolts>{m["voltage"]}</maxvolts>\n'
        f"  <velocityconstant>{m['velocity_constant']}</velocityconstant>\n"
        f"  <coilresistance>{m['resistance']}</coilresistance>\n"
        f"  <noloadcurrent>{m['no_load_current']}</noloadcurrent>\n</brushless_dc_motor>\n"
    )


def propeller(d: dict[str, Any]) -> str:
    """Write the propeller: its polynomials up to where the thrust ends; beyond it is folded."""
    p = d["propeller"]
    thrust, torque = np.polynomial.Polynomial(p["thrust"]), np.polynomial.Polynomial(p["torque"])
    end = min(float(r.real) for r in thrust.roots() if abs(r.imag) < 1e-9 and r.real > 0.0)
    ratios = [*np.arange(0.0, end, 0.05), end]
    rows = [(j, thrust(j), 2.0 * np.pi * torque(j)) for j in ratios] + FOLDED
    tables = "".join(
        f'  <table name="{name}" type="internal"><tableData>\n'
        + "".join(f"    {row[0]:6.3f} {row[column]:10.6f}\n" for row in rows)
        + "  </tableData></table>\n"
        for column, name in ((1, "C_THRUST"), (2, "C_POWER"))
    )
    return (
        f'<propeller name="{d["name"]} propeller">\n  <ixx unit="KG*M2">{p["ixx"]}</ixx>\n'
        f'  <diameter unit="M">{p["diameter"]}</diameter>\n  <numblades>2</numblades>\n  <minpitch>0</minpitch>\n'
        f"  <maxpitch>0</maxpitch>\n{tables}</propeller>\n"
    )


def build(directory: Path) -> dict[Path, str]:
    """Return the files that are made, by path."""
    source = directory / "derivatives.toml"
    d = tomllib.loads(source.read_text(encoding="utf-8"))
    digest = hashlib.sha256(source.read_bytes()).hexdigest()
    head = (
        '<?xml version="1.0"?>\n<!-- Generated by scripts/build_from_derivatives.py: do not edit.\n'
        f"     derivatives.toml sha256 {digest} -->\n"
    )
    model = (
        f'{head}<fdm_config name="{d["name"]}" version="2.0" release="BETA">\n  <fileheader>\n'
        f"    <author>uavsim</author>\n    <description>{d['description']}</description>\n  </fileheader>\n"
        + airframe(d) + systems(d) + aerodynamics(d) + "</fdm_config>\n"
    )  # fmt: skip
    return {
        directory / f"{d['name']}.xml": model,
        directory / "engine" / f"{d['name']}_motor.xml": head + motor(d),
        directory / "engine" / f"{d['name']}_propeller.xml": head + propeller(d),
    }


if __name__ == "__main__":
    for path, text in build(Path(sys.argv[1])).items():
        path.write_text(text, encoding="utf-8", newline="\n")
        print(path)
