"""The steps of the filter on state and covariance, written out on the 21 numbers of a symmetric matrix.

The transition F is the product of row operations, x_i ← x_i + Σ m_j x_j, and of a diagonal matrix. A row operation on
the rows and columns of the covariance P costs few products, where F P Fᵀ costs many. `module.prove` multiplies the
operations out and compares them with F P Fᵀ + Q.
"""

from collections.abc import Callable

import sympy as sp

from airspeed_model.physics import STATES
from airspeed_model.printing import code, sum_of, times

NAMES = [state.name for state in STATES]
Entries = dict[str, sp.Expr]
Namer = Callable[[str], str]
LEARNED = "d"  # the state that may be held as it is


def entry(i: str, j: str) -> str:
    """Name of an entry of the covariance, its states in their order."""
    return i + j if NAMES.index(i) <= NAMES.index(j) else j + i


def pairs(states: str) -> list[tuple[str, str]]:
    """List the entries of the upper triangle by rows."""
    return [(i, j) for n, i in enumerate(states) for j in states[n:]]


def by_rows(states: str) -> list[list[str]]:
    """List the names of the upper triangle, a row of the matrix each."""
    return [[i + j for j in states[n:]] for n, i in enumerate(states)]


class Prediction:
    """Writes P ← F P Fᵀ + Q.

    Parameters
    ----------
    states : str
        The states that take part; the others are known.
    """

    def __init__(self, states: str) -> None:
        self.states = states
        self.lines: list[str] = []
        self._now = {entry(i, j): entry(i, j) for i, j in pairs(states)}

    def name(self, i: str, j: str) -> str:
        """Name under which an entry stands at present."""
        return self._now[entry(i, j)]

    def row(self, i: str, coefficients: dict[str, str], noise: str = "") -> None:
        """Do x_i ← x_i + Σ m_j x_j on rows and columns, and add noise to the entry ii in the same sum.

        Parameters
        ----------
        i : str
            The state whose row it is.
        coefficients : dict
            m_j, as code, by j.
        noise : str
            As code.
        """
        fresh = {j: entry(i, j)[::-1] for j in coefficients}
        for j, new in fresh.items():
            terms = _grouped(coefficients, lambda m, j=j: [self.name(m, j)])
            self.lines.append(f"{new} = {sum_of([self.name(i, j), *terms])}")
        grown = _grouped(coefficients, lambda m: [self.name(i, m), fresh[m]])
        if noise:
            grown = [noise, *grown] if grown[0].startswith("-") else [*grown, noise]
        self._add(entry(i, i), grown)
        for j, new in fresh.items():
            self._now[entry(i, j)] = new
        for j in self.states:
            if j != i and j not in coefficients:
                terms = _grouped(coefficients, lambda m, j=j: [self.name(m, j)])
                old = self.name(i, j)
                if old == entry(i, j):
                    self._add(old, terms)
                else:
                    self.lines.append(f"{entry(i, j)} = {sum_of([old, *terms])}")
                    self._now[entry(i, j)] = entry(i, j)

    def _add(self, name: str, terms: list[str]) -> None:
        text = sum_of(terms)
        if len(terms) == 1 and text.startswith("-"):
            self.lines.append(f"{name} -= {text[1:]}")
        else:
            self.lines.append(f"{name} += {text}")

    def scale(self, factors: dict[str, str], noise: Entries, short: dict[str, sp.Expr]) -> None:
        """Multiply rows and columns by the diagonal's factors, and add noise.

        Parameters
        ----------
        factors : dict
            As code, by state.
        noise : dict
            Q, by entry.
        short : dict
            Names of parts of Q that have been computed.
        """
        for i, j in pairs(self.states):
            name, old, q = entry(i, j), self.name(i, j), noise.get(entry(i, j), sp.S.Zero)
            by = [factors[state] for state in (i, j) if state in factors]
            added = [] if q == 0 else [shortened(q, short)]
            if by or old != name:
                self.lines.append(f"{name} = {sum_of([' * '.join([*by, old]), *added])}")
            elif added:
                self._add(name, added)
            self._now[name] = name


def _grouped(coefficients: dict[str, str], of: Callable[[str], list[str]]) -> list[str]:
    """Write Σ m_j · (names), those of the same coefficient in one bracket."""
    groups: dict[str, list[str]] = {}
    for j, coefficient in coefficients.items():
        groups.setdefault(coefficient, []).extend(of(j))
    return [times(m, f"({' + '.join(names)})" if len(names) > 1 else names[0]) for m, names in groups.items()]


def shortened(q: sp.Expr, short: dict[str, sp.Expr]) -> str:
    """Write an entry of Q by a part that has been computed, where it is that part times a whole expression."""
    for name, part in short.items():
        rest = sp.factor(q / part)
        if abs(rest.as_coeff_Mul()[0]) == 1 and not rest.free_symbols & part.free_symbols:
            sign = "-" if rest.as_coeff_Mul()[0] < 0 else ""
            text = code(abs(rest.as_coeff_Mul()[0]) * rest.as_coeff_Mul()[1])
            return f"{sign}{name} * ({text})" if isinstance(rest, sp.Add) else f"{sign}{name} * {text}"
    return code(sp.factor(q))


def towards(slopes: dict[str, str], states: str, name: Namer) -> list[str]:
    """Write g = P hᵀ, the covariance of the states with the reading."""
    return [f"g{i} = " + " + ".join(times(slopes[j], name(entry(i, j))) for j in slopes) for i in states]


def spread(slopes: dict[str, str], *more: str) -> str:
    """Write h P hᵀ + R, the variance of the innovation."""
    return " + ".join([*(times(slope, f"g{j}") for j, slope in slopes.items()), *more])


def correct(states: str, name: Namer, *, held: str = "") -> list[str]:
    """Write x ← x + K ν and P ← P − K g, with K = g over the innovation's variance.

    A state that is not learned (`LEARNED`) has K = 0: it stays, and P with it, but what the others have to do with it
    changes as theirs do (Schmidt's filter). Of those that are `held` for certain nothing is written but the last.
    """
    gains = {i: f"g{i} / spread" if i != LEARNED else f"self._learns * g{i} / spread" for i in states}
    lines = [f"k{i} = {gain}" for i, gain in gains.items() if i not in held]
    lines += [f"{name(i)} += k{i} * innovation" for i in states if i not in held]
    for i, j in pairs(states):
        if i == j and i in held:
            continue
        gained, other = (i, j) if i != LEARNED or i == j else (j, i)
        lines.append(f"{name(i + j)} -= k{gained} * g{other}")
    return lines
