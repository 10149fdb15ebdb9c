"""The wheel, installed where nothing of the checkout can be seen, finds its data and flies.

Offline: no build isolation and no index; what the package depends on is this environment's own.
"""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import uavsim
from sensors import presets
from uavsim.flight import UNITS
from uavsim.plants.hangar import aircraft
from uavsim.scenario import packaged

ROOT = Path(__file__).resolve().parent.parent
HOMES = {"uavsim": "uavsim", "sensors": "sensors", "aircraft": "uavsim/aircraft"}
"""Folders of the checkout, and where the wheel has them."""

BLIND = f"""
import sys
sys.path = [entry for entry in sys.path if entry and {str(ROOT)!r} not in (entry, entry.rstrip("/"))]
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel of the checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    command = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run([sys.executable, *command], check=True, capture_output=True)
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module")
def target(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the wheel, and only it, into an empty folder."""
    folder = tmp_path_factory.mktemp("installed")
    offline = ["--no-deps", "--no-index", "--no-compile", "--disable-pip-version-check", "--quiet"]
    command = ["-m", "pip", "install", *offline, "--target", str(folder), str(wheel)]
    subprocess.run([sys.executable, *command], check=True, capture_output=True)
    return folder


def run(target: Path, cwd: Path, code: str, *arguments: str) -> str:
    """What a Python that sees the installed package and not the checkout prints."""
    environment = {**os.environ, "PYTHONPATH": str(target)}
    command = [sys.executable, "-P", "-c", BLIND + code, *arguments]
    return subprocess.run(command, cwd=cwd, env=environment, check=True, capture_output=True, text=True).stdout


def test_the_wheel_has_everything_that_is_data_or_code(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = {name: archive.read(name) for name in archive.namelist()}
    kinds = {".py", ".toml", ".xml"}
    files = [(home, f) for home in HOMES for f in (ROOT / home).rglob("*") if f.suffix in kinds and f.is_file()]
    assert len({f.suffix for _, f in files}) == len(kinds)
    for home, file in files:
        name = f"{HOMES[home]}/{file.relative_to(ROOT / home).as_posix()}"
        assert held[name] == file.read_bytes()


def test_the_wheel_has_nothing_else(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        own = f"uavsim-{uavsim.__version__}.dist-info"
        assert {name.split("/")[0] for name in names} == {"uavsim", "sensors", own}
        own_checks = "uavsim/testing/"  # for parts of somebody else's
        ours = [name for name in names if not name.startswith(own_checks)]
        assert not [name for name in ours if "test" in name or "__pycache__" in name or name.startswith("/")]
        if len(ROOT.parts) > 2:
            assert not [name for name in names if str(ROOT).encode() in archive.read(name)]
        assert f"Name: uavsim\nVersion: {uavsim.__version__}\n" in archive.read(f"{own}/METADATA").decode()
        assert "[console_scripts]\nuavsim = uavsim.cli:main\n" in archive.read(f"{own}/entry_points.txt").decode()


def test_installed_it_finds_its_data_as_files_of_its_own(target: Path, tmp_path: Path) -> None:
    code = (
        "import uavsim\n"
        "from sensors import preset, presets\n"
        "from sensors.catalogue import FOLDER\n"
        "from uavsim.plants.hangar import aircraft, find_aircraft, hangar\n"
        "from uavsim.scenario import PACKAGED, load_scenario, packaged\n"
        "print(uavsim.__file__, FOLDER, hangar(), PACKAGED, *map(find_aircraft, aircraft()))\n"
        "print(*presets())\n"
        "print(*packaged())\n"
        "print(*aircraft())\n"
        "print(*(preset(name).name for name in presets()))\n"
        "print(*(load_scenario(name).name for name in packaged()))\n"
    )
    places, *listed = run(target, tmp_path, code).splitlines()
    for place in places.split():
        assert Path(place).is_relative_to(target)
        assert Path(place).exists()
    names = [presets(), list(packaged()), aircraft()]
    assert [line.split() for line in listed] == [*names, presets(), list(packaged())]


def test_installed_it_flies_from_anywhere(target: Path, tmp_path: Path) -> None:
    code = (
        "import atexit, os\n"
        "from uavsim.cli import main\n"
        "def tell():\n"
        "    ours = [m for n, m in sys.modules.items() if n.split('.')[0] in ('uavsim', 'sensors')]\n"
        "    print(*{os.path.dirname(m.__file__) for m in ours}, sep='\\n')\n"
        "atexit.register(tell)\n"
        "main()\n"
    )
    changes = ("duration=9", "requirements=[]", "expect=timeout")
    sets = [part for change in changes for part in ("--set", change)]
    out = run(target, tmp_path, code, "fly", "catapult", *sets, "--no-plots", "--out", "here")
    printed, _, homes = out.partition("written to here\n")
    assert "catapult, seed 1: timeout (as expected)" in printed
    assert {file.name for file in (tmp_path / "here").iterdir()} == {
        *("scenario.toml", "score.json", "events.json"),
        *(f"{name}.parquet" for name in UNITS),
    }
    assert len(homes.splitlines()) > 4
    for home in homes.splitlines():
        assert Path(home).is_relative_to(target)
    assert [entry.name for entry in tmp_path.iterdir()] == ["here"]


def test_the_flight_of_the_wheel_is_that_of_the_checkout(target: Path, tmp_path: Path) -> None:
    """Byte for byte: nothing depends on where the package lies."""
    code = "import uavsim\nuavsim.fly('catapult', seed=2, overrides=['duration=6']).save(sys.argv[1])\n"
    run(target, tmp_path, code, "there")
    here = uavsim.fly("catapult", seed=2, overrides=["duration=6"]).save(tmp_path / "here")
    for file in here.iterdir():
        assert (tmp_path / "there" / file.name).read_bytes() == file.read_bytes()
