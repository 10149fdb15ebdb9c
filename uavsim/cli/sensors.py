"""`uavsim sensors`: the presets, and one of them on a bench."""

from pathlib import Path
from typing import Annotated

import typer

from uavsim.cli.common import LARGEST_SEED, Bar, NoPlots, Out, Overwrite, finite, folder, user_input
from uavsim.cli.printed import Json, document


def sensors(
    name: Annotated[
        str | None, typer.Argument(help="A preset or your own TOML file; without it all are listed.")
    ] = None,
    *,
    hours: Annotated[float, typer.Option(callback=finite, help="Length of the simulated record, h.")] = 3.0,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Draws the unit and its noise.")] = 1,
    unit: Annotated[str, typer.Option(help="Which unit: random, typical or ideal.")] = "random",
    range_g: Annotated[
        float | None, typer.Option("--range-g", callback=finite, help="An accelerometer's range, g.")
    ] = None,
    rate: Annotated[float | None, typer.Option(callback=finite, help="An accelerometer's output rate, Hz.")] = None,
    low_pass: Annotated[str | None, typer.Option("--filter", help="An accelerometer's low-pass.")] = None,
    mode: Annotated[str | None, typer.Option(help="A pressure sensor's oversampling.")] = None,
    iir: Annotated[
        int | None, typer.Option(min=0, max=1_000_000, help="A pressure sensor's filter coefficient.")
    ] = None,
    noise_scale: Annotated[float, typer.Option(callback=finite, help="Factor on the white noise.")] = 1.0,
    compare: Annotated[Path | None, typer.Option(help="Your bench log, CSV, SI: t and fx,fy,fz or pressure.")] = None,
    mapping: Annotated[
        str | None, typer.Option("--map", metavar="OURS=THEIRS,...", help="Your columns, as t=time,fx=ax*9.80665.")
    ] = None,
    budget: Annotated[
        bool, typer.Option("--budget", help="Error budget of the airspeed of a pair or a differential part.")
    ] = False,
    override: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Of the budget: a scenario's key.")
    ] = None,
    out: Out = None,
    overwrite: Overwrite = False,
    no_plots: NoPlots = False,
    as_json: Json = False,
) -> None:
    """List the sensor presets, or put one on a bench.

    Prints a part with its sources, simulates hours of it at rest, and draws Allan deviation, density and histogram over
    what the datasheet promises, with your own bench log beside it.

    Example: uavsim sensors bmp390

    Example: uavsim sensors adxl345 --hours 1 --compare log.csv --map t=time,fx=ax,fy=ay,fz=az

    Example: uavsim sensors bmp280 --budget --set air_data.tare=open
    """
    if budget:
        bench = {"--compare": compare, "--map": mapping, "--rate": rate, "--range-g": range_g, "--filter": low_pass}
        for option, value in bench.items():
            if value is not None:
                raise typer.BadParameter("is for the bench, which --budget is in place of", param_hint=option)
        settings = {"preset": name, "mode": mode, "iir": iir, "noise_scale": noise_scale}
        _budget(settings, override or [], out, overwrite=overwrite, plots=not no_plots, as_json=as_json)
        return
    if override:
        raise typer.BadParameter("sets keys of the budget: give --budget, too", param_hint="--set")
    from uavsim.views import datasheets, documents, terminal

    if name is None:
        if compare is not None:
            raise typer.BadParameter(
                "name the part to compare with, as in uavsim sensors bmp390", param_hint="--compare"
            )
        if as_json:
            document(documents.presets())
        else:
            datasheets.print_presets()
        return
    from sensors.bench import UNITS, on_bench
    from sensors.choice import choose
    from uavsim.studies.sensor_bench import check_hours, put_on_bench, read_log
    from uavsim.views.characterisation import save_bench

    if mapping is not None and compare is None:
        raise typer.BadParameter("names columns of a log: give --compare, too", param_hint="--map")
    with user_input():
        part = on_bench(name, range_g=range_g, rate=rate, filter=low_pass, mode=mode, iir=iir, noise_scale=noise_scale)
        which = UNITS[UNITS.index(choose("--unit", unit, UNITS))]
    with user_input("--hours: "):
        check_hours(part, hours)
    with user_input("--compare: "):
        log = None if compare is None else read_log(compare, part, mapping)

    with folder(out, f"sensors-{part.name}", overwrite=overwrite) as place:  # before anything is simulated in vain
        if not as_json:
            datasheets.print_preset(name)
        with Bar(f"simulating {hours:g} h") as bar:
            measured = put_on_bench(part, hours=hours, seed=seed, unit=which, log=log, progress=bar.show)
        save_bench(measured, place.folder, plots=not no_plots)
    if as_json:
        document(documents.part(name, measured, place.target))
        return
    datasheets.print_bench(measured)
    terminal.say(f"written to {place.target}")


def _budget(
    settings: dict[str, str | float | None],
    override: list[str],
    out: Path | None,
    *,
    overwrite: bool,
    plots: bool,
    as_json: bool,
) -> None:
    """Print the error budget of a pair, by default the one of the packaged scenarios; write it where that is asked.

    Of a differential part it is that of a head with it.
    """
    from sensors import DifferentialDescription
    from sensors.catalogue import preset, pressure_sensor
    from uavsim.scenario import load_scenario
    from uavsim.studies.error_budget import of_scenario
    from uavsim.views import documents, error_budget, terminal

    given = {key: value for key, value in settings.items() if value is not None}
    keys = [f"air_data.{port}.{key}={value}" for port in ("total", "static") for key, value in given.items()]
    if settings["preset"] is not None:
        with user_input():
            name = str(settings["preset"])
            if isinstance(preset(name), DifferentialDescription):
                keys = ["air_data.kind=differential"]
                keys += [f"air_data.differential.{key}={value}" for key, value in given.items()]
            else:
                pressure_sensor(name)
    with user_input():
        found = of_scenario(load_scenario("catapult", overrides=[*keys, *override]))
    if as_json:
        document(documents.plain(found.numbers()))
    else:
        error_budget.print_budget(found)
    if out is None:
        return
    with folder(out, "sensors-budget", overwrite=overwrite) as place:
        error_budget.save_budget(found, place.folder, plots=plots)
    if not as_json:
        terminal.say(f"written to {place.target}")
