"""Put JSBSim's own c172x on the rail: python docs/examples/own-aircraft/own_aircraft.py FOLDER.

Copies the aircraft with the engine and the systems that it shares into FOLDER/c172x, takes out what is no part of an
aircraft (its outputs and the socket that it listens on), and adds what the launcher needs: the forces by which the rail
holds it, a stabiliser, and a starter. See docs/own-aircraft.md.
"""

import shutil
import sys
from pathlib import Path
from xml.etree import ElementTree

import jsbsim

NAME = "c172x"
HERE = Path(__file__).parent
STOCK = Path(jsbsim.get_default_root_dir())


def put(place: Path) -> Path:
    """Write the aircraft's folder into `place`."""
    folder = place / NAME
    for part in ("engine", "systems"):
        (folder / part).mkdir(parents=True)
    root = ElementTree.parse(STOCK / "aircraft" / NAME / f"{NAME}.xml").getroot()
    for tag in ("output", "input"):
        for element in root.findall(tag):
            root.remove(element)
    for element in list(root.iter()):
        if stem := element.get("file"):
            _copy(f"{stem.removesuffix('.xml')}.xml", folder)
    forces = ElementTree.parse(HERE / "external_reactions.xml").getroot()
    root.insert(list(root).index(root.find("propulsion")), forces)
    for stem in ("starter", "stabiliser"):
        shutil.copy(HERE / f"{stem}.xml", folder / "systems")
        first = list(root).index(root.find("flight_control"))
        root.insert(first, ElementTree.Element("system", file=stem))
    ElementTree.ElementTree(root).write(folder / f"{NAME}.xml", encoding="utf-8", xml_declaration=True)
    shutil.copy(HERE / f"{NAME}.toml", place)
    return folder


def _copy(name: str, folder: Path) -> None:
    """Copy a file that the aircraft names, from its own folder or from those that JSBSim's aircraft share."""
    for found, part in ((STOCK / "aircraft" / NAME, ""), (STOCK / "engine", "engine"), (STOCK / "systems", "systems")):
        if (found / name).is_file():
            tree = ElementTree.parse(found / name)  # what an entity stands for is written in its place
            tree.write(folder / part / name, encoding="utf-8", xml_declaration=True)
            return
    raise SystemExit(f"JSBSim's {NAME} names {name}, which it does not have")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit("usage: own_aircraft.py FOLDER")
    print(put(Path(sys.argv[1])))
