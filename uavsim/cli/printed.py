"""What a command prints: tables for people, or with `--json` one document for programs and nothing beside it.

A document is made by `uavsim.views.documents`; what is only a remark goes to standard error then.
"""

import json
from collections.abc import Mapping
from typing import Annotated, Any

import typer

from uavsim.views.text import visible

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, in SI, in place of tables.")]


def document(values: Mapping[str, Any]) -> None:
    """Print a document; in ASCII, so that it is right whatever the terminal can show."""
    typer.echo(json.dumps(values, indent=2, allow_nan=False))


def remark(text: str, *, as_json: bool) -> None:
    """Print a line that is not part of the document."""
    from uavsim.views import terminal

    if as_json:
        typer.echo(visible(text), err=True)
    else:
        terminal.say(text)
