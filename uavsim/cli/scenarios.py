"""`uavsim scenarios`: what can be flown."""

import typer

from uavsim.cli.printed import Json, document


def scenarios(*, as_json: Json = False) -> None:
    """List the packaged scenarios, a line each.

    Example: uavsim scenarios
    """
    from uavsim.scenario import packaged
    from uavsim.views import documents

    known = packaged()
    if as_json:
        document(documents.scenarios(known))
        return
    width = max(map(len, known))
    for name, description in known.items():
        typer.echo(f"{name:<{width}}  {description}")
