"""Names of JSBSim's properties and files: how one is written, and which properties an aircraft may set.

Properties are one tree that the aircraft shares with the simulator. An aircraft sets its own controls, systems, engines
and forces. It does not set where it is, how it moves or what the air does, which are results; nor ``simulation/`` and
``ic/``, which are commands to the simulator: stop, reset, write a file.
"""

import re


def words(text: str) -> tuple[str, ...]:
    """Words of a text, in their order."""
    return tuple(text.split())


OF_AIRCRAFT = words("aero ap buoyant_forces external_reactions fcs gear hydro inertia metrics propulsion systems")
"""JSBSim's own roots that an aircraft may set."""

OF_SIMULATOR = words(
    "accelerations atmosphere attitude contact flight-path forces ground ic inertial moments orbital position "
    "simulation velocities"
)
"""JSBSim's own roots that an aircraft may only read; any other root is the aircraft's own."""

TAKEN = {
    "aero": words(
        "Re alpha-deg alpha-max-rad alpha-min-rad alpha-rad alpha-wing-rad alphadot-deg_sec alphadot-rad_sec "
        "beta-deg beta-rad betadot-deg_sec betadot-rad_sec bi2vel ci2vel cl-squared h_b-cg-ft h_b-mac-ft "
        "mag-beta-deg mag-beta-rad qbar-area qbar-psf qbarUV-psf qbarUW-psf stall-hyst-norm"
    ),
    "fcs": words(
        "aileron-cmd-norm center-brake-cmd-norm elevator-cmd-norm elevator-pos-deg elevator-pos-norm "
        "elevator-pos-rad flap-cmd-norm flap-pos-deg flap-pos-norm flap-pos-rad left-aileron-pos-deg "
        "left-aileron-pos-norm left-aileron-pos-rad left-brake-cmd-norm mag-elevator-pos-rad "
        "mag-left-aileron-pos-rad mag-right-aileron-pos-rad mag-rudder-pos-rad mag-speedbrake-pos-rad "
        "mag-spoiler-pos-rad pitch-trim-cmd-norm right-aileron-pos-deg "
        "right-aileron-pos-norm right-aileron-pos-rad right-brake-cmd-norm roll-trim-cmd-norm rudder-cmd-norm "
        "rudder-pos-deg rudder-pos-norm rudder-pos-rad speedbrake-cmd-norm speedbrake-pos-deg speedbrake-pos-norm "
        "speedbrake-pos-rad spoiler-cmd-norm spoiler-pos-deg spoiler-pos-norm spoiler-pos-rad steer-cmd-norm "
        "wing-fold-pos-norm yaw-trim-cmd-norm"
    ),
    "systems": words("stall-warn-norm"),
}
"""What JSBSim 1.3.3 has there itself, by root: a function of the same name ends the process."""

FUNCTIONS = words("aero ap buoyant_forces fcs hydro systems")
"""Those of JSBSim's own roots under which an aircraft's functions and tables may be filed."""

_PART = r"[A-Za-z_][A-Za-z0-9_.-]*(?:\[(?:[0-9]{1,4}|#)\])?"  # neither '.' nor '..' begins with a letter
_PATH = re.compile(rf"/?{_PART}(?:/{_PART})*")
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_ .-]*")
_FILE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_ .+-]*(?:/[A-Za-z0-9_][A-Za-z0-9_ .+-]*)*")  # inside, and no '..'
LONGEST = 200  # characters


def is_path(name: str) -> bool:
    """Whether this is the name of a property: names of letters, digits and ``_-.``, joined by slashes."""
    return len(name) <= LONGEST and _PATH.fullmatch(name) is not None


def is_read(name: str) -> bool:
    """Whether this is the name of a property that is read, which a minus may negate."""
    return is_path(name.removeprefix("-"))


def is_file(name: str) -> bool:
    """Whether this is the path of a file below a folder: no way out of it, nothing hidden, no odd character."""
    return len(name) <= LONGEST and _FILE.fullmatch(name) is not None


def may_set(name: str) -> bool:
    """Whether an aircraft may set this property."""
    if not is_path(name):
        return False
    root, _, rest = name.removeprefix("/").partition("/")
    root = root.partition("[")[0]
    if root in OF_SIMULATOR or (root in OF_AIRCRAFT and not rest):
        return rest.startswith("sensor/")  # what a sensor makes of it, beside the state
    return root != "inertia" or rest.startswith("pointmass-")


def is_label(name: str) -> bool:
    """Whether this is a name of words, which JSBSim files away under a property of its own."""
    return len(name) <= LONGEST and _PLAIN.fullmatch(name) is not None


def may_be_called(name: str) -> bool:
    """Whether a component, a function or a table may be called so: by words, which JSBSim files away, or a property."""
    if "/" in name:
        return may_set(name)
    return is_label(name) and name.lower() not in OF_SIMULATOR + OF_AIRCRAFT


def may_name_function(name: str) -> bool:
    """Whether a function or a table may be called so: JSBSim binds the name to it."""
    root, _, rest = plain(name).partition("/")
    if rest and root in OF_AIRCRAFT and (root not in FUNCTIONS or rest in TAKEN.get(root, ())):
        return False
    return may_be_called(name)


def plain(name: str) -> str:
    """Return a property's name without sign, leading slash and zeroth index."""
    return name.strip().lstrip("-/").replace("[0]", "")
