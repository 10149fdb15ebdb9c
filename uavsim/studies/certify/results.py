"""Verdicts that are kept beside the docs: small files in JSON, and the tables that the docs show of them."""

import json
from pathlib import Path
from typing import Any


def read(folder: Path, name: str) -> dict[str, Any] | None:
    """Return a verdict that was written, None if there is none."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found
