"""A preset of one's own as it was read: what is flown is that text, whatever becomes of the file."""

from pathlib import Path


class Sheet(str):
    """The path of a preset's file, with what stood in it.

    It is the path as text wherever one is wanted; what describes the part is the text that it carries.

    Attributes
    ----------
    text
        Of the file.
    """

    text: str

    def __new__(cls, path: str, text: str) -> "Sheet":
        """Carry a text along with its path."""
        self = super().__new__(cls, path)
        self.text = text
        return self

    def __getnewargs__(self) -> tuple[str, str]:  # type: ignore[override]
        """What a copy, also in another process, is made from."""
        return str(self), self.text

    def __deepcopy__(self, memo: object) -> "Sheet":
        return self  # nothing in it changes

    @property
    def path(self) -> Path:
        """Where it was read."""
        return Path(self)
