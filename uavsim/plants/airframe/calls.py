"""Functions that call each other: JSBSim works a function out each time it is read, and all that it reads with it.

One that needs itself, over whatever others, or over too many, fills JSBSim's stack. One that reads another twice, which
reads a third twice, takes 2ⁿ evaluations over n of them. So a function's depth and work are counted over all it reads:

    depth = 1 + max depth of what it reads,  work = its elements + Σ work of what it reads
"""

from uavsim.plants.airframe.markup import Element, MarkupError
from uavsim.plants.airframe.properties import plain

DEEPEST = 100  # functions; those of JSBSim's aircraft reach 5
MOST_WORK = 100_000  # elements a reading; JSBSim's largest aircraft has 5000 in all. A step of so many takes some 2 ms
_READING = frozenset({"property", "p", "independentVar"})


class Calls:
    """What the functions and named tables of an aircraft read."""

    def __init__(self) -> None:
        self._reads: dict[str, list[str]] = {}
        self._elements: dict[str, int] = {}

    def add(self, root: Element) -> None:
        """Add those of a file.

        Raises
        ------
        MarkupError
            A name is given twice: JSBSim ends the process.
        """
        for element in root.all():
            name = plain(element.attributes.get("name", ""))
            if not name or element.tag not in {"function", "table"}:
                continue
            if name in self._reads:
                raise MarkupError(f"<{element.tag}>: the name {name[:80]!r} is given to two of them", element.line)
            parts = list(element.all())
            self._reads[name] = [plain(part.text) for part in parts if part.tag in _READING]
            self._elements[name] = len(parts)

    @property
    def names(self) -> frozenset[str]:
        """Names of all of them."""
        return frozenset(self._reads)

    def check(self) -> None:
        """Refuse functions that need themselves, too many others, or too much work; ValueError names one."""
        known: dict[str, tuple[int, int]] = {}
        for start in self._reads:
            path = [start]
            while path:
                name = path[-1]
                reads = [read for read in self._reads[name] if read in self._reads]
                waiting = [read for read in reads if read not in known]
                if waiting:
                    if waiting[0] in path:
                        raise ValueError(f"the function {waiting[0][:80]!r} is worked out from itself")
                    path.append(waiting[0])
                    continue
                depth = 1 + max((known[read][0] for read in reads), default=0)
                work = self._elements[name] + sum(known[read][1] for read in reads)
                if depth > DEEPEST or work > MOST_WORK or len(path) > DEEPEST:
                    raise ValueError(
                        f"the function {name[:80]!r} needs {depth} functions in each other and {work:.3g} elements; "
                        f"up to {DEEPEST} and {MOST_WORK} are allowed"
                    )
                known[path.pop()] = depth, work
