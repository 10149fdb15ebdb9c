"""One file against the grammar: every element, attribute and text of it.

What is not on the list is refused with what is allowed; for elements that do something else than describe an aircraft
the line says what.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches

from uavsim.plants.airframe.grammar import OPERANDS, RULES, Rule, Text
from uavsim.plants.airframe.markup import Element, MarkupError
from uavsim.plants.airframe.properties import (
    is_file,
    is_label,
    is_read,
    may_be_called,
    may_name_function,
    may_set,
    plain,
    words,
)
from uavsim.plants.airframe.tables import check_table, check_traverse, number

OPERATORS = words("EQ NE GT GE LT LE eq ne gt ge lt le == != > >= < <=")
LONGEST_NAME = 200

_REFUSED = {
    "output": "it writes files and opens sockets",
    "input": "it opens a socket that listens",
    "child": "it loads another aircraft",
    "planet": "it changes the earth",
    "atmosphere": "it changes the air",
}


def check_document(root: Element, *, is_named: bool) -> dict[str, int]:
    """Check a file.

    Parameters
    ----------
    root
        Its outermost element, whose tag is a rule of the grammar.
    is_named
        Whether another file names it: then it names none itself.

    Returns
    -------
    dict of str to int
        The properties that it reads, each with a line.

    Raises
    ------
    MarkupError
        One line that names line, element and what is allowed.
    """
    if is_named and "file" in root.attributes:
        raise MarkupError(f"<{root.tag}>: a file that is named may not name another", root.line)
    rule = RULES["system" if root.tag in {"autopilot", "flight_control"} else root.tag]
    reads: dict[str, int] = {}
    _check(root, rule, reads)
    return reads


def _check(element: Element, rule: Rule, reads: dict[str, int]) -> None:
    _check_attributes(element, rule)
    _check_text(element, rule)
    _note(element, rule, reads)
    for child in element.children:
        if child.tag not in rule.children:
            raise MarkupError(_unknown(child.tag, element.tag, rule), child.line)
    _check_needs(element, rule)
    for child in element.children:
        _check(child, RULES[rule.children[child.tag]], reads)
    if element.tag in _CLOSER:
        _CLOSER[element.tag](element)


def _check_attributes(element: Element, rule: Rule) -> None:
    for name, value in element.attributes.items():
        allowed = rule.attributes.get(name)
        if allowed is None:
            raise MarkupError(
                f"<{element.tag}>: unknown attribute {name[:40]!r}; allowed: {_listed(rule.attributes)}", element.line
            )
        problem = _problem(value.strip(), allowed) if isinstance(allowed, Text) else _no_word(value, allowed)
        if problem:
            raise MarkupError(f"<{element.tag} {name}>: {problem}", element.line)
    for name in rule.needs_attributes:
        if not element.attributes.get(name, "").strip():
            raise MarkupError(f"<{element.tag}>: needs the attribute {name!r}", element.line)


def _note(element: Element, rule: Rule, reads: dict[str, int]) -> None:
    """Remember the properties that an element reads."""
    texts = [(element.text, rule.text)]
    texts += [
        (text.strip(), kind)
        for name, text in element.attributes.items()
        if isinstance(kind := rule.attributes[name], Text)
    ]
    for text, kind in texts:
        words = text.split() if kind is Text.TESTS else [text]
        if kind in {Text.READ, Text.VALUE, Text.TESTS}:
            for word in words:
                if word and word not in OPERATORS and number(word) is None:
                    reads.setdefault(plain(word), element.line)


def _no_word(value: str, words: Iterable[str]) -> str:
    """Say why a text is none of these words; nothing if it is one."""
    known = sorted(words)
    if value in known:
        return ""
    near = get_close_matches(value[:60], known, n=1, cutoff=0.4)
    return f"is {value[:40]!r}; " + (f"did you mean {near[0]!r}?" if near else f"allowed: {_listed(known)}")


def _check_text(element: Element, rule: Rule) -> None:
    if rule.text is Text.NUMBER and rule.children and element.children:
        return  # a function in the number's place
    if problem := _problem(element.text, rule.text):
        raise MarkupError(f"<{element.tag}>: {problem}", element.line)


def _problem(text: str, kind: Text) -> str:
    """Say why a text is not of this kind; nothing if it is."""
    if _FITS[kind](text):
        return ""
    shown = f"{text[:60]!r}" if text else "empty"
    return f"is {shown}; allowed: {kind.value}"


def _is_name(text: str) -> bool:
    return len(text) <= LONGEST_NAME and text.isprintable()


def _is_value(text: str) -> bool:
    return number(text) is not None or is_read(text)


def _are_tests(text: str) -> bool:
    """Whether each line compares a property with a number or a property."""
    lines = [line.split() for line in text.splitlines() if line.strip()]
    return all(len(line) == 3 and is_read(line[0]) and line[1] in OPERATORS and _is_value(line[2]) for line in lines)


_FITS: Mapping[Text, Callable[[str], bool]] = {
    Text.NONE: lambda text: not text,
    Text.ANY: lambda _: True,
    Text.ROWS: lambda _: True,  # looked at with the table
    Text.NAME: _is_name,
    Text.NUMBER: lambda text: number(text) is not None,
    Text.WHOLE: lambda text: re.fullmatch("[0-9]{1,3}", text) is not None,
    Text.FLAG: lambda text: text in {"true", "false", "0", "1"},
    Text.READ: is_read,
    Text.WRITE: lambda text: may_set(text) or ("/" not in text and may_be_called(text)),
    Text.OUTPUT: may_be_called,
    Text.BITS: lambda text: re.fullmatch("[0-9]{1,2}", text) is not None and 1 <= int(text) <= 32,
    Text.DELAY: lambda text: (value := number(text)) is not None and 0.0 <= value <= 1000.0,
    Text.LABEL: is_label,
    Text.FUNCTION: may_name_function,
    Text.VALUE: _is_value,
    Text.TESTS: _are_tests,
    Text.FILE: is_file,
}


def _unknown(tag: str, parent: str, rule: Rule) -> str:
    if parent == "fdm_config" and tag.lower() in _REFUSED:
        return f"<{tag}>: is not part of an aircraft, as {_REFUSED[tag.lower()]}: take it out"
    near = get_close_matches(tag[:60], rule.children, n=1, cutoff=0.7)
    hint = f"did you mean <{near[0]}>?" if near else f"allowed: {_listed(rule.children)}"
    return f"<{tag[:40]}>: is unknown in <{parent}>; {hint}"


def _check_needs(element: Element, rule: Rule) -> None:
    tags = [child.tag for child in element.children]
    if wrong := [tag for tag in rule.needs if tags.count(tag) != 1]:
        counted = "; ".join(f"needs <{tag}>, once; it has {tags.count(tag)}" for tag in wrong)
        raise MarkupError(f"<{element.tag}>: {counted}", element.line)
    for tag in rule.some:
        if tag not in tags:
            raise MarkupError(f"<{element.tag}>: needs <{tag}>", element.line)
    if rule.operands is not None:
        least, most = rule.operands
        held = sum(tag in OPERANDS for tag in tags)
        if not least <= held <= most:
            wanted = str(least) if least == most else f"from {least} to {most}"
            raise MarkupError(f"<{element.tag}>: has {held} operands; allowed: {wanted}", element.line)


_CLOSER = {"table": check_table, "traverse": check_traverse}
"""What is looked at besides, by tag."""


def _listed(names: Iterable[str]) -> str:
    """Names in a row, cut where it gets long."""
    known = list(names)
    return ", ".join(known[:12]) + (", …" if len(known) > 12 else "") if known else "none"
