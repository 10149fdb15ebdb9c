"""Where aircraft stand: inside the installed package, or beside it in a checkout.

A wheel carries ``aircraft/`` as ``uavsim/aircraft``; in a checkout it lies beside the package. A user's own aircraft
is a folder with ``NAME/NAME.xml`` in it, named by its path.
"""

import os
from difflib import get_close_matches
from pathlib import Path

from uavsim.plants.airframe import Airframe, read_airframe

_PACKAGE = Path(__file__).resolve().parent.parent


def hangar() -> Path:
    """Folder that holds the packaged aircraft."""
    for place in (_PACKAGE / "aircraft", _PACKAGE.parent / "aircraft"):
        if place.is_dir():
            return place
    raise FileNotFoundError(f"no aircraft folder in {_PACKAGE} or beside it; the installation is incomplete")


def aircraft() -> list[str]:
    """Names of the packaged aircraft."""
    return sorted(p.name for p in hangar().iterdir() if (p / f"{p.name}.xml").is_file())


def find_aircraft(model: str) -> Path:
    """Folder of an aircraft.

    Parameters
    ----------
    model
        A packaged name, or the path of a folder ``…/NAME`` that holds ``NAME.xml``; with a slash in it, it is a path.

    Raises
    ------
    ValueError
        If there is none; the message names the nearest packaged one.
    """
    own = Path(os.path.expanduser(model))  # os.path's, which does not raise for odd names
    for folder in (own,) if _is_path(model) else (hangar() / model, own):
        if model and os.path.isfile(folder / f"{folder.name}.xml"):
            return folder.resolve()
    known = aircraft()
    near = get_close_matches(model.lower(), known, n=1, cutoff=0.3)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise ValueError(f"unknown aircraft {model!r}; {hint}packaged: {', '.join(known)}; or the path of a folder")


def _is_path(model: str) -> bool:
    return any(separator in model for separator in (os.sep, os.altsep) if separator)


def find_airframe(model: str) -> Airframe:
    """Find an aircraft, as `find_aircraft` does, read its files and check them.

    Raises
    ------
    ValueError
        If there is none, or its files are not an aircraft's and nothing else.
    """
    return model if isinstance(model, Airframe) else read_airframe(find_aircraft(model))


def is_packaged(airframe: Airframe) -> bool:
    """Whether an aircraft is one of the packaged ones."""
    return Path(airframe).parent == hangar().resolve()
