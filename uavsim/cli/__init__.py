"""The command line: parses, calls, prints. No physics. A module a command; `common` is what they share."""

import io
import sys
from contextlib import suppress
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from uavsim.cli.bench import bench
from uavsim.cli.campaign import campaign
from uavsim.cli.common import DONE, INTERRUPTED, WRONG_INPUT, Interrupted, WrongInputError, told
from uavsim.cli.fly import fly
from uavsim.cli.linearise import linearise
from uavsim.cli.paper import paper
from uavsim.cli.plugins import plugins
from uavsim.cli.printed import alone
from uavsim.cli.rare import rare
from uavsim.cli.replay import replay
from uavsim.cli.roc import roc
from uavsim.cli.scenarios import scenarios
from uavsim.cli.sensitivity import sensitivity
from uavsim.cli.sensors import sensors
from uavsim.cli.survey import survey
from uavsim.cli.sweep import sweep
from uavsim.cli.tune import tune
from uavsim.cli.verify import verify
from uavsim.failure import PartError
from uavsim.interrupts import like_ctrl_c
from uavsim.views.text import message

COMMANDS = (
    *(scenarios, fly, campaign, sweep, sensitivity, verify, rare, replay, sensors),
    *(roc, tune, survey, linearise, paper, plugins, bench),
)
"""In the order of the help."""


class _Commands(TyperGroup):
    """Commands whose interrupts come to `main`; click would end the program by itself, each version in its way."""

    def invoke(self, context: Any) -> Any:
        """Run the command that was asked for."""
        try:
            return super().invoke(context)
        except KeyboardInterrupt:
            raise Interrupted from None


app = typer.Typer(cls=_Commands, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
for _command in COMMANDS:
    app.command()(alone(_command))

# click's ClickException, wherever this typer keeps its click
_UsageError: type[Exception] = typer.BadParameter.__mro__[2]


@app.callback(invoke_without_command=True)
def uavsim(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False
) -> None:
    """Fly a folding-wing UAV from catapult to cruise in JSBSim.

    Launch detector and airspeed estimator are in the loop, everything is scored against the truth.

    \b
    Examples:
      uavsim scenarios
      uavsim fly catapult --seed 7
      uavsim fly gusty --seeds 1-50 --out output/gusty-50
      uavsim campaign dispersed --runs 1000 --out output/dispersed
      uavsim sweep catapult --vary air_data.total.noise_scale=0.5,1,2,4 --runs 50
      uavsim sensitivity dispersed --runs 1000
      uavsim verify dispersed --requirements small-uav
      uavsim rare catapult --event false_launch
      uavsim replay output/catapult-7
      uavsim replay imu.csv --map t=time,fx=ax,fy=ay,fz=az
      uavsim sensors bmp390
      uavsim roc --detectors adaptive-cusum,multi-level-window,px4
      uavsim tune catapult --false-alarms 0.1
      uavsim survey fw8
      uavsim linearise fw8
      uavsim paper
      uavsim plugins
      uavsim bench
    """  # noqa: D301 (click reads \b: keep these lines)
    if version:
        from uavsim import __version__

        typer.echo(f"uavsim {__version__}")
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main() -> None:
    """Run the command line; every error of the user's is one line on standard error and status 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without Greek is no reason to fail
    with like_ctrl_c():
        status = _run()
    sys.exit(status)


def _run() -> int:
    """Return the exit status."""
    try:
        status = app(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
    except (Interrupted, KeyboardInterrupt, typer.Abort) as interrupted:
        _say(": ".join(("interrupted", *map(str, interrupted.args))))
        return INTERRUPTED
    except _UsageError as error:
        return _complain(error.format_message())  # type: ignore[attr-defined]  # the class is known at run time only
    except (BrokenPipeError, SystemExit):  # the reader of our output left; click ends the program at that
        from uavsim.views.terminal import mute

        mute()
        return DONE
    except OSError as error:
        return _complain(told(error))
    except (WrongInputError, PartError) as error:
        return _complain(str(error))
    if status == INTERRUPTED:  # click's, before a command began
        _say("interrupted")
    return status if isinstance(status, int) else DONE


def _complain(problem: str) -> int:
    _say(message(f"Error: {problem}"))
    return WRONG_INPUT


def _say(line: str) -> None:
    with suppress(OSError):  # there may be nobody any more
        typer.echo(line, err=True)
