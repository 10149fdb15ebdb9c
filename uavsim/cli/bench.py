"""`uavsim bench`: what a step in the loop costs."""

from typing import Annotated

import typer

from uavsim.cli.common import Bar, user_input


def bench(
    scenario: Annotated[str, typer.Argument(help="A packaged name or a TOML file.")] = "catapult",
) -> None:
    """Measure what a step in the loop costs, over bare JSBSim.

    That is over the same JSBSim stepped from Python with the same truth recorded. The last line is `ratio X.XX`. Beside
    it: what detector and airspeed estimator cost by themselves, which is what would run on the aircraft.

    Example: uavsim bench
    """
    from uavsim.scenario import load_scenario
    from uavsim.studies.cost import measure, measure_onboard
    from uavsim.views import terminal

    with user_input(), Bar("measuring") as bar:
        loaded = load_scenario(scenario)
        cost = measure(loaded, progress=bar.show)
        onboard = measure_onboard(loaded)
    terminal.print_cost(cost, onboard)
