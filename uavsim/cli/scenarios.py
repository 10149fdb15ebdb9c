"""`uavsim scenarios`: what can be flown."""

import typer


def scenarios() -> None:
    """List the packaged scenarios, a line each.

    Example: uavsim scenarios
    """
    from uavsim.scenario import packaged

    known = packaged()
    width = max(map(len, known))
    for name, description in known.items():
        typer.echo(f"{name:<{width}}  {description}")
