"""`uavsim paper`: the paper's tables and figures beside ours."""

from uavsim.cli.common import Bar, Out, Overwrite, folder, leave


def paper(out: Out = None, overwrite: Overwrite = False) -> None:
    """Reproduce the paper: its tables and figures beside ours.

    Writes results.json, figures and a page. What is wrong in the paper stays different and is documented; the exit
    status is 0 if everything agrees or differs as documented, else 1.

    Example: uavsim paper --out output/paper
    """
    from uavsim.studies.paper import reproduce
    from uavsim.views import paper as view
    from uavsim.views import terminal

    with folder(out, "paper", overwrite=overwrite) as place:  # before anything is computed in vain
        with Bar("reproducing the paper") as bar:
            found = reproduce(bar.show)
        view.save(found, place.folder)
    view.print_entries(found)
    terminal.say(f"written to {place.target}")
    leave(found.as_documented)
