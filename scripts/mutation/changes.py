"""What may be changed of a source, and what it becomes; what the kinds are is in `scripts/mutants.py`."""

import ast
import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import UnionType

ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
ARITHMETIC |= {ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd}
COMPARISON = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.GtE), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}  # fmt: skip
PAIRS = (("min", "max"), ("minimum", "maximum"), ("sin", "cos"), ("any", "all"), ("floor", "ceil"), ("left", "right"))
OTHER = {a: b for pair in PAIRS for a, b in (pair, pair[::-1])}
LEFT_ALONE = (ast.Raise, ast.Assert, ast.Import, ast.ImportFrom, ast.JoinedStr)
COMMUTE = ("_dot", "isinstance", "getattr")  # whose arguments may be exchanged, or are no numbers
SILENT = ("log", "logger", "logging", "warnings", "print")


@dataclass(frozen=True)
class Mutant:
    """One change of one file: of the lines `first` … `last`, 1 being the first, the text between two columns."""

    file: str
    line: int
    kind: str
    before: str
    after: str
    span: tuple[int, int, int, int]

    @property
    def what(self) -> str:
        """The change, in a line."""
        return f"{_short(self.before)}  →  {_short(self.after)}"

    def applied(self, source: str) -> str:
        """Return the source with the change; its lines keep their numbers."""
        first, start, last, end = self.span
        lines = source.encode().split(b"\n")
        head, tail = lines[first - 1][:start], lines[last - 1][end:]
        changed = head + self.after.encode() + tail + b"\n" * (last - first)
        return b"\n".join([*lines[: first - 1], changed, *lines[last:]]).decode()


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 70 else line[:67] + "..."


def mutants_of(file: str, source: str) -> list[Mutant]:
    """Return every mutant of a file, in the order of the text."""
    found = []
    for node in _nodes(ast.parse(source)):
        if isinstance(node, ast.If | ast.While):
            found.append(_mutant(file, "condition", node.test, ast.UnaryOp(ast.Not(), node.test)))
        if isinstance(node, ast.expr | ast.stmt):
            found += [_mutant(file, kind, node, changed) for kind, changed in _changes(node)]
    return found


def _mutant(file: str, kind: str, node: ast.expr | ast.stmt, changed: ast.AST) -> Mutant:
    after = ast.unparse(changed)
    if isinstance(node, ast.expr):
        after = f"({after})"
    span = (node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0)
    return Mutant(file, node.lineno, kind, ast.unparse(node), after, span)


def _nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield what may be changed; of a comparison's chain or a call's parts each."""
    for child in ast.iter_child_nodes(tree):
        if isinstance(child, LEFT_ALONE) or _is_text(child) or _is_protocol(child):
            continue
        if isinstance(child, ast.Assign) and any(getattr(t, "id", "").startswith("__") for t in child.targets):
            continue
        if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
            continue
        if isinstance(child, ast.AnnAssign):
            if child.value is not None:
                yield from _with_inner(child.value)
        elif isinstance(child, ast.FunctionDef):
            for part in (*child.args.defaults, *(d for d in child.args.kw_defaults if d is not None)):
                yield from _with_inner(part)
            yield from _nodes(ast.Module(body=child.body, type_ignores=[]))
        elif isinstance(child, ast.ClassDef):
            yield from _nodes(ast.Module(body=child.body, type_ignores=[]))
        else:
            yield from _with_inner(child)


def _with_inner(node: ast.AST) -> Iterator[ast.AST]:
    if not isinstance(node, LEFT_ALONE):
        yield node
        yield from _nodes(node)


def _is_text(node: ast.AST) -> bool:
    """Whether it is a docstring, or a message that is written."""
    if not isinstance(node, ast.Expr):
        return False
    if isinstance(node.value, ast.Constant):
        return True
    return isinstance(node.value, ast.Call) and ast.unparse(node.value.func).partition(".")[0] in SILENT


def _is_protocol(node: ast.AST) -> bool:
    return isinstance(node, ast.ClassDef) and any("Protocol" in ast.unparse(base) for base in node.bases)


def _changes(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield the kinds of change of a node and what it becomes."""
    for kinds, changes in CHANGES:
        if isinstance(node, kinds):
            yield from changes(node)


def _arithmetic(node: ast.BinOp | ast.AugAssign) -> Iterator[tuple[str, ast.AST]]:
    if type(node.op) in ARITHMETIC and not _is_union(node):
        yield "arithmetic", _with(node, op=ARITHMETIC[type(node.op)]())
    if isinstance(node, ast.AugAssign):
        yield "statement", ast.Pass()


def _comparisons(node: ast.Compare) -> Iterator[tuple[str, ast.AST]]:
    for i, op in enumerate(node.ops):
        for other in COMPARISON[type(op)]:
            yield "comparison", _with(node, ops=[*node.ops[:i], other(), *node.ops[i + 1 :]])


def _boolean(node: ast.BoolOp) -> Iterator[tuple[str, ast.AST]]:
    yield "boolean", _with(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())


def _signs(node: ast.UnaryOp) -> Iterator[tuple[str, ast.AST]]:
    if not isinstance(node.op, ast.UAdd):
        yield "sign" if isinstance(node.op, ast.USub) else "boolean", node.operand


def _swapped(node: ast.IfExp) -> Iterator[tuple[str, ast.AST]]:
    yield "condition", _with(node, body=node.orelse, orelse=node.body)


def _left_out(node: ast.Assign | ast.Expr) -> Iterator[tuple[str, ast.AST]]:
    kept = isinstance(node, ast.Assign) and any(isinstance(t, ast.Name | ast.Tuple) for t in node.targets)
    if not kept and (isinstance(node, ast.Assign) or isinstance(node.value, ast.Call)):
        yield "statement", ast.Pass()


def _constants(node: ast.Constant) -> Iterator[tuple[str, ast.AST]]:
    value = node.value
    if isinstance(value, bool):
        yield "boolean", ast.Constant(not value)
    elif isinstance(value, int):
        yield "constant", ast.Constant(value + 1)
    elif isinstance(value, float):
        for changed in (1.1 * value, 2.0 * value) if value else (1.0,):
            yield "constant", ast.Constant(changed)
    elif isinstance(value, str) and value in ("left", "right"):
        yield "side", ast.Constant(OTHER[value])


def _calls(node: ast.Call) -> Iterator[tuple[str, ast.AST]]:
    function = node.func
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    if name in OTHER:
        changed = copy.copy(function)
        setattr(changed, "attr" if isinstance(function, ast.Attribute) else "id", OTHER[name])
        yield "function", _with(node, func=changed)
    plain = not any(isinstance(a, ast.Starred) for a in node.args[:2])
    if len(node.args) > 1 and plain and name not in (*OTHER, *COMMUTE):
        yield "arguments", _with(node, args=[node.args[1], node.args[0], *node.args[2:]])


def _is_union(node: ast.AST) -> bool:
    """Whether it is a union of types or of mappings, or a sum of texts: no arithmetic."""
    text = isinstance(node, ast.BinOp) and any(isinstance(n, ast.JoinedStr) for n in (node.left, node.right))
    return text or (isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr) and "None" in ast.unparse(node))


def _with(node: ast.AST, **changes: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in changes.items():
        setattr(changed, name, value)
    return changed


CHANGES: tuple[tuple[type | UnionType, Callable[..., Iterator[tuple[str, ast.AST]]]], ...] = (
    (ast.BinOp | ast.AugAssign, _arithmetic),
    (ast.Compare, _comparisons),
    (ast.BoolOp, _boolean),
    (ast.UnaryOp, _signs),
    (ast.Constant, _constants),
    (ast.Call, _calls),
    (ast.IfExp, _swapped),
    (ast.Assign | ast.Expr, _left_out),
)
