"""Who flies: software and processor, on which the last bits of a flight depend.

Two processes give the same bits when their packages have the same versions, our own files are the same, and the
processors have the same features: libraries of linear algebra and compilers choose their instructions by them.
"""

import platform
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import sensors
import uavsim

PACKAGES = ("uavsim", "jsbsim", "numpy", "scipy", "filterpy", "pandas", "pyarrow")
"""Whose versions are told in a campaign's record."""
COMPARED = (*PACKAGES, "numba")
FEATURES = ("avx", "fma", "sse4", "asimd", "sve")  # of the processor, that floating point may depend on
CPUINFO = Path("/proc/cpuinfo")
OF_US = ("*.py", "*.toml", "*.xml")


def versions() -> dict[str, str | None]:
    """Return versions of Python and of the packages that a result depends on; None where one is not installed."""
    return {**{name: _version(name) for name in PACKAGES}, "python": platform.python_version()}


def processor() -> dict[str, Any]:
    """Return what the system tells of the processor: machine, name, features."""
    return {
        "machine": platform.machine(),
        "name": platform.processor(),
        "features": processor_features(CPUINFO),
    }


def processor_features(cpuinfo: Path) -> list[str]:
    """Features of the first processor that floating point may depend on; none where the system does not tell."""
    if not cpuinfo.is_file():
        return []
    for line in cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines():
        name, _, flags = line.partition(":")
        if name.strip() in {"flags", "Features"}:
            return sorted({flag for flag in flags.split() if flag.startswith(FEATURES)})
    return []


@cache
def identity() -> dict[str, str]:
    """Return everything that a flight's bits depend on besides its scenario, by name."""
    told = {name: str(_version(name)) for name in COMPARED}
    told |= {"python": platform.python_version(), "machine": platform.machine()}
    return {**told, "processor features": " ".join(processor_features(CPUINFO)), "uavsim's files": _files()}


def differences(ours: Mapping[str, str], theirs: Mapping[str, str]) -> list[str]:
    """Say what two of them do not share, a phrase each: name, theirs, ours."""
    return [
        f"{name}: {_short(theirs.get(name, 'none'), ours.get(name, ''))} there, "
        f"{_short(ours.get(name, 'none'), theirs.get(name, ''))} here"
        for name in dict.fromkeys((*ours, *theirs))
        if ours.get(name) != theirs.get(name)
    ]


def _short(value: str, other: str) -> str:
    """Of a list of words only those that the other lacks."""
    more = [word for word in value.split() if word not in other.split()]
    return " ".join(more) if more and " " in value else value or "none"


def _files() -> str:
    """Digest of our own files: a version does not tell one working copy from another."""
    found = sha256()
    for package in (uavsim, sensors):
        folder = Path(str(package.__file__)).parent
        for path in sorted(path for pattern in OF_US for path in folder.rglob(pattern)):
            found.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:16]


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
