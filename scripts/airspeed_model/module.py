"""The text of `uavsim/onboard/airspeed/energy_model.py`: `frame.txt` with the model's expressions in it."""

import re
import subprocess
import sys
from pathlib import Path
from string import Template

import sympy as sp

from airspeed_model import physics
from airspeed_model.covariance import LEARNED, NAMES, Prediction, by_rows, correct, entry, pairs, spread, times, towards
from airspeed_model.physics import H_STATIC, H_TOTAL, Q_RAIL, STATES, F, Q
from airspeed_model.printing import code

FRAME = Path(__file__).with_name("frame.txt")
ALL, STEADY = "vbpsdk", "vbpsd"  # without a push k is told nothing, and is known
MIDDLE = "(v + 0.5 * change)"
ACROSS = {physics.middle: -physics.c / (physics.density * physics.dt)}  # Q by c = ∂p/∂s of the step
SHORT = {"third": physics.dt**2 / 3, "half": physics.dt / 2}  # what Q's entries share
RATIO = physics.Y ** sp.Rational(7, 2)  # of total and static pressure
NOISE = {"p": "self._static_density * dt", "d": "self._difference_density * dt"}


def local(name: str) -> str:
    """Name a number that has been loaded."""
    return name


def own(name: str) -> str:
    """Name a number where the filter keeps it."""
    return f"self.{name}"


def checked(text: str, expression: sp.Expr, **parts: sp.Expr) -> str:
    """Return what is written by hand, for the order of its operations, if it is the expression.

    Raises
    ------
    ArithmeticError
        It is something else.
    """
    names = {symbol.name: symbol for symbol in physics.ORDER} | parts
    if sp.simplify(sp.nsimplify(sp.sympify(text, locals=names)) - expression) != 0:
        raise ArithmeticError(f"{text} is not {expression}")
    return text


# -- prediction --------------------------------------------------------------------------------------------------------


def moved(states: str, joined: bool) -> Prediction:
    """Write the row operations of F, and the noise that is there on the rail, too.

    Parameters
    ----------
    states : str
    joined : bool
        Whether v's noise is added to its variance in one sum with the rest.
    """

    def row(i: int, named: dict[str, str]) -> dict[str, str]:
        return {NAMES[j]: named.get(NAMES[j], code(F[i, j])) for j in range(6) if j != i and F[i, j] != 0}

    done = Prediction(states)
    done.row("p", row(2, {"v": "a", "s": "c"}), NOISE["p"])
    done.row("v", row(0, {}), "variance" if joined else "")
    if not joined:
        done.lines.append("vv += variance")
    done.lines.append(f"dd += {NOISE['d']}")
    return done


def finished(done: Prediction, railed: bool) -> list[str]:
    """Write the rest of the step: the decay of b and s in flight, and their noise."""
    before = len(done.lines)
    always = Q_RAIL.subs({physics.bias: 0, physics.slope: 0})
    more = ((Q_RAIL if railed else Q) - always).subs(ACROSS).applyfunc(sp.factor)
    noise = {i + j: more[NAMES.index(i), NAMES.index(j)] for i, j in pairs(ALL)}
    done.scale({} if railed else {"b": "keep", "s": "stay"}, noise, {} if railed else SHORT)
    return done.lines[before:]


def prove(lines: list[str], states: str, railed: bool) -> None:
    """Multiply out what has been written and compare it with F P Fᵀ + Q.

    Raises
    ------
    ArithmeticError
        It is something else.
    """
    tied = sp.symbols("a c keep stay dt bias slope variance walk drift")
    a, c, keep, stay, dt, *_ = tied
    known = {entry(i, j): sp.Symbol(entry(i, j)) for i, j in pairs(states)}
    place = {symbol.name: symbol for symbol in tied} | known | {"half": dt / 2, "third": dt**2 / 3}
    text = "\n".join(lines).replace(NOISE["p"], "walk").replace(NOISE["d"], "drift")
    exec(text, {}, place)  # noqa: S102 - the lines that were written here
    size, plain = len(states), {symbol: sp.Symbol(symbol.name) for symbol in physics.ORDER}
    f = F[:size, :size].subs(plain)
    f[2, 0], f[2, 3] = a, c
    f[1, 1], f[3, 3] = (1, 1) if railed else (keep, stay)
    p = sp.Matrix(size, size, lambda i, j: known[entry(states[i], states[j])])
    wanted = f * p * f.T + (Q_RAIL if railed else Q).subs(ACROSS)[:size, :size].subs(plain)
    for i, j in pairs(states):
        left = sp.expand(place[i + j] - wanted[states.index(i), states.index(j)])
        if left != 0:
            raise ArithmeticError(f"{i + j}: {left} too much")


# -- measurements ------------------------------------------------------------------------------------------------------


def by_y(expression: sp.Expr) -> sp.Expr:
    """Put y for 1 + v²/heat, and power for y^(5/2)."""
    least = sp.Rational(5, 2)
    return expression.subs(physics.Y, physics.y).replace(
        lambda part: part.is_Pow and part.base == physics.y and part.exp >= least,
        lambda part: physics.power * physics.y ** (part.exp - least),
    )


def slopes(row: sp.Matrix, states: str = ALL, named: dict[str, str] | None = None) -> dict[str, str]:
    """Return h as code, by state."""
    named = named or {}
    return {i: named.get(i, code(row[NAMES.index(i)])) for i in states if row[NAMES.index(i)] != 0}


def bent(v: str = "v", p: str = "p") -> list[str]:
    """Write y, its power, the curvature, and the slopes of the total pressure in v and p."""
    names = {physics.v: v, physics.p: p}
    return [
        f"y = {code(physics.Y, names)}",
        f"power = {code(physics.y ** sp.Rational(5, 2))}",
        f"curvature = {code(by_y(H_TOTAL[0]) / physics.v, names)}",
        f"hv = {code(physics.curvature * physics.v, names)}",
        f"hp = {code(by_y(H_TOTAL[2]), {physics.relative: own('_relative')})}",
    ]


def taken_off(row: dict[str, str], name=local) -> str:
    """Write what is taken off a reading: h is Σ ∂h/∂x x over the states but v, in which it is not linear."""
    return "".join(f" - {times(slope, name(i))}" for i, slope in row.items() if i != "v")


def check_linear() -> None:
    """Raise unless both h are what `taken_off` takes them for."""
    for h, row in ((physics.STATIC, H_STATIC), (physics.TOTAL, H_TOTAL)):
        rest = h - sum(row[n] * state for n, state in enumerate(STATES) if state is not physics.v)
        if sp.simplify(rest) != 0:
            raise ArithmeticError(f"{h} is not linear in p, s, d and k")


# -- the module --------------------------------------------------------------------------------------------------------


def block(lines: list[str], depth: int) -> str:
    """Indent lines; the first stands where the frame has put it."""
    return ("\n" + 4 * depth * " ").join(lines)


def packed(names: list[str], values: list[str]) -> str:
    """Assign several at once."""
    return f"{', '.join(names)} = {', '.join(values)}"


def loads(rows: list[list[str]]) -> list[str]:
    """Load numbers of the filter."""
    return [packed(row, [own(name) for name in row]) for row in in_threes(rows)]


def stores(rows: list[list[str]]) -> list[str]:
    """Store them."""
    return [packed([own(name) for name in row], row) for row in in_threes(rows)]


def in_threes(rows: list[list[str]]) -> list[list[str]]:
    """Divide rows into what Python assigns at once without making a tuple."""
    return [row[n : n + 3] for row in rows for n in range(0, len(row), 3)]


def named(lines: list[str], states: str, what: str) -> list[list[str]]:
    """Return the rows of state and covariance, as far as lines name them; `what` is a pattern around the name."""
    rows = [[state for state in states if state not in "dk"], *by_rows(states)]
    found = set(re.findall(what, "\n".join(lines), re.MULTILINE))
    return [row for row in ([name for name in row if name in found] for row in rows) if row]


def items(matrix: sp.Matrix, unit: sp.Matrix) -> list[str]:
    """Write the entries of a matrix that are not those of another, as items of a dict."""
    return [
        f"({NAMES[i].upper()}, {NAMES[j].upper()}): {code(matrix[i, j])},"
        for i in range(6)
        for j in range(6)
        if matrix[i, j] != unit[i, j]
    ]


def prediction() -> dict[str, str]:
    """Return the pieces of `predict`, and those of the step in steady flight."""
    whole, railed = moved(ALL, joined=False), moved(ALL, joined=False)
    first = list(whole.lines)
    on_rail, in_flight = finished(railed, railed=True), finished(whole, railed=False)
    steady = moved(STEADY, joined=True)
    finished(steady, railed=False)
    prove(railed.lines, ALL, railed=True)
    prove(whole.lines, ALL, railed=False)
    prove(steady.lines, STEADY, railed=False)
    moving = ["p += c * s", "v += change"]
    used = named([*moving, "b", "s", *railed.lines, *whole.lines], ALL, r"\w+")
    changed = [named([*moving, *lines], ALL, r"^\w+") for lines in (railed.lines, ["b", "s", *whole.lines])]
    return {
        "change": checked("gained - dt * (b + s)", physics.CHANGE),
        "middle": checked("v + 0.5 * change", physics.MIDDLE, change=physics.CHANGE),
        "across": packed(["a", "c"], [code(F[2, 0]), code(F[2, 3], {physics.middle: MIDDLE})]),
        "gained_p": checked("c * s", (physics.STEP[2] - physics.p).subs(ACROSS)),
        "keep": checked("1.0 - dt / bias_time", F[1, 1]).replace("bias_time", "self._bias_time"),
        "stay": checked("1.0 - dt / slope_time", F[3, 3]).replace("slope_time", "self._slope_time"),
        "short": packed(["half", "third"], [code(SHORT["half"]), code(SHORT["third"])]),
        "load_all": block(loads(used), 2),
        "store_railed": block(stores(changed[0]), 3),
        "store_flown": block(stores(changed[1]), 3),
        "moved": block(first, 2),
        "railed": block(on_rail, 3),
        "flown": block(in_flight, 3),
        "load_steady": block(loads([list(STEADY), *by_rows(STEADY)]), 2),
        "store_steady": block(stores([list(STEADY), *by_rows(STEADY)]), 2),
        "steady": block(steady.lines, 2),
    }


def updates() -> dict[str, str]:
    """Return the pieces of both updates, and those of steady flight."""
    check_linear()
    static, total = slopes(H_STATIC), slopes(H_TOTAL, ALL, {"v": "hv", "p": "hp"})
    known = {i: slope for i, slope in total.items() if i in STEADY}
    at = {"v": "at_v", "p": "at_p"}

    def partly(name: str) -> str:
        return name if name in ("v", "p", "vv") else own(name)

    bend = "0.5 * bend * bend"
    return {
        "static_g": block(towards(static, STEADY, local), 2),
        "static_off": taken_off(static),
        "static_spread": spread(static, "static_variance"),
        "total_g": block(towards(known, STEADY, local), 3),
        "total_off": taken_off(known),
        "total_spread": spread(known, "total_variance", bend),
        "correct_3": block(correct(STEADY, local, held=LEARNED), 3),
        "correct_4": block(correct(STEADY, local, held=LEARNED), 4),
        "bent": block(bent(), 2),
        "own_static_g": block(towards(static, ALL, own), 2),
        "own_static_off": taken_off(static, own),
        "own_static_spread": spread(static, "variance"),
        "own_total_g": block(towards(total, ALL, partly), 2),
        "own_total_off": taken_off(total, partly),
        "own_total_spread": spread(total, "variance", bend),
        "at_bent": block(bent("at_v", "at_p"), 3),
        "at_g": block(towards(total, "vpdk", own), 3),
        "at_rest_g": block(towards(total, "bs", own), 2),
        "at_spread": spread(total, "variance"),
        "at_off": f" - {times(total['p'], at['p'])}"
        + "".join(f" - {total[i]} * ({i} - {at[i]})" for i in at)
        + taken_off({i: slope for i, slope in total.items() if i not in at}),
        "correct_own": block(correct(ALL, own), 2),
    }


def elementwise() -> dict[str, str]:
    """Return the pieces of the functions that take floats or arrays."""
    decayed = {F[1, 1]: physics.keep, F[3, 3]: physics.stay}
    zero = sp.zeros(6, 6)
    q = Q.subs(ACROSS).applyfunc(lambda one: sp.expand(one) if one.is_Add else one)
    return {
        "transition": block(items(F.applyfunc(lambda one: decayed.get(one, one)), physics.UNIT), 2),
        "noise": block(items(q, zero), 2),
        "start": block(items(physics.START, zero), 2),
        "static_h": ", ".join(f"{i.upper()}: {slope}" for i, slope in slopes(H_STATIC).items()),
        "total_h": ", ".join(
            f"{i.upper()}: {slope}" for i, slope in slopes(H_TOTAL, ALL, {"v": "hv", "p": "hp"}).items()
        ),
        "total_power": checked("(1.0 + v * v / heat) ** 3.5", RATIO),
        "total_pressure": checked("p * (power - relative) + d + pushed * k", physics.TOTAL, power=RATIO),
        "total_hv": checked("7.0 * p / heat * v * y**2.5", H_TOTAL[0], y=physics.Y),
        "total_hp": checked("y**3.5 - relative", H_TOTAL[2], y=physics.Y),
        "total_y": checked("1.0 + v * v / heat", physics.Y),
        "isentropic": checked("p * y * y * y * sqrt(y)", physics.p * RATIO, y=physics.Y),
        "isentropic_speed": inverse("sqrt(heat * expm1(2.0 / 7.0 * log1p(excess)))"),
    }


def foretold() -> dict[str, str]:
    """Return the pieces of `foretell`: the first row of f and of F P Fᵀ."""
    v, b, _, s, *_ = STATES
    p = sp.Matrix(6, 6, lambda i, j: sp.Symbol(entry(NAMES[i], NAMES[j])))
    spread = (F * p * F.T)[0, 0]
    known = {name.name: name for name in p.free_symbols}
    spread_code = checked("vv + dt * (dt * (bb + 2.0 * bs + ss) - 2.0 * (vb + vs))", spread, **known)
    return {
        "told_v": checked("v + gained - dt * drift", physics.STEP[0], drift=b + s),
        "told_vv": re.sub(r"\b([vbs]{2})\b", r"self.\1", spread_code),
        "told_p": "self." + checked("p - density * v * s * dt", physics.STEP[2].subs(physics.middle, v)),
    }


def inverse(text: str) -> str:
    """Return the airspeed's expression if it is the inverse of the isentropic relation.

    Raises
    ------
    ArithmeticError
        It is not.
    """
    excess = physics.Y ** sp.Rational(7, 2) - 1
    names = {"heat": physics.heat, "excess": excess, "expm1": lambda x: sp.exp(x) - 1, "log1p": lambda x: sp.log(1 + x)}
    if sp.simplify(sp.nsimplify(sp.sympify(text, locals=names)) - physics.v) != 0:
        raise ArithmeticError(f"{text} is not the airspeed")
    return text


def written() -> str:
    """Write the module."""
    text = Template(FRAME.read_text(encoding="utf-8")).substitute(prediction() | updates() | foretold() | elementwise())
    formatter = [sys.executable, "-m", "ruff", "format", "--stdin-filename", "energy_model.py", "-"]
    return subprocess.run(formatter, input=text, text=True, capture_output=True, check=True).stdout
