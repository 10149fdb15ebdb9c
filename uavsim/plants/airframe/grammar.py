"""What an aircraft's files may hold: the elements of JSBSim's language that describe an aircraft, and no others.

JSBSim's language describes an aircraft, and it also opens files and sockets, runs scripts and stops the simulator.
This is the list of what describes: each element with its attributes, what may stand in it and what must. What is not
on the list is refused, whatever it would do. It was made from the 60 aircraft, 80 engines and 100 systems that come
with JSBSim 1.3.3; a test reads them all against it.

A rule's children are names of other rules; ``axis=force_axis`` is an ``axis`` that follows the rule ``force_axis``.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum

from uavsim.plants.airframe.properties import words


class Text(Enum):
    """How a text is read: that of an element or an attribute."""

    NONE = "nothing"
    ANY = "free text"
    NAME = "a name"
    NUMBER = "a number"
    WHOLE = "a whole number from 0 to 999"
    BITS = "a whole number from 1 to 32"
    DELAY = "a number from 0 to 1000"  # s or frames: JSBSim keeps as many values
    FLAG = "true or false"
    READ = "a property"  # it may be negated by a sign
    WRITE = "a property that an aircraft may set"
    OUTPUT = "the name of a component, or a property that an aircraft may set"
    LABEL = "a name of letters, digits, spaces and _-."
    FUNCTION = "a name, or a property that is neither JSBSim's nor set by others"
    VALUE = "a number or a property"
    TESTS = "conditions 'property operator value', one a line"
    ROWS = "rows of numbers"
    FILE = "a file of the aircraft's folder"


@dataclass(frozen=True, slots=True)
class Rule:
    """What an element may hold.

    Attributes
    ----------
    attributes
        Those it may have, and how each is read: a `Text`, or the words that are allowed.
    children
        Elements that may stand in it, and the rule of each.
    text
        What may stand in it besides.
    needs
        Elements of which exactly one must stand in it.
    some
        Elements of which at least one must stand in it.
    needs_attributes
        Attributes that it must have.
    operands
        Least and greatest number of operands in it, for what calculates.
    """

    attributes: "Attributes" = field(default_factory=dict)
    children: Mapping[str, str] = field(default_factory=dict)
    text: Text = Text.NONE
    needs: tuple[str, ...] = ()
    some: tuple[str, ...] = ()
    needs_attributes: tuple[str, ...] = ()
    operands: tuple[int, int] | None = None


Attributes = Mapping[str, Text | Collection[str]]

UNITS: Mapping[str, str] = {
    "length": "M FT IN",
    "area": "M2 FT2",
    "volume": "M3 FT3 IN3 CC LTR",
    "angle": "RAD DEG",
    "mass": "KG LBS",
    "inertia": "KG*M2 SLUG*FT2",
    "mass-moment": "SLUG*FT",
    "density": "KG/L LBS/GAL",
    "mass-flow": "KG/SEC LBS/SEC KG/MIN LBS/MIN",
    "power": "WATTS HP",
    "consumption": "KG/KW*HR LBS/HP*HR",
    "shaft-consumption": "LBS/HR/HP",
    "force": "N LBS",
    "torque": "N*M FT*LBS FT*LB LB*FT",
    "stiffness": "N/M LBS/FT",
    "damping": "N/M/SEC LBS/FT/SEC N/M2/SEC2 LBS/FT2/SEC2",
    "pressure": "PSI PSF PA N/M2 LBS/FT2 ATM INHG",
    "valve": "M4*SEC/KG FT4*SEC/SLUG",
}
"""Units of each quantity that JSBSim converts; one of another quantity ends its reader."""


def _in(quantity: str) -> Attributes:
    return {"unit": words(UNITS[quantity])}


NAMED: Attributes = {"name": Text.NAME}
VALUED: Attributes = {"value": Text.VALUE}


def _each(names: str) -> dict[str, str]:
    """Children from their names; ``name=rule`` where the two differ."""
    return {name: rule or name for name, _, rule in (item.partition("=") for item in names.split())}


def _all(names: str, rule: str) -> dict[str, str]:
    return dict.fromkeys(names.split(), rule)


PROSE = _all("documentation description note limitation reference", "prose")

# -- numbers, places, tables -----------------------------------------------------------------------------------------

RULES: dict[str, Rule] = {
    "prose": Rule(
        dict.fromkeys(words("author date refID title licenseName licenseURL"), Text.ANY),
        _all("licenseName licenseURL reference", "prose"),
        Text.ANY,
    ),
    "number": Rule(text=Text.NUMBER),
    **{f"of_{quantity}": Rule(_in(quantity), text=Text.NUMBER) for quantity in UNITS},
    "value": Rule({"type": frozenset({"rect", "trap", "ab2", "ab3"})}, text=Text.VALUE),
    "read": Rule(_in("angle"), text=Text.READ),
    "whole": Rule(text=Text.WHOLE),
    "word": Rule(text=Text.NAME),
    "location": Rule({**NAMED, **_in("length")}, _all("x y z", "number"), needs=("x", "y", "z")),
    "direction": Rule(children=_all("x y z", "number"), needs=("x", "y", "z")),
    "orient": Rule(_in("angle"), _all("roll pitch yaw x y z", "number")),
    "limits": Rule(_in("angle"), _all("min max", "number") | PROSE, needs=("min", "max")),
    "clipto": Rule(children=_all("min max", "value"), some=("min", "max")),
    "table": Rule(
        {"name": Text.FUNCTION, "type": frozenset({"internal"})},
        _each("independentVar tableData") | PROSE,
        some=("tableData",),
    ),
    "independentVar": Rule({"lookup": frozenset({"row", "column", "table"})}, text=Text.READ),
    "tableData": Rule({"breakPoint": Text.NUMBER, "breakpoint": Text.NUMBER}, text=Text.ROWS),
}

# -- functions -------------------------------------------------------------------------------------------------------

OPERATIONS: Mapping[str, tuple[int, int]] = {
    **dict.fromkeys(words("sum product min max and or avg"), (1, 200)),
    **dict.fromkeys(words("difference interpolate1d"), (1, 200)),
    **dict.fromkeys(
        words(
            "abs sin cos tan asin acos atan exp log2 ln log10 floor ceil fraction integer sign sqrt not toradians "
            "todegrees cube square"
        ),
        (1, 1),
    ),
    **dict.fromkeys(words("quotient pow atan2 fmod lt le gt ge eq nq roundmultiple"), (2, 2)),
    "ifthen": (3, 3),
    "switch": (2, 200),
    **dict.fromkeys(words("rotation_alpha_local rotation_beta_local rotation_gamma_local"), (6, 6)),
    **dict.fromkeys(words("rotation_bf_to_wf rotation_wf_to_bf"), (7, 7)),
    **dict.fromkeys(words("pi random urandom"), (0, 0)),
}
"""Operations of a function, with the least and the greatest number of operands that each takes."""

_OPERANDS = (
    {name: f"operation {name}" for name in OPERATIONS}
    | _all("property p", "operand property")
    | _all("value v", "operand value")
    | _all("table t", "table")
)
OPERANDS = frozenset(_OPERANDS)
_RANDOM: Attributes = dict.fromkeys(words("seed mean stddev lower upper"), Text.NUMBER)
RULES |= {
    "operand property": Rule(VALUED, text=Text.READ),
    "operand value": Rule(text=Text.NUMBER),
    "function": Rule({"name": Text.FUNCTION, "type": frozenset({"pre", "post"})}, _OPERANDS | PROSE, operands=(1, 1)),
    **{
        f"operation {name}": Rule(
            _RANDOM if name.endswith("random") else {}, _OPERANDS | PROSE if count[1] else {}, operands=count
        )
        for name, count in OPERATIONS.items()
    },
}

_PUSHED: Attributes = {  # JSBSim files what it does with a force under its name
    "name": Text.LABEL,
    "unit": words("LBS N LBSFT N*M"),
    "frame": words("BODY LOCAL WIND INERTIAL"),
}

_INSTANCE = "{http://www.w3.org/2001/XMLSchema-instance}"
_SCHEMA: Attributes = {f"{_INSTANCE}{name}": Text.ANY for name in ("noNamespaceSchemaLocation", "schemaLocation")}
"""Where an editor finds JSBSim's schema; nobody opens it here."""

# -- metrics, mass, contacts, forces ---------------------------------------------------------------------------------

RULES |= {
    "fdm_config": Rule(
        {
            **dict.fromkeys(("name", "version", "release"), Text.ANY),
            **_SCHEMA,
        },
        _each(
            "fileheader metrics mass_balance ground_reactions external_reactions buoyant_forces propulsion system "
            "autopilot=system flight_control=system aerodynamics"
        )
        | PROSE,
        needs=("metrics", "mass_balance"),
    ),
    "fileheader": Rule(
        children=_all("author email license filecreationdate version copyright sensitivity classification", "prose")
        | PROSE
    ),
    "metrics": Rule(
        children=_all("wingarea htailarea vtailarea", "of_area")
        | _all("wingspan chord htailarm vtailarm", "of_length")
        | _each("wing_incidence=of_angle")
        | _each("location")
        | PROSE,
        needs=("wingarea", "wingspan", "chord"),
        some=("location",),
    ),
    "mass_balance": Rule(
        {"negated_crossproduct_inertia": Text.FLAG},
        _all("ixx iyy izz ixy ixz iyz", "of_inertia") | _each("emptywt=of_mass location pointmass") | PROSE,
        needs=("ixx", "iyy", "izz", "emptywt", "location"),
    ),
    "pointmass": Rule(
        NAMED,
        _all("ixx iyy izz ixy ixz iyz", "of_inertia") | _each("weight=of_mass location form") | PROSE,
        needs=("weight", "location"),
    ),
    "form": Rule({"shape": frozenset({"tube", "cylinder", "ball", "sphere"})}, _all("length radius", "of_length")),
    "ground_reactions": Rule(children=_each("contact function") | PROSE),
    "contact": Rule(
        {**NAMED, "type": frozenset({"BOGEY", "STRUCTURE"})},
        _all("static_friction dynamic_friction rolling_friction", "number")
        | _all("damping_coeff damping_coeff_rebound", "contact_damping")
        | _each("spring_coeff=of_stiffness max_steer=of_angle")
        | _all("brake_group", "word")
        | _all("retractable castered", "flag")
        | _each("location orientation=orient strut_force=one_function")
        | PROSE,
        needs=("location",),
        needs_attributes=("type", "name"),
    ),
    "contact_damping": Rule({**_in("damping"), "type": frozenset({"LINEAR", "SQUARE"})}, text=Text.NUMBER),
    "flag": Rule(text=Text.NUMBER),
    "one_function": Rule(children=_each("function"), needs=("function",)),
    "external_reactions": Rule(children=_each("force moment function property") | PROSE),
    "force": Rule(
        _PUSHED,
        _each("location direction function property=read") | PROSE,
        needs=("location",),
        needs_attributes=("name", "frame"),
    ),
    "moment": Rule(
        _PUSHED,
        _each("direction function property=read") | PROSE,
        needs_attributes=("name", "frame"),
    ),
    "property": Rule({**VALUED, "persistent": Text.FLAG}, text=Text.WRITE),
    "buoyant_forces": Rule(children=_each("gas_cell property function") | PROSE),
    "gas_cell": Rule(
        {"type": frozenset({"HYDROGEN", "HELIUM", "AIR"})},
        _all("x_radius y_radius z_radius x_width y_width z_width", "of_length")
        | _each("max_overpressure=of_pressure valve_coefficient=of_valve fullness=number")
        | _each("location ballonet heat blower_input"),
        needs=("location",),
        needs_attributes=("type",),
    ),
    "ballonet": Rule(
        {"type": frozenset({"AIR"})},
        _all("x_radius y_radius z_radius x_width y_width z_width", "of_length")
        | _each("max_overpressure=of_pressure valve_coefficient=of_valve fullness=number")
        | _each("location heat blower_input"),
        needs=("location",),
    ),
    "heat": Rule(children=_each("function")),
    "blower_input": Rule(children=_each("function")),
}

# -- propulsion ------------------------------------------------------------------------------------------------------

RULES |= {
    "propulsion": Rule(children=_each("engine tank property function") | PROSE),
    "engine": Rule(
        {**NAMED, "file": Text.FILE},
        _each("location orient feed=whole thruster property function") | PROSE,
        needs=("thruster",),
        needs_attributes=("file",),
    ),
    "thruster": Rule(
        {**NAMED, "file": Text.FILE},
        _all("sense p_factor", "number") | _each("location orient") | PROSE,
        needs=("location",),
        needs_attributes=("file",),
    ),
    "tank": Rule(
        {**NAMED, "number": Text.WHOLE, "type": frozenset({"FUEL", "OXIDIZER"})},
        _all("capacity contents standpipe", "of_mass")
        | _all("temperature priority", "number")
        | _each("density=of_density radius=of_length unusable-volume=of_volume")
        | _each("location drain_location=location grain_config type=word")
        | PROSE,
        needs=("location", "capacity", "contents"),
        needs_attributes=("type",),
    ),
    "grain_config": Rule(
        {"type": frozenset({"CYLINDRICAL", "ENDBURNING"})},
        _all("length bore_diameter diameter", "of_length"),
        needs_attributes=("type",),
    ),
}


QUANTITIES = (
    _all("ixx", "of_inertia")
    | _all("diameter diam bore stroke chord hingeoffset ratedaltitude1 ratedaltitude2 ratedaltitude3", "of_length")
    | _all("area", "of_area")
    | _all("displacement", "of_volume")
    | _all("cylinder-head-mass", "of_mass")
    | _all("maxhp power maxpower ratedpower1 ratedpower2 ratedpower3 maxbrakepower static-friction", "of_power")
    | _all("minmp maxmp pe ratedboost1 ratedboost2 ratedboost3", "of_pressure")
    | _all("slfuelflowmax sloxiflowmax propflowmax", "of_mass-flow")
    | _all("bsfc", "of_consumption")
    | _all("milthrust maxthrust", "of_force")
    | _all("starter-torque ielumaxtorque", "of_torque")
    | _all("psfc", "of_shaft-consumption")
    | _all("twist", "of_angle")
    | _all("flappingmoment polarmoment", "of_inertia")
    | _all("massmoment", "of_mass-moment")
)
"""Of engines and thrusters, what JSBSim converts; all else is a bare number."""


def _machine(leaves: str, children: str = "", *, needs: str = "") -> Rule:
    """Return the rule of an engine or a thruster: figures, and some children."""
    figures = {name: QUANTITIES.get(name, "number") for name in leaves.split()}
    return Rule({**NAMED, "version": Text.NUMBER}, figures | _each(children) | PROSE, needs=tuple(needs.split()))


RULES |= {
    "piston_engine": _machine(
        "minmp maxmp displacement bore stroke cylinders cylinder-head-mass compression-ratio maxhp cycles idlerpm "
        "minrpm maxrpm maxthrottle minthrottle sparkfaildrop volumetric-efficiency bsfc starter-rpm starter-torque "
        "man-press-lag air-intake-impedance-factor ram-air-factor cooling-factor boost-loss-factor "
        "dynamic-fmep static-fmep static-friction numboostspeeds boostoverride boostmanual takeoffboost "
        "ratedboost1 ratedboost2 ratedboost3 ratedpower1 ratedpower2 ratedpower3 ratedrpm1 ratedrpm2 ratedrpm3 "
        "ratedaltitude1 ratedaltitude2 ratedaltitude3 peak-piston-speed max-turbo-rpm turbo-spinup",
        "table property function",
    ),
    "turbine_engine": _machine(
        "milthrust maxthrust bypassratio bleed idlen1 idlen2 maxn1 maxn2 augmented augmethod injected "
        "injection-time n1spinup n2spinup n1startrate n2startrate n1spindown n2spindown disable-windmill",
        "table property function tsfc=number_or_function atsfc=number_or_function",
    ),
    "turboprop_engine": _machine(
        "milthrust idlen1 maxn1 betarangeend reversemaxpower maxpower psfc ielumaxtorque itt_delay maxstartingtime "
        "startern1 n1idle_max_delay",
        "table property function",
    ),
    "rocket_engine": _machine(
        "builduptime maxthrottle minthrottle slfuelflowmax sloxiflowmax mixtureratio propflowmax",
        "isp=number_or_function thrust_table variation property function",
        needs="isp",
    ),
    "electric_engine": _machine("power", "property function"),
    "brushless_dc_motor": _machine(
        "maxvolts velocityconstant coilresistance noloadcurrent decelerationfactor torqueconstant",
        "property function",
        needs="maxvolts velocityconstant coilresistance noloadcurrent",  # JSBSim takes them for there
    ),
    "number_or_function": Rule({}, _each("function"), Text.NUMBER),
    "thrust_table": Rule({"name": Text.NAME, "type": frozenset({"internal"})}, _each("tableData"), some=("tableData",)),
    "variation": Rule(children=_all("thrust total_isp", "number")),
    "propeller": _machine(
        "ixx diameter numblades gearratio minpitch maxpitch minrpm maxrpm constspeed reversepitch sense p_factor "
        "ct_factor cp_factor",
        "table",
    ),
    "nozzle": _machine("area pe expr nzl_eff diam", needs="area"),
    "direct": _machine(""),
    "rotor": _machine(
        "diameter numblades gearratio nominalrpm minrpm maxrpm chord liftcurveslope twist hingeoffset flappingmoment "
        "massmoment polarmoment inflowlag tiplossfactor maxbrakepower gearloss gearmoment",
        "controlmap=word groundeffect",
    ),
    "groundeffect": Rule(children=_all("groundeffectexp groundeffectshift", "number")),
}
ENGINES = words("piston_engine turbine_engine turboprop_engine rocket_engine electric_engine brushless_dc_motor")
THRUSTERS = words("propeller nozzle direct rotor")

# -- systems ---------------------------------------------------------------------------------------------------------

_COMMON = _each("input=read output=set clipto init=value delay") | PROSE


_PLANE = frozenset({"DEG", "RAD", "FT", "M"})


def _component(values: str = "", children: str = "", *, needs: Iterable[str] = ("input",)) -> Rule:
    """Return the rule of a component of a channel; its name is the property that it sets, as is its output."""
    return Rule(
        {"name": Text.OUTPUT, "type": frozenset({"PID", "standard", "exclusive", "inclusive"}), "unit": _PLANE},
        _COMMON | _all(values, "value") | _each(children),
        some=tuple(needs),
        needs_attributes=("name",),
    )


_SENSOR = "noise quantization"
COMPONENTS: Mapping[str, Rule] = {
    **dict.fromkeys(("lag_filter", "washout_filter"), _component("c1", needs=("input", "c1"))),
    "lead_lag_filter": _component("c1 c2 c3 c4", needs=("input", "c1", "c2", "c3", "c4")),
    "second_order_filter": _component("c1 c2 c3 c4 c5 c6", needs=("input", "c1", "c2", "c3", "c4", "c5", "c6")),
    "integrator": _component("c1", "trigger=read", needs=("input", "c1")),
    "summer": _component("bias"),
    "pure_gain": _component("gain"),
    "scheduled_gain": _component("gain", "table", needs=("input", "table")),
    "aerosurface_scale": _component("gain", "domain=limits range=limits zero_centered=flag", needs=("input", "range")),
    "switch": _component(children="default test", needs=("test",)),
    "kinematic": _component(children="traverse noscale=prose", needs=("input", "traverse")),
    "deadband": _component("width gain", needs=("input", "width")),
    "fcs_function": _component(children="function", needs=("function",)),
    "pid": _component("kp ki kd", "trigger=read pvdot=read"),
    "sensor": _component("lag drift_rate gain bias", _SENSOR),
    **dict.fromkeys(
        ("gyro", "accelerometer", "magnetometer"),
        _component("lag drift_rate gain bias", f"{_SENSOR} location orientation=orient axis=word", needs=("axis",)),
    ),
    "actuator": _component("lag bias deadband_width hysteresis_width", "rate_limit"),
    **dict.fromkeys(
        ("waypoint_heading", "waypoint_distance"),
        _component(
            children="target_latitude=read target_longitude=read source_latitude=read source_longitude=read "
            "radius=number",
            needs=("target_latitude", "target_longitude", "source_latitude", "source_longitude"),
        ),
    ),
    "angle": _component(children="source_angle=read target_angle=read", needs=("source_angle", "target_angle")),
    "distributor": _component(children="case", needs=("case",)),
}
RULES |= {
    "system": Rule(
        {
            **NAMED,
            "file": Text.FILE,
            **_SCHEMA,
        },
        _each("channel property function") | PROSE,
    ),
    "channel": Rule(
        {**NAMED, "execute": Text.READ, "rate": Text.WHOLE}, {name: f"component {name}" for name in COMPONENTS} | PROSE
    ),
    **{f"component {name}": rule for name, rule in COMPONENTS.items()},
    "set": Rule(text=Text.WRITE),
    "delay": Rule({"type": frozenset({"time", "frames"})}, text=Text.DELAY),
    "rate_limit": Rule({"sense": frozenset({"incr", "decr"})}, text=Text.VALUE),
    "traverse": Rule(children=_each("setting") | PROSE, some=("setting",)),
    "setting": Rule(children=_all("position time", "number"), needs=("position", "time")),
    "default": Rule(VALUED, needs_attributes=("value",)),
    "test": Rule({**VALUED, "logic": frozenset({"AND", "OR"})}, {"test": "test"}, Text.TESTS),
    "case": Rule(children=_each("test property")),
    "noise": Rule(
        {
            "variation": frozenset({"PERCENT", "ABSOLUTE"}),
            "distribution": frozenset({"UNIFORM", "GAUSSIAN"}),
        },
        text=Text.NUMBER,
    ),
    "bits": Rule(text=Text.BITS),
    "quantization": Rule(
        {"name": Text.OUTPUT}, {"bits": "bits", "min": "number", "max": "number"}, needs=("bits", "min", "max")
    ),
}

# -- aerodynamics ----------------------------------------------------------------------------------------------------

RULES |= {
    "aerodynamics": Rule(
        children=_each("axis=force_axis function property alphalimits=limits hysteresis_limits=limits")
        | _all("aero_ref_pt_shift_x aero_ref_pt_shift_y aero_ref_pt_shift_z", "one_function")
        | PROSE
    ),
    "force_axis": Rule(
        {
            "name": words("LIFT DRAG SIDE ROLL PITCH YAW X Y Z FORWARD DOWN RIGHT AXIAL NORMAL"),
            "unit": frozenset({"LBS", "N", "LBSFT", "NM"}),
            "frame": frozenset({"BODY", "WIND", "STABILITY", "INERTIAL"}),
        },
        _each("function") | PROSE,
        needs_attributes=("name",),
    ),
}
