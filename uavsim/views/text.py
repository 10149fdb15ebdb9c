r"""Text of a user's or a file's, made fit to be shown: nothing in it is obeyed, everything is seen.

A name may hold escape codes, a bell, carriage returns, or characters that turn the direction of writing or are not seen
at all. Where text is shown each of them stands as Python writes it, `\x1b`; all other text is as it was.
"""

import re
from html import escape

LONGEST = 500  # characters of a message; six lines of a terminal

# Beside what Unicode calls not printable (controls, formats, separators, what is unassigned or private): marks and
# letters without ink (Default_Ignorable_Code_Point of the Unicode Character Database), and the empty Braille cell.
_BLANK = "\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef"
_INVISIBLE = re.compile(f"[{_BLANK}]")


def visible(text: str, keep: str = "") -> str:
    r"""Return the text with every character that is not seen as itself, but those to keep, as an escape.

    Examples
    --------
    >>> visible("bell\x07, red\x1b[31m, café")
    'bell\\x07, red\\x1b[31m, café'
    """
    if text.isprintable() and not _INVISIBLE.search(text):
        return text
    return "".join(letter if _is_seen(letter) or letter in keep else ascii(letter)[1:-1] for letter in text)


def message(text: str, longest: int = LONGEST) -> str:
    """Return the text as one line, cut where it is longer."""
    return cut(visible(" ".join(text.split())), longest)


def cut(text: str, longest: int) -> str:
    """Return the text, without its middle if it is longer; how much was left out is said there."""
    if len(text) <= longest:
        return text
    head = 2 * longest // 3
    return f"{text[:head]} … ({len(text) - longest} characters left out) … {text[head - longest :]}"


def in_html(text: str) -> str:
    """Return the text for a page: nothing in it is HTML, everything is seen."""
    return escape(visible(text, keep="\n"))


def _is_seen(letter: str) -> bool:
    return letter.isprintable() and not _INVISIBLE.match(letter)
