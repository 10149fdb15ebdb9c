"""Functions that need themselves: JSBSim works a function out whenever it is read, until its stack is full."""

from uavsim.plants.airframe.markup import Element, MarkupError
from uavsim.plants.airframe.properties import plain

READING = frozenset({"property", "p", "independentVar"})


def called(root: Element) -> dict[str, set[str]]:
    """Return what each function and each named table of a file reads, by the names of their properties."""
    found: dict[str, set[str]] = {}
    for element in root.all():
        name = plain(element.attributes.get("name", ""))
        if name and element.tag in {"function", "table"}:
            parts = list(element.all())[1:]
            reads = {plain(part.text) for part in parts if part.tag in READING}
            reads |= {plain(part.attributes.get("name", "")) for part in parts if part.tag == "table"} - {""}
            if name in found:
                raise MarkupError(f"<{element.tag}>: the name {name[:80]!r} is given twice", element.line)
            found[name] = reads
    return found


def circle(calls: dict[str, set[str]]) -> str:
    """Return the name of a function that is worked out from itself, over whatever others; empty without one."""
    done: set[str] = set()
    for start in sorted(calls):
        path, waiting = [start], [sorted(calls[start] & calls.keys())]
        while path:
            if not waiting[-1]:
                done.add(path.pop())
                waiting.pop()
                continue
            following = waiting[-1].pop()
            if following in path:
                return following
            if following not in done:
                path.append(following)
                waiting.append(sorted(calls[following] & calls.keys()))
    return ""
