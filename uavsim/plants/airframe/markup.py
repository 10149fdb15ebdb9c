"""XML read into a tree that knows its lines, by a parser that opens nothing and expands nothing (defusedxml)."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

LARGEST = 1_000_000  # bytes of one file; JSBSim's largest aircraft has 110 kB
DEEPEST = 40  # elements in each other; JSBSim's deepest aircraft has 14, and its own reader recurses
MOST = 20_000  # elements of a file; JSBSim's largest aircraft has 5000
ENCODINGS = (b"utf-8", b"us-ascii", b"iso-8859-1")  # that the check and JSBSim read alike


class MarkupError(ValueError):
    """Something in a file that cannot be, with its line."""

    def __init__(self, problem: str, line: int) -> None:
        super().__init__(f"line {line}: {problem}")


@dataclass(slots=True, eq=False)
class Element:
    """An element: its tag, attributes, children, text and line."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)
    text: str = ""

    def all(self) -> Iterator["Element"]:
        """Yield this element and all in it."""
        yield self
        for child in self.children:
            yield from child.all()

    def find(self, tag: str) -> "Element | None":
        """Return the first child of this tag."""
        return next((child for child in self.children if child.tag == tag), None)


class _Builder:
    """What the parser tells of a file, as elements."""

    def __init__(self) -> None:
        self.root: Element | None = None
        self.line: Callable[[], int] = lambda: 0
        self._open: list[Element] = []
        self._texts: list[list[str]] = []
        self._count = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if len(self._open) >= DEEPEST:
            raise MarkupError(f"<{tag[:40]}>: more than {DEEPEST} elements in each other", self.line())
        if self._count > MOST:
            raise MarkupError(f"more than {MOST} elements", self.line())
        element = Element(tag, attributes, self.line())
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)
        self._texts.append([])

    def data(self, text: str) -> None:
        self._texts[-1].append(text)

    def end(self, _: str) -> None:
        self._open.pop().text = "".join(self._texts.pop()).strip()

    def close(self) -> Element | None:
        return self.root


def parse(content: bytes) -> Element:
    """Read an XML file.

    Raises
    ------
    ValueError
        One line: what is wrong, with its line where there is one.
    """
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException
    from defusedxml.ElementTree import DefusedXMLParser

    if len(content) > LARGEST:
        raise ValueError(f"is larger than {LARGEST} bytes")
    _check_encoding(content)
    builder = _Builder()
    parser = DefusedXMLParser(target=builder, forbid_dtd=True)
    builder.line = lambda: int(parser.parser.CurrentLineNumber)
    try:
        parser.feed(content)
        parser.close()
    except ParseError as error:
        raise MarkupError(f"not well-formed XML: {error}", error.position[0]) from None
    except DefusedXmlException:
        raise ValueError("declares a document type or entities: write in its place what each stands for") from None
    except (UnicodeError, LookupError) as error:
        raise ValueError(f"cannot be read as XML: {error}") from None
    assert builder.root is not None  # well-formed
    return builder.root


def _check_encoding(content: bytes) -> None:
    """Refuse an encoding that the check and JSBSim could read differently."""
    head = content[:200].removeprefix(b"\xef\xbb\xbf")
    declared = head.partition(b"?>")[0].partition(b"encoding")[2].lstrip(b" \t=") if head.startswith(b"<?xml") else b""
    name = declared.strip(b"\"' \t").split(b'"')[0].split(b"'")[0].lower()
    if b"\0" in content or (name and name not in ENCODINGS):
        raise ValueError("must be text in UTF-8, US-ASCII or ISO-8859-1")


@contextmanager
def in_file(path: str) -> Iterator[None]:
    """Put a file's name before what is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
