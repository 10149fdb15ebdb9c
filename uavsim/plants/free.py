"""An aircraft whose controls stand still: JSBSim as a function of state, tail and a constant push.

The components that drive the pitch control lose their outputs, so that it stays where it is set; the stabiliser is not
engaged, the throttle is shut and the thrust is a push along the body's axis. What a stopped propeller drags, drags.
"""

import math
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from uavsim.plants.airframe import Airframe
from uavsim.plants.airframe.check import check_files
from uavsim.plants.columns import FT
from uavsim.plants.hangar import find_airframe
from uavsim.plants.interface import WING_COMMAND, WING_POSITION, interface_of, problems
from uavsim.plants.jsbsim import TWO_STEPS, load_airframe, read_catalogue

Array = NDArray[np.float64]

DT = 0.001  # s
SPAN = 0.05  # s over which the state's change is taken: below a tenth of the fastest mode's period, far above a step
HEIGHT = 1000.0  # ft: far from the ground
SPEED = 32.0  # m/s, of coefficients, unless another is set
STATE = ("u-fps", "w-fps", "q-rad_sec", "theta-rad", "v-fps", "p-rad_sec", "r-rad_sec", "phi-rad")
PITCH_CONTROLS = (
    ("fcs/tail-right-rad", "fcs/tail-left-rad"),
    ("fcs/elevon-right-rad", "fcs/elevon-left-rad"),
    ("fcs/elevator-pos-rad",),
)
"""What pitches an aircraft, rad: the first of these that it drives. The last is JSBSim's own."""
_LONGEST = 10.0  # s that a wing may take to open
_ATTITUDES = ("theta-rad", "phi-rad")


class Free:
    """An aircraft that nobody controls, at one wing position.

    Parameters
    ----------
    model
        A packaged name, a folder, or an aircraft that was read.
    wing
        0 folded … 1 out; of a fixed wing nothing else is there than 1.
    steady
        Whether its air knows no rate of the angle of attack.
    pitch
        Properties that pitch it, rad; by default the first of `PITCH_CONTROLS` that it drives.

    Attributes
    ----------
    fdm
        JSBSim, with the aircraft.
    height
        At which it is started, ft.
    speed
        Of `coefficients`, m/s.

    Raises
    ------
    ValueError
        One line: all that the aircraft lacks, or what is impossible in its files.
    """

    def __init__(
        self, model: str | Path, wing: float = 1.0, *, steady: bool = False, pitch: Iterable[str] = ()
    ) -> None:
        airframe = find_airframe(model if isinstance(model, Airframe) else str(model))
        self.name = airframe.name
        self.pitch = tuple(pitch) or pitch_control(airframe)
        self.fdm = load_airframe(_freed(airframe, self.pitch, steady=steady))
        catalogue = read_catalogue(self.fdm)
        if lacking := [name for name in self.pitch if "W" not in catalogue.get(name, "")]:
            raise ValueError(f"{airframe}: has no {', '.join(lacking)} that pitches it and can be set")
        self._engaged = [name for name in ("ap/engaged", "fcs/throttle-cmd-norm") if name in catalogue]
        self.height = HEIGHT
        self.speed = SPEED
        self.fdm["propulsion/fuel_freeze"] = 1.0  # a turbine that idles would make it lighter from look to look
        self.fdm.set_dt(DT)
        self.fdm["simulation/integrator/rate/rotational"] = TWO_STEPS
        self.start(np.array([100.0, 0, 0, 0, 0, 0, 0, 0]))
        if interface_of(catalogue).folds:
            self._unfold(wing, "wing/phase" if "wing/phase" in catalogue else WING_POSITION)
        self.set_controls(0.25, 0.0)
        self.fdm.run()
        if any(self.fdm[name] != 0.25 for name in self.pitch):
            raise ValueError(f"{airframe}: {' or '.join(self.pitch)} is set by more than the output of a component")
        self.set_controls(0.0, 0.0)

    def _unfold(self, wing: float, phase: str) -> None:
        """Open the wing so far, and let it stay there: `phase` is what the command is held against."""
        self.fdm[WING_COMMAND] = 1.0 if wing > 0.0 else 0.0
        for _ in range(round(_LONGEST / DT)):
            if self.fdm[WING_POSITION] >= wing:
                break
            self.fdm.run()
        else:
            raise ValueError(
                f"{self.name}: its wing is at {self.fdm[WING_POSITION]:.2f} after {_LONGEST:g} s, not {wing:g}"
            )
        self.fdm[WING_COMMAND] = self.fdm[phase]

    def start(self, state: Array) -> None:
        """Set the state, in the order of `STATE`, at `height`."""
        self.fdm["ic/h-sl-ft"] = self.height
        self.fdm["ic/psi-true-deg"] = 0.0
        for name, value in zip(STATE, state, strict=True):
            self.fdm[f"ic/{name}"] = float(value)
        self.fdm.run_ic()
        for name in self._engaged:
            self.fdm[name] = 0.0

    def set_controls(self, tail: float, push: float) -> None:
        """Set what pitches it (rad) and the push (lbf)."""
        for name in self.pitch:
            self.fdm[name] = float(tail)
        self.fdm["external_reactions/push/magnitude"] = float(push)

    def fly(self, state: Array) -> Array:
        """State after `SPAN`."""
        self.start(state)
        for _ in range(round(SPAN / DT)):
            self.fdm.run()
        return np.array([self.fdm[f"{'attitude' if name in _ATTITUDES else 'velocities'}/{name}"] for name in STATE])

    def coefficients(
        self, alpha_deg: float, beta_deg: float = 0.0, rates: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> Array:
        """C_X, C_Y, C_Z, C_l, C_m, C_n in body axes, moments about the centre of gravity; rates in rad/s."""
        a, b, speed, fdm = math.radians(alpha_deg), math.radians(beta_deg), self.speed / FT, self.fdm
        u, v, w = speed * math.cos(a) * math.cos(b), speed * math.sin(b), speed * math.sin(a) * math.cos(b)
        p, q, r = rates
        self.start(np.array([u, w, q, 0.0, v, p, r, 0.0]))
        force = fdm["aero/qbar-psf"] * fdm["metrics/Sw-sqft"]
        span, chord = fdm["metrics/bw-ft"], fdm["metrics/cbarw-ft"]
        forces = [fdm[f"forces/fb{axis}-aero-lbs"] for axis in "xyz"]
        moments = [
            fdm[f"moments/{axis}-aero-lbsft"] / arm for axis, arm in zip("lmn", (span, chord, span), strict=True)
        ]
        found: Array = np.array([*forces, *moments]) / force
        return found

    def lift_and_moment(self, alpha_deg: float) -> Array:
        """C_L and C_m."""
        x, _, z, _, moment, _ = self.coefficients(alpha_deg)
        alpha = math.radians(alpha_deg)
        return np.array([x * math.sin(alpha) - z * math.cos(alpha), moment])


def checked(model: str | Path) -> tuple[Airframe, bool]:
    """An aircraft that has all that a flight needs, and whether it has a wing to unfold.

    Raises
    ------
    ValueError
        One line: all that it lacks, or what is impossible in its files.
    """
    airframe = find_airframe(model if isinstance(model, Airframe) else str(model))
    catalogue = read_catalogue(load_airframe(airframe))
    if found := problems(catalogue, airframe.checked.functions):
        raise ValueError(f"aircraft.model: {airframe}: {'; '.join(found)}")
    return airframe, interface_of(catalogue).folds


def pitch_control(airframe: Airframe) -> tuple[str, ...]:
    """What pitches an aircraft: the first of `PITCH_CONTROLS` that its components drive, else JSBSim's elevator."""
    text = b"".join(airframe.checked.files.values())
    driven = (names for names in PITCH_CONTROLS if all(_output(name).search(text) for name in names))
    return next(driven, PITCH_CONTROLS[-1])


def _output(name: str) -> re.Pattern[bytes]:
    return re.compile(rb"<output>\s*" + re.escape(name.encode()) + rb"\s*</output>")


def _freed(airframe: Airframe, pitch: tuple[str, ...], *, steady: bool) -> Airframe:
    """An aircraft like this one, with nothing that drives its pitch control, and perhaps air that knows no α'."""
    files = {path: _still(content, pitch, steady=steady) for path, content in airframe.checked.files.items()}
    main, text = f"{airframe.name}.xml", b"".join(files.values())
    bare = [name for name in pitch if name not in PITCH_CONTROLS[-1] and not _is_declared(name, text)]
    declared = "".join(f'<property value="0">{name}</property>' for name in bare)
    if declared:
        system = f'<system name="still">{declared}</system></fdm_config>'
        files[main] = files[main].replace(b"</fdm_config>", system.encode())
    return Airframe(f"{airframe}/free/{airframe.name}", check_files(airframe.name, files.get))


def _still(content: bytes, pitch: tuple[str, ...], *, steady: bool) -> bytes:
    """A file without the outputs that drive the pitch control, and perhaps without α'."""
    for name in pitch:
        content = _output(name).sub(b"", content)
    return content.replace(b"<property>aero/alphadot-rad_sec</property>", b"<value>0</value>") if steady else content


def _is_declared(name: str, text: bytes) -> bool:
    return re.search(rb"<property\s+value[^>]*>\s*" + re.escape(name.encode()) + rb"\s*</property>", text) is not None
