"""Modes and static margin of an aircraft, flown in JSBSim with its controls fixed: python scripts/aircraft_modes.py.

The stabiliser is taken out, the tail stands still, the thrust is a constant push along the axis. Trimmed level flight
is where nothing changes over `SPAN` seconds. The state's change over that time, from small steps either way, gives the
transition matrix Φ; a mode is an eigenvalue of ln Φ / SPAN. Static margin: -dC_m/dC_L about the centre of gravity with
the tail neutral, over `ALPHA_STEP` either way.
"""

import argparse
import math
import shutil
import tempfile
from pathlib import Path

import jsbsim
import numpy as np

FOOT, POUND = 0.3048, 4.4482216  # m, N
DT, SPAN = 0.001, 0.05  # s
HEIGHT = 1000.0  # ft: far from the ground
SPEED = 32.0  # m/s
ALPHA_STEP = 0.5  # deg
ALPHAS = range(-6, 15, 1)  # deg
WINGS = (0.0, 0.25, 0.5, 0.75, 1.0)
STATE = ("u-fps", "w-fps", "q-rad_sec", "theta-rad", "v-fps", "p-rad_sec", "r-rad_sec", "phi-rad")
STEPS = np.array([0.3, 0.3, 0.01, 0.01, 0.3, 0.01, 0.01, 0.01])
TAIL = ("fcs/tail-right-rad", "fcs/tail-left-rad")


class Free:
    """The aircraft without its stabiliser, at one wing position; if it is steady, its air knows no α'."""

    def __init__(self, model: Path, wing: float = 1.0, *, steady: bool = False) -> None:
        with tempfile.TemporaryDirectory() as folder:
            place = shutil.copytree(model, Path(folder) / model.name)
            text = (place / f"{model.name}.xml").read_text(encoding="utf-8")
            still = "".join(f'<property value="0">{name}</property>' for name in TAIL)
            text = text.replace('<system file="stabiliser"/>', f'<system name="still">{still}</system>')
            if steady:
                text = text.replace("<property>aero/alphadot-rad_sec</property>", "<value>0</value>")
            (place / f"{model.name}.xml").write_text(text, encoding="utf-8")
            self.fdm = jsbsim.FGFDMExec(None)
            self.fdm.set_debug_level(0)
            paths = [str(path) for path in (place.parent, place / "engine", place / "systems")]
            if not self.fdm.load_model_with_paths(model.name, *paths, True):
                raise SystemExit(f"JSBSim does not read {model}")
        self.height = HEIGHT
        self.fdm.set_dt(DT)
        self.fdm["simulation/integrator/rate/rotational"] = 3
        self.start(np.array([100.0, 0, 0, 0, 0, 0, 0, 0]))
        self.fdm["fcs/wing-cmd-norm"] = 1.0 if wing > 0.0 else 0.0
        while self.fdm["fcs/wing-pos-norm"] < wing:
            self.fdm.run()
        self.fdm["fcs/wing-cmd-norm"] = self.fdm["wing/phase"]  # where it is, it stays

    def start(self, state: np.ndarray) -> None:
        """Set the state, in the order of `STATE`, at `height`."""
        self.fdm["ic/h-sl-ft"] = self.height
        self.fdm["ic/psi-true-deg"] = 0.0
        for name, value in zip(STATE, state, strict=True):
            self.fdm[f"ic/{name}"] = value
        self.fdm.run_ic()

    def set_controls(self, tail: float, push: float) -> None:
        """Set both halves of the tail (rad) and the push (lbf)."""
        for name in TAIL:
            self.fdm[name] = tail
        self.fdm["external_reactions/push/magnitude"] = push

    def fly(self, state: np.ndarray) -> np.ndarray:
        """State after `SPAN`."""
        self.start(state)
        for _ in range(round(SPAN / DT)):
            self.fdm.run()
        roots = {"theta-rad": "attitude", "phi-rad": "attitude"}
        return np.array([self.fdm[f"{roots.get(name, 'velocities')}/{name}"] for name in STATE])

    def coefficients(
        self, alpha_deg: float, beta_deg: float = 0.0, rates: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """C_X, C_Y, C_Z, C_l, C_m, C_n in body axes, moments about the centre of gravity; rates in rad/s."""
        a, b, speed, fdm = math.radians(alpha_deg), math.radians(beta_deg), SPEED / FOOT, self.fdm
        u, v, w = speed * math.cos(a) * math.cos(b), speed * math.sin(b), speed * math.sin(a) * math.cos(b)
        p, q, r = rates
        self.start(np.array([u, w, q, 0.0, v, p, r, 0.0]))
        force = fdm["aero/qbar-psf"] * fdm["metrics/Sw-sqft"]
        span, chord = fdm["metrics/bw-ft"], fdm["metrics/cbarw-ft"]
        forces = [fdm[f"forces/fb{axis}-aero-lbs"] for axis in "xyz"]
        moments = [
            fdm[f"moments/{axis}-aero-lbsft"] / arm for axis, arm in zip("lmn", (span, chord, span), strict=True)
        ]
        return np.array([*forces, *moments]) / force

    def lift_and_moment(self, alpha_deg: float) -> np.ndarray:
        """C_L and C_m."""
        x, _, z, _, moment, _ = self.coefficients(alpha_deg)
        alpha = math.radians(alpha_deg)
        return np.array([x * math.sin(alpha) - z * math.cos(alpha), moment])


def level(alpha: float, speed: float) -> np.ndarray:
    """State of level flight."""
    fps = speed / FOOT
    return np.array([fps * math.cos(alpha), fps * math.sin(alpha), 0, alpha, 0, 0, 0, 0])


def trim(free: Free, speed: float) -> tuple[float, float, float]:
    """Angle of attack (rad), tail (rad) and push (lbf) of level flight: Newton's method."""

    def change(x: np.ndarray) -> np.ndarray:
        free.set_controls(x[1], 10 * x[2])
        state = level(x[0], speed)
        return np.asarray(free.fly(state) - state)[:3]

    x, step = np.array([0.02, 0.0, 0.1]), 1e-3
    for _ in range(12):
        jacobian = np.array([(change(x + step * e) - change(x - step * e)) / (2 * step) for e in np.eye(3)]).T
        x = x - np.linalg.solve(jacobian, change(x))
    if np.abs(change(x)).max() > 1e-4:
        raise SystemExit("no level flight was found")
    return float(x[0]), float(x[1]), float(10 * x[2])


def roots(free: Free, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (1/s) of the longitudinal and the lateral motion about trimmed level flight."""
    alpha, tail, push = trim(free, speed)
    free.set_controls(tail, push)
    state = level(alpha, speed)
    columns = [(free.fly(state + d) - free.fly(state - d)) / 2 for d in np.diag(STEPS)]
    transition = np.array(columns).T / STEPS
    parts = transition[:4, :4], transition[4:, 4:]
    values = [np.log(np.linalg.eigvals(part).astype(complex)) / SPAN for part in parts]
    return values[0], values[1]


def describe(value: complex) -> str:
    """A mode in words."""
    if value.imag:
        size, turn = abs(value), 2 * math.pi
        return f"period {turn / value.imag:6.2f} s, {size / turn:5.2f} Hz, damping {-value.real / size:5.3f}"
    if value.real > 0:
        return f"doubles in {math.log(2) / value.real:.1f} s"
    return f"time constant {-1 / value.real:.3f} s"


def print_modes(model: Path, speed: float) -> None:
    """Print trim and modes."""
    free = Free(model)
    alpha, tail, push = trim(free, speed)
    print(f"{model.name}, wing out, level at {speed:g} m/s: angle of attack {math.degrees(alpha):.2f}°, ", end="")
    print(f"tail {math.degrees(tail):.2f}°, thrust {push * POUND:.2f} N")
    longitudinal, lateral = roots(free, speed)
    pairs = sorted((v for v in longitudinal if v.imag > 0), key=abs, reverse=True)
    for name, value in zip(("short period", "phugoid"), pairs, strict=False):
        print(f"  {name:13s} {describe(value)}")
    for value in lateral:
        if value.imag > 0:
            print(f"  {'Dutch roll':13s} {describe(value)}")
    single = sorted((v for v in lateral if not v.imag), key=abs, reverse=True)
    for name, value in zip(("roll", "spiral"), single, strict=False):
        print(f"  {name:13s} {describe(value)}")


def print_margins(model: Path) -> None:
    """Print the static margin over the angle of attack and the wing position, and C_mα of the wing out."""
    print("static margin, % of the chord, tail neutral; last column: C_mα per rad, wing out")
    print("  alpha " + "".join(f"  w={w:4.2f}" for w in WINGS) + "     Cmα")
    frees = [Free(model, w, steady=True) for w in WINGS]
    for alpha in ALPHAS:
        change = [free.lift_and_moment(alpha + ALPHA_STEP) - free.lift_and_moment(alpha - ALPHA_STEP) for free in frees]
        cells = "".join(f"{-100 * moment / lift:8.1f}" for lift, moment in change)
        print(f"{alpha:5d}° {cells}{change[-1][1] / math.radians(2 * ALPHA_STEP):10.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Modes and static margin with fixed controls.")
    parser.add_argument("model", nargs="?", default="aircraft/fw8", type=Path, help="folder of the aircraft")
    parser.add_argument("--speed", type=float, default=SPEED, help="m/s")
    chosen = parser.parse_args()
    print_modes(chosen.model.resolve(), chosen.speed)
    print_margins(chosen.model.resolve())
