"""Whether an aircraft's files describe an aircraft and nothing else, before JSBSim opens them.

A file is reached only by being named, lies in the aircraft's folder, and is read against the grammar (`document`); then
what a grammar cannot say: tables, masses and sizes, functions that would call themselves.
"""

from collections.abc import Callable
from dataclasses import dataclass

from uavsim.plants.airframe import figures
from uavsim.plants.airframe.calls import Calls
from uavsim.plants.airframe.document import check_document
from uavsim.plants.airframe.engines import check_engine, check_feeds
from uavsim.plants.airframe.grammar import ENGINES, THRUSTERS
from uavsim.plants.airframe.markup import Element, in_file, parse
from uavsim.plants.airframe.properties import plain
from uavsim.plants.airframe.tables import number

MOST_FILES = 100
MOST_DELAY = 100.0  # s of all components: JSBSim keeps a value a step of each
MOST_ELEMENTS = 40_000  # of all files: what a step costs grows with them

Reader = Callable[[str], bytes | None]
"""Returns what stands in a file, by its path below the aircraft's folder with slashes; None if there is none."""

_EARLY = frozenset(f"{end}_{what}" for end in ("source", "target") for what in ("angle", "latitude", "longitude"))
"""What an angle or a waypoint reads: JSBSim takes it for there, and ends the process in the air if it is not."""
_SYSTEMS = frozenset({"system", "autopilot", "flight_control"})
_PLACES = {
    **dict.fromkeys(_SYSTEMS, ("", "Systems/", "systems/")),
    **dict.fromkeys(("engine", "thruster"), ("", "Engines/", "engine/")),
}
"""Where JSBSim looks for what an element names, in its order."""
_ROOTS = dict.fromkeys(_SYSTEMS, _SYSTEMS) | {"engine": frozenset(ENGINES), "thruster": frozenset(THRUSTERS)}
"""What the file that an element names must hold."""


@dataclass(frozen=True, slots=True)
class Checked:
    """Files that were checked.

    Attributes
    ----------
    files
        Those that belong to the aircraft, by their path below the folder, as they were read.
    reads
        The properties that they read, each with a file and line.
    early
        Those of them that JSBSim wants to be there while it reads the files, in whatever order.
    functions
        The properties that are worked out by functions and tables of the aircraft.
    """

    files: dict[str, bytes]
    reads: dict[str, str]
    early: frozenset[str]
    functions: frozenset[str]


def check_files(name: str, read: Reader) -> Checked:
    """Check an aircraft.

    Parameters
    ----------
    name
        Of the aircraft: its main file is ``NAME.xml``.
    read
        Reads a file of its folder.

    Raises
    ------
    ValueError
        One line that names file, line, element and what is allowed.
    """
    files: dict[str, bytes] = {}
    tags: dict[str, str] = {}
    reads: dict[str, str] = {}
    early: set[str] = set()
    calls = Calls()
    waiting = [(f"{name}.xml", frozenset({"fdm_config"}))]
    elements, delays = 0, 0.0
    while waiting:
        path, roots = waiting.pop()
        if path in tags:
            _check_root(path, tags[path], roots)  # named twice, perhaps for another part
            continue
        content = read(path)
        if content is None:
            raise ValueError(f"{path}: there is no such file")
        with in_file(path):
            root, read_here = _checked(content, roots, is_named=bool(files))
            files[path], tags[path] = content, root.tag
            reads = {property_: f"{path}: line {line}" for property_, line in read_here.items()} | reads
            elements += sum(1 for _ in root.all())
            if len(files) > MOST_FILES or elements > MOST_ELEMENTS:
                raise ValueError(f"more than {MOST_FILES} files or {MOST_ELEMENTS} elements in all")
            early |= {plain(element.text) for element in root.all() if element.tag in _EARLY}
            calls.add(root)
            delays += sum(_delay(element) for element in root.all() if element.tag == "delay")
            if delays > MOST_DELAY:
                raise ValueError(f"delays of {delays:.4g} s in all; up to {MOST_DELAY:g} are allowed")
            waiting += _named(root, read)
    with in_file(f"{name}.xml"):
        calls.check()
    return Checked(files, reads, frozenset(early), calls.names)


def _checked(content: bytes, roots: frozenset[str], *, is_named: bool) -> tuple[Element, dict[str, int]]:
    root = parse(content)
    _check_root(f"line {root.line}", root.tag, roots)
    reads = check_document(root, is_named=is_named)
    check_engine(root)
    if root.tag == "fdm_config":
        if (propulsion := root.find("propulsion")) is not None:
            check_feeds(propulsion)
        figures.check_places(root)
        figures.check_body(_only(root, "metrics"), _only(root, "mass_balance"))
    return root, reads


def _check_root(where: str, tag: str, roots: frozenset[str]) -> None:
    """Refuse a file that holds something else than the part that it is named for."""
    if tag not in roots:
        raise ValueError(f"{where}: <{tag[:40]}>: must be <{'> or <'.join(sorted(roots))}>")


def _delay(element: Element) -> float:
    """Delay of a component, s; a frame is a step of 1 ms."""
    value = number(element.text)
    assert value is not None  # the grammar has seen to it
    return value if element.attributes.get("type") == "time" else 1e-3 * value


def _only(root: Element, tag: str) -> Element:
    found = root.find(tag)
    assert found is not None  # the grammar needs it
    return found


def _names(element: Element) -> bool:
    return "file" in element.attributes


def _named(root: Element, read: Reader) -> list[tuple[str, frozenset[str]]]:
    """The files that a file names, and what each must hold; those that are not there are named in one line."""
    found, missing = [], []
    for element in filter(_names, root.all()):
        stem = element.attributes["file"].strip()
        stem = stem if stem.endswith(".xml") else f"{stem}.xml"
        place = next((place for place in _PLACES[element.tag] if read(place + stem) is not None), None)
        if place is not None:
            found.append((place + stem, _ROOTS[element.tag]))
            continue
        searched = " or ".join(place for place in _PLACES[element.tag] if place)
        missing.append(
            f"line {element.line}: <{element.tag}>: the file {stem[:80]!r} is not in the aircraft's folder: copy it "
            f"into {searched} there"
        )
    if missing:
        raise ValueError("; ".join(missing))
    return found
