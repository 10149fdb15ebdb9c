"""The paper beside ours: a folder with `results.json`, `figures/` and a page, and the same in the terminal."""

from pathlib import Path
from typing import TYPE_CHECKING

from uavsim.files import write_json, write_text
from uavsim.views import terminal
from uavsim.views.figure import save as save_figure
from uavsim.views.paper.figures import FIGURES
from uavsim.views.paper.page import heading, page

if TYPE_CHECKING:
    from uavsim.studies.paper import Reproduction

__all__ = ["print_entries", "save"]


def save(found: "Reproduction", folder: Path) -> None:
    """Write results, figures and page into a folder that is there."""
    (folder / "figures").mkdir()
    files = {name: save_figure(draw(found), folder / "figures" / f"{name}.png") for name, draw in FIGURES.items()}
    write_json(folder / "results.json", {name: entry.to_dict() for name, entry in found.entries.items()})
    write_text(folder / "index.html", page(found.entries, files))


def print_entries(found: "Reproduction") -> None:
    """Print a line a table: whether it agrees, and whether that is as documented."""
    for name, entry in found.entries.items():
        word = "agrees" if entry.agrees else "differs"
        remark = ", which is NOT as documented"
        if entry.as_documented:
            remark = "" if entry.agrees else ", as documented"
        terminal.say(f"{heading(name):<12}{entry.title:<50}{word}{remark}")
