"""Expressions as Python. Factors and terms stand in the order in which `physics` declares its symbols.

So the order of the operations, and with it the rounding, is fixed by the model and not by the version of sympy.
"""

import sympy as sp

from airspeed_model.physics import ORDER

RANK = {symbol: rank for rank, symbol in enumerate(ORDER)}


def code(expression: sp.Expr, names: dict[sp.Symbol, str] | None = None) -> str:
    """Write an expression.

    Parameters
    ----------
    expression : sympy.Expr
        Of numbers, symbols, sums, products, whole and half powers.
    names : dict, optional
        What symbols are called, if not by their own name.
    """
    names = names or {}
    if isinstance(expression, sp.Symbol):
        return names.get(expression, expression.name)
    if isinstance(expression, sp.Number):
        return repr(float(expression))
    if isinstance(expression, sp.Add):
        return _sum(sorted(expression.args, key=_rank), names)
    return _product(expression, names)


def sum_of(terms: list[str]) -> str:
    """Join terms, of which some begin with a minus."""
    return "".join(
        term if not i else f" - {term[1:]}" if term.startswith("-") else f" + {term}" for i, term in enumerate(terms)
    )


def times(coefficient: str, name: str) -> str:
    """Write coefficient times a name; "1.0" is left out."""
    return name if coefficient == "1.0" else f"{coefficient} * {name}"


def _rank(expression: sp.Expr) -> list[int]:
    return sorted(RANK[symbol] for symbol in expression.free_symbols)


def _sum(terms: list[sp.Expr], names: dict[sp.Symbol, str]) -> str:
    return sum_of([code(term, names) for term in terms])


def _power(base: sp.Expr, exponent: sp.Expr, names: dict[sp.Symbol, str]) -> list[str]:
    text = code(base, names)
    text = f"({text})" if isinstance(base, sp.Add) else text
    half = ["sqrt(" + text + ")"] if exponent % 1 else []
    return [text] * int(sp.floor(exponent)) + half


def _product(expression: sp.Expr, names: dict[sp.Symbol, str]) -> str:
    number, rest = expression.as_coeff_Mul()
    size, found = abs(number), ""
    if size == sp.Rational(1, 2):
        found, size = "0.5", sp.S.One
    elif size.p != 1:
        found = repr(float(size.p))
    for factor in sorted(sp.Mul.make_args(rest), key=_rank):
        base, exponent = factor.as_base_exp()
        for text in _power(base, abs(exponent), names):
            sign = "/" if exponent < 0 else "*"
            found = text if sign == "*" and not found else f"{found or '1.0'} {sign} {text}"
    if size.q != 1:
        found = f"{found} / {float(size.q)!r}"
    return "-" + found if number < 0 else found
