"""Text of somebody's file as it may be shown: printable, and of bounded length."""

LONGEST_NAME = 60  # characters of a name that are shown


def brief(text: str, most: int = LONGEST_NAME) -> str:
    """Return a text of bounded length, in which nothing but what is printed stands."""
    shown = text[:most] if text.isprintable() else "".join(c if c.isprintable() else "\ufffd" for c in text[:most])
    return shown if len(text) <= most else f"{shown}…"
