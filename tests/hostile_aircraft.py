"""Aircraft that a stranger might hand over: attacks by hand, and mutants of good ones."""

import copy
import os
import random
import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import jsbsim

from uavsim.plants.airframe.grammar import RULES
from uavsim.plants.hangar import hangar

Files = dict[str, bytes]
STOCK = Path(jsbsim.get_default_root_dir())
ANY_TAG = sorted({tag for rule in RULES.values() for tag in rule.children})
TEXTS = [
    *("", "0", "-1", "1e30", "-1e30", "nan", "inf", "1e-30", "1e400", "abc", "0 0", "1 2 3", "99999999999", "0.5", "3"),
    *("simulation/reset", "fcs/elevator-cmd-norm", "aero/CL", "-aero/alpha-rad", "simulation/dt", "no/such", "x" * 300),
    *("velocities/vtrue-fps", "aero/qbar-psf", "propulsion/engine[0]/thrust-lbs", "-1e9", "1e-300", "ap/mine"),
]
ATTRIBUTES = [
    "M",
    "KG",
    "row",
    "column",
    "table",
    "BODY",
    "internal",
    "../x",
    "/etc/passwd",
    "aero/qbar-psf",
    "../../y",
]


_PUSHBACK = ("position-norm", "target-speed-fps", "kp", "ki", "kd", "enabled")
OF_FLIGHTGEAR = tuple(f"sim/model/pushback/{name}" for name in _PUSHBACK)
"""Properties that another program gives to some of JSBSim's aircraft."""


def packaged() -> Files:
    """Files of fw8."""
    return below(hangar() / "fw8")


def below(folder: Path) -> Files:
    """XML files below a folder."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*.xml")}


def complete(name: str, *, mended: bool = True) -> Files:
    """Files of one of JSBSim's own aircraft with the engines and systems that it shares, mended as the check asks."""
    files = below(STOCK / "aircraft" / name)
    for kind in ("engine", "systems"):
        for file in (STOCK / kind).glob("*.xml"):
            files.setdefault(f"{kind}/{file.name}", file.read_bytes())
    if not mended:
        return files
    files = {path: _mended(content) for path, content in files.items()}
    declared = "".join(f'<property value="0">{missing}</property>' for missing in OF_FLIGHTGEAR)
    main = files[f"{name}.xml"].replace(b"</fdm_config>", f"<system>{declared}</system></fdm_config>".encode())
    return files | {f"{name}.xml": main}


def _mended(content: bytes) -> bytes:
    """Without outputs and inputs of the simulator, and with what entities stand for in their place."""
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError:
        return content
    for tag in ("output", "input"):
        for element in root.findall(tag):
            if root.tag == "fdm_config":
                root.remove(element)
    return ElementTree.tostring(root)


def mutate(files: Files, seed: int) -> Files:
    """Change one of the files in one or two places; a seed in twenty changes bytes."""
    rng = random.Random(seed)
    files = dict(files)
    path = rng.choice(sorted(files))
    if rng.random() < 0.05:
        content = bytearray(files[path])
        for _ in range(rng.randint(1, 4)):
            content[rng.randrange(len(content))] = rng.randrange(256)
        files[path] = bytes(content)
        return files
    root = ElementTree.fromstring(files[path])
    for _ in range(rng.randint(1, 2)):
        rng.choice(CHANGES)(root, rng)
    files[path] = ElementTree.tostring(root)
    return files


def _text(root: ElementTree.Element, rng: random.Random) -> None:
    rng.choice(list(root.iter())).text = rng.choice(TEXTS)


def _number(root: ElementTree.Element, rng: random.Random) -> None:
    numbers = [e for e in root.iter() if e.text and e.text.strip().replace(".", "").replace("-", "").isdigit()]
    if numbers:
        element = rng.choice(numbers)
        text = element.text.strip()
        element.text = rng.choice(
            ["0", "-1", "1e6", "1e-9", "1e20", f"-{text}", f"{text}e6", f"{text}e-6", f"{text}00"]
        )


def _remove(root: ElementTree.Element, rng: random.Random) -> None:
    parent = rng.choice([e for e in root.iter() if len(e)] or [root])
    for child in list(parent):
        if rng.random() < 1.5 / len(parent):
            parent.remove(child)


def _double(root: ElementTree.Element, rng: random.Random) -> None:
    parent = rng.choice([e for e in root.iter() if len(e)] or [root])
    if len(parent):
        parent.insert(rng.randrange(len(parent) + 1), copy.deepcopy(rng.choice(list(parent))))


def _attribute(root: ElementTree.Element, rng: random.Random) -> None:
    element = rng.choice(list(root.iter()))
    if not element.attrib:
        element.attrib[rng.choice(["name", "file", "unit", "value", "type"])] = rng.choice(TEXTS)
    elif rng.random() < 0.4:
        del element.attrib[rng.choice(sorted(element.attrib))]
    else:
        element.attrib[rng.choice(sorted(element.attrib))] = rng.choice(TEXTS + ATTRIBUTES)


def _tag(root: ElementTree.Element, rng: random.Random) -> None:
    rng.choice(list(root.iter())).tag = rng.choice(ANY_TAG)


def _child(root: ElementTree.Element, rng: random.Random) -> None:
    ElementTree.SubElement(rng.choice(list(root.iter())), rng.choice(ANY_TAG)).text = rng.choice(TEXTS)


def _move(root: ElementTree.Element, rng: random.Random) -> None:
    parents = {child: parent for parent in root.iter() for child in parent}
    if len(parents) > 2:
        moved = rng.choice(list(parents))
        place = rng.choice(list(root.iter()))
        if place not in set(moved.iter()):
            parents[moved].remove(moved)
            place.append(moved)


def _shuffle(root: ElementTree.Element, rng: random.Random) -> None:
    parent = rng.choice([e for e in root.iter() if len(e)] or [root])
    children = list(parent)
    rng.shuffle(children)
    parent[:] = children


CHANGES = [_text, _text, _number, _remove, _double, _attribute, _tag, _child, _move, _shuffle]


# -- by hand ---------------------------------------------------------------------------------------------------------


def attacks(victim: Path) -> dict[str, Files]:
    """Aircraft that are meant to do harm; `victim` is a file that some of them would overwrite."""
    made = {name: _with(text) for name, text in _in_main(victim).items()}
    made |= {
        f"system {name}": _with(f'<system name="x"><channel name="c">{text}</channel></system>')
        for name, text in _IN_CHANNEL.items()
    }
    made |= {name: _aero(text) for name, text in _FUNCTIONS.items()}
    good = packaged()
    main = good["fw8.xml"]
    made["entity bomb"] = good | {"fw8.xml": _BOMB + main.partition(b"?>")[2]}
    made["external entity"] = good | {
        "fw8.xml": main.replace(b"<fdm_config", b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><fdm_config', 1)
    }
    made["utf-16"] = good | {"fw8.xml": main.decode().replace('"1.0"', '"1.0" encoding="utf-16"', 1).encode("utf-16")}
    made["utf-7"] = good | {"fw8.xml": main.replace(b'"1.0"', b'"1.0" encoding="utf-7"', 1)}
    made["not a file"] = good | {"fw8.xml": b"\0" * 4096}
    made["empty"] = good | {"fw8.xml": b""}
    made["huge"] = good | {"fw8.xml": main + b" " * 2_000_000}
    made["system of itself"] = good | {
        "systems/wing.xml": good["systems/wing.xml"].replace(
            b'<system name="wing">', b'<system name="wing" file="wing">'
        )
    }
    made["rows"] = good | {"engine/fw8_propeller.xml": _rows(good["engine/fw8_propeller.xml"])}
    made["doubling functions"] = _functions(40, "<sum><property>{0}</property><property>{0}</property></sum>")
    made["a chain of functions"] = _functions(4000, "<sum><property>{0}</property><value>1</value></sum>")
    made["a force by a path"] = good | {"fw8.xml": main.replace(b'name="push"', b'name="../simulation"', 1)}
    made["an eyepoint far away"] = good | {"fw8.xml": main.replace(b"<x>0.6</x>", b"<x>1e30</x>", 1)}
    made["a tank that is not there"] = good | {"fw8.xml": main.replace(b"</engine>", b"<feed>0</feed></engine>", 1)}
    made["many delays"] = _with(f'<system name="x"><channel name="c">{_DELAYS}</channel></system>')
    made["an engine for a thruster"] = good | {"fw8.xml": main.replace(b'"fw8_propeller"', b'"fw8_motor"', 1)}
    made["itself for a system"] = good | {"fw8.xml": main.replace(b'<system file="wing"/>', b'<system file="fw8"/>', 1)}
    made["a long delay"] = _with(f'<system name="x"><channel name="c">{_SLOW}</channel></system>')
    for tag, text in _IMPOSSIBLE.items():
        made[f"impossible {tag} {text}"] = good | {"fw8.xml": _replaced(main, tag, text)}
    return made


def _in_main(victim: Path) -> dict[str, str]:
    return {
        "output file": f'<output name="{victim}" type="CSV" rate="10"><rates>ON</rates></output>',
        "output above": '<output name="../../victim.csv" type="CSV" rate="10"/>',
        "output socket": '<output name="localhost" type="SOCKET" protocol="TCP" port="1138" rate="10"/>',
        "output FlightGear": '<output name="localhost" type="FLIGHTGEAR" protocol="UDP" port="5500" rate="10"/>',
        "output by file": f'<output file="{victim}"/>',
        "OUTPUT": f'<OUTPUT name="{victim}" type="CSV" rate="10"/>',
        "input": '<input port="1137"/>',
        "input UDP": '<input type="UDP" port="1139"/>',
        "child": '<child name="../fw8" mated="true"><location unit="IN"><x>0</x><y>0</y><z>0</z></location></child>',
        "planet": "<planet><semimajor_axis unit='FT'>1</semimajor_axis></planet>",
        "system above": '<system file="../../outside"/>',
        "system absolute": '<system file="/etc/hostname"/>',
        "system scheme": '<system file="file:///etc/hostname"/>',
        "autopilot above": '<autopilot file="../outside"/>',
        "aerodynamics by file": '<aerodynamics file="systems/wing"/>',
        "property simulation": '<system name="x"><property value="1">simulation/force-output</property></system>',
        "property ic": '<system name="x"><property value="9e9">ic/h-sl-ft</property></system>',
        "property index": '<system name="x"><property value="1">simulation[0]/reset</property></system>',
        "property up": '<system name="x"><property value="1">fcs/../simulation/reset</property></system>',
        "property dot": '<system name="x"><property value="1">./simulation/reset</property></system>',
        "property root": '<system name="x"><property value="1">/simulation/reset</property></system>',
        "property slashes": '<system name="x"><property value="1">//simulation/reset</property></system>',
        "property print": '<system name="x"><property value="1">inertia/print-mass-properties</property></system>',
        "property position": '<system name="x"><property value="1">position/h-sl-ft</property></system>',
    }


_IN = "<input>fcs/wing-cmd-norm</input>"


def _gain(output: str, name: str = "x") -> str:
    return f'<pure_gain name="{name}">{_IN}<gain>1</gain><output>{output}</output></pure_gain>'


def _setting(position: int, time: int) -> str:
    return f"<setting><position>{position}</position><time>{time}</time></setting>"


_IN_CHANNEL = {
    "output": _gain("simulation/reset"),
    "state": _gain("simulation/write-state-file"),
    "terminate": _gain("simulation/terminate"),
    "air": _gain("atmosphere/delta-T"),
    "name": _gain("fcs/mine", "simulation/terminate"),
    "function": '<fcs_function name="x"><function><value>1</value></function><output>simulation/reset</output>'
    "</fcs_function>",
    "case": '<distributor name="x" type="exclusive"><case><test value="1">fcs/wing-cmd-norm ge 0</test>'
    '<property value="1">simulation/reset</property></case></distributor>',
    "quantized": f'<sensor name="x">{_IN}<quantization name="simulation/reset"><bits>3</bits><min>0</min><max>1</max>'
    "</quantization></sensor>",
    "no input": '<pure_gain name="x"><gain>1</gain></pure_gain>',
    "endless kinematic": f'<kinematic name="x">{_IN}<traverse>{_setting(0, 0)}{_setting(-1, 1)}</traverse></kinematic>',
    "angle of nothing": '<angle name="x" unit="RAD"><source_angle unit="RAD">a/b</source_angle>'
    '<target_angle unit="RAD">c/d</target_angle></angle>',
    "reads nothing": '<pure_gain name="x"><input>no/such-thing</input><gain>1</gain></pure_gain>',
}
_SUMS = 20_000
_FUNCTIONS = {
    "nested sums": "<sum>" * _SUMS + "<value>1</value>" + "</sum>" * _SUMS,
    "31 sums": "<sum>" * 31 + "<value>1</value>" + "</sum>" * 31,
    "needs itself": "<sum><property>aero/mine</property></sum>",
    "reads nothing": "<property>no/such-thing</property>",
    "or of a number": "<or><value>7</value><value>1</value></or>",
    "switch out of range": "<switch><value>7</value><value>1</value></switch>",
    "remainder of 0": "<mod><value>5</value><value>0</value></mod>",
    "rotation of too little": "<rotation_wf_to_bf>" + "<value>1</value>" * 6 + "</rotation_wf_to_bf>",
    "clock": '<random seed="time_now"/>',
    "nothing": "",
    "interpolation": "<interpolate1d><value>1</value></interpolate1d>",
}
_BOMB = (
    b'<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "lol">'
    + b"".join(b'<!ENTITY %c "%s">' % (98 + i, b"&%c;" % (97 + i) * 10) for i in range(9))
    + b"]>"
)
_IMPOSSIBLE = {
    "ixx": "0", "iyy": "-1", "izz": "50", "emptywt": "0", "wingspan": "0", "wingarea": "-1", "chord": "0",
}  # fmt: skip


_DELAYS = "".join(
    f'<sensor name="y{k}"><input>fcs/wing-cmd-norm</input><delay type="time">100</delay></sensor>' for k in range(40)
)
_SLOW = '<sensor name="y"><input>fcs/wing-cmd-norm</input><delay type="frames">1e12</delay></sensor>'


def _functions(count: int, text: str) -> Files:
    """Return an aircraft with functions each of which reads the one before."""
    made = '<function name="aero/f0"><value>1</value></function>'
    made += "".join(
        f'<function name="aero/f{k}">{text.format(f"aero/f{k - 1}")}</function>' for k in range(1, count + 1)
    )
    good = packaged()
    return good | {"fw8.xml": good["fw8.xml"].replace(b"<aerodynamics>", f"<aerodynamics>{made}".encode())}


def _with(text: str) -> Files:
    good = packaged()
    return good | {"fw8.xml": good["fw8.xml"].replace(b"</fdm_config>", text.encode() + b"</fdm_config>")}


def _aero(text: str) -> Files:
    good = packaged()
    function = f'<aerodynamics><function name="aero/mine">{text}</function>'
    return good | {"fw8.xml": good["fw8.xml"].replace(b"<aerodynamics>", function.encode())}


def _replaced(main: bytes, tag: str, text: str) -> bytes:
    start = main.index(f"<{tag} ".encode())
    begin = main.index(b">", start) + 1
    return main[:begin] + text.encode() + main[main.index(b"</", begin) :]


def _rows(propeller: bytes) -> bytes:
    begin = propeller.index(b"<tableData>") + len(b"<tableData>")
    rows = "\n".join(f"{k} 0.1" for k in range(60_000))
    return propeller[:begin] + rows.encode() + propeller[propeller.index(b"</tableData>") :]


# -- a child process under watch -------------------------------------------------------------------------------------


def write(files: Files, folder: Path) -> Path:
    """Write an aircraft's files."""
    for path, content in files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    return folder


def watched(work: Callable[[], str], place: Path, *, seconds: int = 10) -> str:
    """Do some work in a child process that stands in `place`; return what it says, or how it ended.

    What it says is followed by the sockets that it left open and the files that it left in `place`, if any.
    """
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        said = "died"
        try:
            os.close(reader)
            os.chdir(place)
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, 1)
            os.dup2(nothing, 2)
            signal.alarm(seconds)
            said = work()
        except BaseException as error:  # noqa: BLE001 (whatever it is, it is told)
            said = f"raised {type(error).__name__}: {error}"
        finally:
            sockets = [link for link in _links() if link.startswith("socket:")]
            os.write(writer, (said + (f" SOCKETS {len(sockets)}" if sockets else "")).encode()[:4000])
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as pipe:
        said = pipe.read().decode()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return f"ended by signal {os.WTERMSIG(status)}"
    left = [str(file) for file in place.rglob("*")]
    return said + (f" FILES {left}" if left else "")


def _links() -> list[str]:
    links = []
    for name in os.listdir("/proc/self/fd"):
        try:
            links.append(os.readlink(f"/proc/self/fd/{name}"))
        except OSError:
            continue
    return links
