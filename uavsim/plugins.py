"""Detectors, estimators and plants of one's own: how they are found, who they are, and what they may be told.

Names are registered by entry points of installed packages, by what the user names with `--plugin`, or in Python by the
decorators here. A scenario file only names a kind: it never makes anything run that is not installed or asked for on
the command line. Entry points are read as metadata; only the package whose name is asked for is imported.
"""

import dataclasses
import hashlib
import importlib
import importlib.util
import os
import re
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, packages_distributions, version
from pathlib import Path
from types import ModuleType
from typing import Any, cast

from sensors.choice import nearest, shown
from uavsim import settings
from uavsim.failure import said
from uavsim.files import without_none
from uavsim.onboard.airspeed.kinds import KINDS as ESTIMATORS
from uavsim.onboard.airspeed.kinds import estimator
from uavsim.onboard.launch.kinds import KINDS as DETECTORS
from uavsim.onboard.launch.kinds import detector
from uavsim.plants import choice as _choice  # noqa: F401 (registers ours)
from uavsim.plants.kinds import KINDS as PLANTS
from uavsim.plants.kinds import plant
from uavsim.registry import Registry
from uavsim.settings import SettingError

__all__ = ["Source", "check_options", "detector", "estimator", "known", "load", "plant", "plugged_in"]

OURS = "uavsim"
REGISTRIES: dict[str, Registry[Any]] = {"detector": DETECTORS, "estimator": ESTIMATORS, "plant": PLANTS}
LARGEST = 10_000_000  # B, of a file that is a plug-in


@dataclass(frozen=True, slots=True)
class Source:
    """Who a kind is.

    Attributes
    ----------
    group : str
        "uavsim.detectors", "uavsim.estimators" or "uavsim.plants".
    name : str
        By which a scenario names it.
    source : str
        Package and module that it comes from, or file.
    version : str or None
        Of the package.
    sha256 : str or None
        Of the file, if it is not in a package.
    """

    group: str
    name: str
    source: str
    version: str | None = None
    sha256: str | None = None

    def is_(self, other: "Source") -> bool:
        """Whether the other is the same code: the same file's content, or the same version of the same package."""
        if self.sha256 is not None or other.sha256 is not None:
            return self.sha256 == other.sha256
        return (self.source, self.version) == (other.source, other.version)

    def __str__(self) -> str:
        """Say who it is in a line."""
        told = self.version or (self.sha256 and f"SHA-256 {self.sha256[:12]}…")
        return f"{self.name!r} of {self.source}" + (f" ({told})" if told else "")


class PluginError(ValueError):
    """A plug-in that cannot be used; one line."""


# -- finding ---------------------------------------------------------------------------------------------------------


def find(what: str, name: str) -> Any:
    """Return the kind of a name; the package that has it is imported if need be.

    Raises
    ------
    PluginError
        If nobody has registered it, or its package cannot be imported.
    """
    registry = REGISTRIES[what]
    if name not in registry:
        point = next((p for p in _points(registry.group) if p.name == name), None)
        if point is None:
            raise PluginError(unregistered(what, name))
        _import_point(registry, point)
    return registry[name]


def known(what: str) -> list[str]:
    """Names that can be used: those that are registered, and those that packages would register."""
    registry = REGISTRIES[what]
    return list(dict.fromkeys([*registry, *(p.name for p in _points(registry.group))]))


def unregistered(what: str, name: str) -> str:
    """Say that nobody has registered a name, which there are, and how to register one."""
    if _is_file(name):
        return f"{shown(name)} names a file, and a scenario runs none; give it to --plugin and name what it registers"
    names = known(what)
    near = nearest(name, names, cutoff=0.4)
    hint = f"did you mean {near!r}? " if near else ""
    return (
        f"{shown(name)} is not registered; {hint}there are {', '.join(names)}; one of your own comes with "
        f"--plugin FILE.py or from a package with the entry point group {REGISTRIES[what].group}"
    )


def of_class(what: str, cls: Any) -> str:
    """Return the name of a class's kind; one that is not registered is registered by its own name.

    Raises
    ------
    ValueError
        If it is no such class, or its name is taken.
    """
    registry = REGISTRIES[what]
    for kind in registry.values():
        if kind.cls is cls:
            return str(kind.name)
    name = re.sub(r"[^\w.+-]", "", str(getattr(cls, "__name__", "")))[:60] or what
    if name in registry and (what, name) not in _passing:
        name = f"{name}-2"
    if name in registry:
        registry.remove(name)
    DECORATORS[what](name)(cls)
    _passing.add((what, name))
    return name


_passing: set[tuple[str, str]] = set()  # classes that were only flown in Python; the next of that name takes the place


def _points(group: str) -> tuple[EntryPoint, ...]:
    return tuple(sorted(entry_points(group=group), key=lambda point: point.name))


def _import_point(registry: Registry[Any], point: EntryPoint) -> None:
    """Import what an entry point names; a class that does not register itself is registered by the point's name."""
    with _blamed(f"{registry.what} {point.name!r} of {_distribution(point)}"):
        found = point.load()
    if point.name in registry:
        return
    told = next((kind for kind in registry.values() if kind.cls is found), None)
    if told is not None:  # by its decorator, and by another name
        registry.add(replace(told, name=point.name))
        return
    try:
        DECORATORS[registry.what](point.name)(found)
    except (TypeError, ValueError, AttributeError) as error:
        raise PluginError(f"{registry.what} {point.name!r} of {_distribution(point)}: {_one_line(error)}") from None


DECORATORS: dict[str, Callable[..., Callable[[Any], Any]]] = {
    "detector": detector,
    "estimator": estimator,
    "plant": plant,
}


def load(names: Iterable[str]) -> None:
    """Import what the user names: files that end in .py, and modules.

    Raises
    ------
    PluginError
        One line: it is missing, it does not import (its own error with file and line), it registers nothing, or a name
        of its is taken.
    """
    for name in names:
        before = {(what, kind) for what, registry in REGISTRIES.items() for kind in registry}
        already = name in _loaded or (_is_file(name) and str(Path(name).expanduser().resolve()) in _loaded)
        with _blamed(f"--plugin {shown(name)}"):
            module = _import_file(name) if _is_file(name) else _import_module(name)
        after = {(what, kind) for what, registry in REGISTRIES.items() for kind in registry}
        if after == before and not already and not _registers(module):
            raise PluginError(
                f"--plugin {shown(name)}: registers no detector, estimator or plant; "
                "decorate a class with @uavsim.plugins.detector('name')"
            )
        _loaded[str(Path(name).expanduser().resolve()) if _is_file(name) else name] = None


def loaded() -> tuple[str, ...]:
    """Return what has been imported by `load`, so that another process can do the same; files with their whole path."""
    return tuple(_loaded)


def digests() -> tuple[tuple[str, str], ...]:
    """Return the same names, each with the SHA-256 of the file that was imported; of a module it is empty."""
    of_files = {str(Path(path).expanduser().resolve()): digest for path, digest in _files.values()}
    return tuple((name, of_files.get(name, "")) for name in _loaded)


def _is_file(name: str) -> bool:
    return name.endswith(".py") or "/" in name


_loaded: dict[str, None] = {}
_files: dict[str, tuple[str, str]] = {}  # module: path and SHA-256 of a file that is a plug-in


def _registers(module: Any) -> bool:
    """Whether a module that had been imported before has registered something."""
    return any(_module(kind) == module.__name__ for registry in REGISTRIES.values() for kind in registry.values())


def _import_module(name: str) -> Any:
    if not all(part.isidentifier() for part in name.split(".")):
        raise PluginError(f"--plugin {shown(name)}: is neither a file that ends in .py nor a module's name")
    if importlib.util.find_spec(name) is None:
        raise PluginError(f"--plugin {shown(name)}: there is no such module; a file ends in .py")
    return importlib.import_module(name)


def _import_file(name: str) -> Any:
    """Import a file; the same one again is the module that it was."""
    path = Path(name).expanduser()
    if not os.path.isfile(path):
        raise PluginError(f"--plugin {shown(name)}: there is no such file")
    if path.stat().st_size > LARGEST:
        raise PluginError(f"--plugin {shown(name)}: has more than {LARGEST} bytes")
    content = path.read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    key = f"uavsim_plugin_{path.stem}_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:12]}"
    if key in sys.modules and _files[key][1] == digest:
        return sys.modules[key]
    module = ModuleType(key)
    module.__file__ = str(path.resolve())
    sys.modules[key], _files[key] = module, (str(path), digest)
    beside = str(path.resolve().parent)
    if beside not in sys.path:
        sys.path.append(beside)  # for what it imports from beside itself; what is installed comes first
    try:
        exec(compile(content, module.__file__, "exec"), vars(module))  # noqa: S102 (what is hashed is what runs)
    except BaseException:
        del sys.modules[key], _files[key]
        raise
    return module


@contextmanager
def _blamed(where: str) -> Iterator[None]:
    """Turn whatever importing raises into one line that names it, with the file and line of the plug-in's own."""
    try:
        yield
    except (PluginError, KeyboardInterrupt):
        raise
    except SystemExit as error:
        raise PluginError(f"{where}: ends the program as it is imported ({error.code})") from error
    except BaseException as error:
        raise PluginError(f"{where}: {_place(error)}{_one_line(error)}") from error


def _place(error: BaseException) -> str:
    """Return file and line where it was raised, of a syntax error where that is."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}, line {error.lineno}: "
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _is_machinery(f.filename)]
    return f"{frames[-1].filename}, line {frames[-1].lineno}: " if frames else ""


def _is_machinery(filename: str) -> bool:
    """Whether a file is Python's own importing, or ours that registers."""
    return filename.startswith(("<frozen", *_MACHINERY))


_MACHINERY = (str(Path(__file__).parent), str(Path(importlib.__file__).parent), dataclasses.__file__)


def _one_line(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        return " ".join(f"{type(error).__name__}: {error.msg}".split())
    return said(error)


# -- who they are ----------------------------------------------------------------------------------------------------


def plugged_in(named: Mapping[str, str]) -> tuple[Source, ...]:
    """Return who those kinds are that do not come with uavsim; `named`: detector, estimator or plant, and its name."""
    kinds = ((what, find(what, name)) for what, name in named.items())
    return tuple(source_of(what, kind) for what, kind in kinds if _module(kind).partition(".")[0] != OURS)


def sources(what: str) -> Iterator[Source]:
    """Who every kind is; packages that nobody has asked for are not imported, and are known by their metadata."""
    registry = REGISTRIES[what]
    for kind in registry.values():
        yield source_of(what, kind)
    for point in _points(registry.group):
        told = None if point.dist is None else point.dist.version
        if point.name not in registry:
            yield Source(registry.group, point.name, point.value, told)
        elif not _module(registry[point.name]).startswith(point.module):
            yield Source(registry.group, point.name, f"{point.value} (not used: the name is taken)", told)


def source_of(what: str, kind: Any) -> Source:
    """Return who a kind is."""
    group, module = REGISTRIES[what].group, _module(kind)
    if module in _files:
        path, digest = _files[module]
        return Source(group, kind.name, Path(path).name, sha256=digest)
    package = module.partition(".")[0]
    if package == OURS:
        return Source(group, kind.name, module, _version(OURS))
    for name in packages_distributions().get(package, ()):
        return Source(group, kind.name, f"{name}: {module}", _version(name))
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is not None and Path(file).is_file():
        return Source(group, kind.name, Path(file).name, sha256=hashlib.sha256(Path(file).read_bytes()).hexdigest())
    return Source(group, kind.name, module, sha256=_digest(kind.cls))


def _digest(cls: Any) -> str | None:
    """SHA-256 of a class's code that is in no file, as of a notebook; None if it has none."""
    functions = [getattr(value, "fget", value) for value in vars(cls).values()] if isinstance(cls, type) else [cls]
    codes = [function.__code__ for function in functions if hasattr(function, "__code__")]
    told = "\n".join(sorted(map(_told, codes)))
    return hashlib.sha256(told.encode()).hexdigest() if codes else None


def _told(code: Any) -> str:
    """What a function does, but for where it stands."""
    constants = [_told(each) if hasattr(each, "co_code") else repr(each) for each in code.co_consts]
    return f"{code.co_name} {code.co_code.hex()} {code.co_names} {constants}"


def _module(kind: Any) -> str:
    return str(getattr(kind.cls, "__module__", ""))


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _distribution(point: EntryPoint) -> str:
    return point.value if point.dist is None else point.dist.name


# -- what they may be told -------------------------------------------------------------------------------------------


def check_options(what: str, options: type | None, given: Any) -> Any:
    """Return a kind's options as its own `Settings`; None if it has none.

    Parameters
    ----------
    what : str
        The scenario's group: "detector", "estimator", "plant".
    options : type, optional
        The class of the options.
    given : mapping or dataclass, optional
        The options as plain values, or as their class.

    Raises
    ------
    SettingError
        One line that names the key and what is allowed.
    """
    where = f"{what}.options"
    if options is None:
        if given:
            raise SettingError(f"{where}: this {what} has no options", where)
        return None
    try:
        if isinstance(given, options):
            given = asdict(cast(Any, given))
        found: Any = settings.read(options, given or {})
        again: Any = settings.read(options, without_none(asdict(found)))
    except SettingError as error:
        raise SettingError(f"{where}: {error.problem}", where, *(f"{where}.{key}" for key in error.keys)) from None
    except Exception as error:  # noqa: BLE001 (what somebody's declarations lead to is not known)
        raise SettingError(f"{where}: {options.__qualname__} cannot be read: {said(error)}", where) from None
    if again != found:
        raise SettingError(f"{where}: {options.__qualname__} holds what a file cannot: {shown(str(found))}", where)
    return found
