"""`uavsim bench`: what a step in the loop costs."""

from typing import Annotated

import typer

from uavsim.cli.common import Bar, Plugin, plug_in, user_input
from uavsim.cli.printed import Json, document


def bench(
    scenario: Annotated[str, typer.Argument(help="A packaged name or a TOML file.")] = "catapult",
    *,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change one key of the scenario.")
    ] = None,
    plugin: Plugin = None,
    as_json: Json = False,
) -> None:
    """Measure what a step in the loop costs, over bare JSBSim.

    That is over the same JSBSim stepped from Python with the same truth recorded. The last line is `ratio X.XX`. Beside
    it: what detector and airspeed estimator cost by themselves, which is what would run on the aircraft.

    Example: uavsim bench

    Example: uavsim bench catapult --plugin mine.py --set detector.kind=mine
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.bench import measure, measure_onboard
    from uavsim.views import documents, terminal

    plug_in(plugin)
    with user_input(), Bar("measuring") as bar:
        loaded = load_scenario(scenario, overrides=settings or ())
        cost = measure(loaded, progress=bar.show)
        onboard = measure_onboard(loaded)
    if as_json:
        document(documents.cost(cost, onboard))
    else:
        terminal.print_cost(cost, onboard)
