"""`uavsim plugins`: what is registered, and who it is."""

import typer

from uavsim.cli.common import Plugin, plug_in
from uavsim.cli.printed import Json, document


def plugins(*, plugin: Plugin = None, as_json: Json = False) -> None:
    """List detectors, estimators and plants, and whose they are.

    Ours, those of installed packages (entry points uavsim.detectors, uavsim.estimators, uavsim.plants), which are not
    imported for it, and those that --plugin names.

    Example: uavsim plugins

    Example: uavsim plugins --plugin mine.py
    """
    from uavsim.plugins import REGISTRIES, sources
    from uavsim.views import documents
    from uavsim.views.text import visible

    plug_in(plugin)
    found = {what: list(sources(what)) for what in REGISTRIES}
    if as_json:
        document(documents.plugins(found))
        return
    rows = [
        (what, source.name, source.source, source.version or (source.sha256 and f"SHA-256 {source.sha256[:12]}…") or "")
        for what, of_it in found.items()
        for source in of_it
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for row in rows:
        typer.echo("  ".join((*(f"{visible(v):<{w}}" for v, w in zip(row, widths, strict=False)), row[3])).rstrip())
