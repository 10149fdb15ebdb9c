"""What a command prints: tables for people, or with `--json` one document for programs and nothing beside it.

A document is made by `uavsim.views.documents`; what is only a remark goes to standard error then.
"""

import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout, suppress
from contextvars import ContextVar
from functools import wraps
from typing import Annotated, Any, ParamSpec, TextIO

import typer

from uavsim.views.text import visible

Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, in SI, in place of tables.")]


P = ParamSpec("P")
_OUTPUT: ContextVar[TextIO | None] = ContextVar("_OUTPUT", default=None)


@contextmanager
def _kept_apart() -> Iterator[TextIO]:
    """Give standard output to nobody else: what others write there, libraries and processes too, goes to the other."""
    own = sys.stdout
    try:
        own.flush()
        kept = os.dup(own.fileno())
        os.dup2(sys.stderr.fileno(), own.fileno())
    except (OSError, ValueError, AttributeError):  # it is no file, as in a notebook
        with redirect_stdout(sys.stderr):
            yield own
        return
    number = own.fileno()
    with open(kept, "w", encoding="utf-8", closefd=False) as output:
        try:
            with redirect_stdout(sys.stderr):
                yield output
        finally:
            with suppress(OSError):  # its reader may have left
                output.flush()
            own.flush()
            os.dup2(kept, number)
            os.close(kept)


def alone(command: Callable[P, None]) -> Callable[P, None]:
    """Keep what a plug-in prints out of the document: with `--json` it goes to standard error."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        if not kwargs.get("as_json"):
            return command(*args, **kwargs)
        with _kept_apart() as output:
            before = _OUTPUT.set(output)
            try:
                return command(*args, **kwargs)
            finally:
                _OUTPUT.reset(before)

    return run


def document(values: Mapping[str, Any]) -> None:
    """Print a document; in ASCII, so that it is right whatever the terminal can show."""
    typer.echo(json.dumps(values, indent=2, allow_nan=False), file=_OUTPUT.get())


def remark(text: str, *, as_json: bool) -> None:
    """Print a line that is not part of the document."""
    from uavsim.views import terminal

    if as_json:
        typer.echo(visible(text), err=True)
    else:
        terminal.say(text)
