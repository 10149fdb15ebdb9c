"""An aircraft's files, checked before JSBSim opens them: they are data, and describe an aircraft and nothing else.

JSBSim's language opens files and sockets, stops the simulator, and trusts what it reads: a wrong file ends the
process. So every file is read by a hardened parser and held against a list of what describes an aircraft (`grammar`),
with limits of depth, size and rows; what it names lies in its folder. What JSBSim then opens is what was checked: of an
aircraft of one's own a copy, written from the bytes that were read.
"""

from pathlib import Path

from uavsim.plants.airframe.check import Checked, check_files
from uavsim.plants.airframe.markup import LARGEST

__all__ = ["Airframe", "content_of", "read_airframe"]

_KNOWN: dict[Path, "Airframe"] = {}


class Airframe(str):
    """The path of an aircraft's folder, with its files as they were read and checked.

    It is the path as text wherever one is wanted; what flies are the files that it carries.

    Attributes
    ----------
    checked
        The files, and what they read.
    """

    checked: Checked

    def __new__(cls, folder: str, checked: Checked) -> "Airframe":
        """Carry files along with the path of their folder."""
        self = super().__new__(cls, folder)
        self.checked = checked
        return self

    def __getnewargs__(self) -> tuple[str, Checked]:  # type: ignore[override]
        """What a copy, also in another process, is made from."""
        return str(self), self.checked

    def __deepcopy__(self, memo: object) -> "Airframe":
        return self  # nothing in it changes

    @property
    def name(self) -> str:
        """Of the aircraft."""
        return Path(self).name

    def write(self, folder: Path) -> Path:
        """Write the files into a folder that there is; return that of the aircraft in it."""
        place = folder / self.name
        if not self.name or self.name == "..":
            raise ValueError(f"aircraft.model = {str(self)!r}: is no name of an aircraft")
        for path, content in self.checked.files.items():
            (place / path).parent.mkdir(parents=True, exist_ok=True)
            (place / path).write_bytes(content)
        return place


def read_airframe(folder: Path) -> Airframe:
    """Read and check an aircraft.

    Parameters
    ----------
    folder
        ``…/NAME`` with ``NAME.xml`` in it.

    Raises
    ------
    ValueError
        One line that names file, line, element and what is allowed.
    """
    folder = folder.resolve()
    known = _KNOWN.get(folder)
    if known is None or any(content_of(folder, path) != content for path, content in known.checked.files.items()):
        try:
            known = Airframe(str(folder), check_files(folder.name, lambda path: content_of(folder, path)))
        except ValueError as error:
            raise ValueError(f"{folder}: {error}") from None
        _KNOWN[folder] = known
    return known


def content_of(folder: Path, path: str) -> bytes | None:
    """What stands in a file below a folder; None if there is none.

    Raises
    ------
    ValueError
        It leads out of the folder by a link, or cannot be read.
    """
    file = folder / path
    try:
        if not file.is_file():
            return None
        if not file.resolve().is_relative_to(folder):
            raise ValueError(f"{path}: is a link that leads out of the aircraft's folder")
        if file.stat().st_size > LARGEST:
            raise ValueError(f"{path}: is larger than {LARGEST} bytes")
        return file.read_bytes()
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
