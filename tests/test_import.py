"""What an import costs: each name loads what it needs and no more. Looked up in the modules of a fresh interpreter."""

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {"jsbsim", "pandas", "scipy", "matplotlib", "pyarrow", "filterpy", "pydantic", "rich", "typer", "numba"}


def loaded(statement: str) -> set[str]:
    """Names of the top-level modules that a statement has loaded."""
    code = f"{statement}\nimport sys\nprint(*{{name.partition('.')[0] for name in sys.modules}})"
    return set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import uavsim", HEAVY | {"numpy", "sensors"}),
        ("import uavsim; dir(uavsim); uavsim.__version__", HEAVY | {"numpy", "sensors"}),
        ("from uavsim.onboard import launch; launch.default().step(0.0, 1.0, 0.0, 0.0)", HEAVY | {"sensors"}),
        ("import uavsim.onboard.airspeed, uavsim.onboard.flight_computer", HEAVY | {"sensors"}),
        ("from uavsim import airdata; airdata.mach(total=101325.0, static=1e5)", HEAVY | {"sensors"}),
        ("import sensors; sensors.presets(); sensors.preset('adxl345')", HEAVY | {"uavsim"}),
        ("from uavsim import Scenario", HEAVY - {"pydantic"}),
        ("import uavsim; uavsim.load", HEAVY - {"pydantic"}),
        ("import uavsim.score, uavsim.flight", HEAVY | {"sensors"}),
        ("import uavsim.cosim", HEAVY - {"pydantic"}),
        ("import uavsim.cli", HEAVY - {"typer", "rich"}),
        ("from uavsim.scenario import packaged; packaged()", HEAVY - {"pydantic"}),
    ],
)
def test_an_import_loads_no_more_than_it_needs(statement: str, absent: set[str]) -> None:
    assert loaded(statement) & absent == set()


def test_the_names_of_the_package_are_there_when_they_are_used() -> None:
    names = "Flight, Scenario, airdata, fly, load"
    assert loaded(f"from uavsim import {names}") >= {"uavsim", "sensors", "numpy"}
    assert loaded("import uavsim; assert set(dir(uavsim)) == set(uavsim.__all__)") >= {"uavsim"}


def test_an_unknown_name_is_an_attribute_error() -> None:
    import uavsim

    with pytest.raises(AttributeError, match="no attribute 'flies'"):
        _ = uavsim.flies


def test_onboard_loads_nothing_of_the_truth() -> None:
    """What an import contract says of the source holds when it runs: replaying needs no JSBSim."""
    statement = "import uavsim.onboard.launch, uavsim.onboard.airspeed, uavsim.onboard.flight_computer, sys"
    code = f"{statement}\nprint(*[name for name in sys.modules if name.startswith('uavsim')])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    inside = ("uavsim.onboard.launch.", "uavsim.onboard.airspeed.", "uavsim.airdata.")
    modules = {name for name in run.stdout.split() if not name.startswith(inside)}
    assert modules == {
        "uavsim", "uavsim.airdata", "uavsim.onboard", "uavsim.onboard.launch", "uavsim.onboard.airspeed",
        "uavsim.onboard.flight_computer", "uavsim.onboard.interface", "uavsim.onboard.plausible",
        "uavsim.onboard.stamps", "uavsim.onboard.rail_offset", "uavsim.onboard.stroke", "uavsim.onboard.readiness",
        "uavsim.onboard.repeats", "uavsim.onboard.life", "uavsim.failure", "uavsim.registry", "uavsim.compiled",
    }  # fmt: skip


def test_a_replay_needs_no_jsbsim(tmp_path: Path) -> None:
    import uavsim

    folder = tmp_path / "flight"
    uavsim.fly("catapult", overrides=["duration=5"]).save(folder)
    code = (
        "import sys; sys.modules['jsbsim'] = None; import uavsim; from uavsim.cosim import replay; "
        f"print(replay(uavsim.load({str(folder)!r})).events[1]['event'])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["launch_detected"]
