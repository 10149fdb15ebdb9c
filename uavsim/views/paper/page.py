"""The page: every table of the paper beside ours, and the figures, in one file that needs nothing else."""

from base64 import b64encode
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from uavsim import __version__
from uavsim.studies.paper import NOT_REPRODUCED, Entry
from uavsim.views.text import in_html as escape

STYLE = """
body { font: 15px/1.5 sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: .6rem 0 1rem }
th, td { border-bottom: 1px solid #ccc; padding: .25rem .8rem .25rem 0; text-align: left; vertical-align: top }
img { max-width: 100% } h2 { margin-top: 2.2rem } .yes { color: #00704f } .no { color: #b34a00 }
details { margin: .4rem 0 1rem } figure { margin: 1rem 0 }
"""
SHOWN: dict[str, tuple[str, ...]] = {  # figures below their tables
    "table1": ("figure7",),
    "table2": ("figure8",),
    "table3": ("figure9",),
    "table5": ("figure12",),
    "table7": ("figure19", "figure20"),
    "table8": ("figure21",),
    "pipe": ("pipes",),
    "centrifuge": ("figure17",),
}


def page(entries: Mapping[str, Entry], figures: Mapping[str, Path]) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    entries
        Tables by their names.
    figures
        PNG files by their names; they become part of the page.
    """
    body = "".join(_section(name, entry, figures) for name, entry in entries.items())
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f"<title>The paper beside ours</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        "<h1>The paper beside ours</h1>\n"
        f"<p>Written by <code>uavsim paper</code>, uavsim {escape(__version__)}. What is wrong in the paper stays "
        "different, with its reason. Numbers are in <code>results.json</code>.</p>\n"
        f"{_summary(entries)}{body}{_missing()}</body>\n</html>\n"
    )


def _summary(entries: Mapping[str, Entry]) -> str:
    rows = (
        (f'<a href="#{escape(name)}">{escape(heading(name))}</a>', escape(entry.title), verdict(entry))
        for name, entry in entries.items()
    )
    return _table(("", "what", "agrees"), rows)


def _missing() -> str:
    rows = ((escape(what), escape(why)) for what, why in NOT_REPRODUCED.items())
    return '<h2 id="missing">Not reproduced</h2>\n' + _table(("what", "why"), rows)


def heading(name: str) -> str:
    """Name of a table for people: table1 is Table 1."""
    text = name.rstrip("0123456789")
    return f"{text.capitalize()} {name[len(text) :]}".strip()


def verdict(entry: Entry) -> str:
    """Whether it agrees, and whether that is as documented, as HTML."""
    word = "yes" if entry.agrees else "no"
    end = ", <strong>not as documented</strong>"
    if entry.as_documented:
        end = "" if entry.agrees else ", as documented"
    return f'<span class="{word}">{word}</span>{end}'


def _section(name: str, entry: Entry, figures: Mapping[str, Path]) -> str:
    rows = [(escape(key), _value(entry.paper[key]), _value(entry.ours.get(key))) for key in entry.paper]
    within = "" if entry.tolerance is None else f" (within {entry.tolerance:g})"
    return (
        f'<h2 id="{escape(name)}">{escape(heading(name))}: {escape(entry.title)}</h2>\n'
        f"{_table(('', 'paper', 'ours'), rows)}<p>Agrees{within}: {verdict(entry)}. {escape(entry.note)}</p>\n"
        f"{_details(entry)}{''.join(_figure(f, figures[f]) for f in SHOWN.get(name, ()) if f in figures)}"
    )


def _details(entry: Entry) -> str:
    parts = []
    for key, value in entry.details.items():
        shown = _noise(value) if key == "noise" else f"<p>{escape(_words(key))}: {_value(value)}</p>\n"
        parts.append(shown)
    return "".join(parts)


def _noise(table: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """Probabilities by the noise: exact, and drawn with its band."""
    names = list(next(iter(table.values())))
    rows = ((f"{escape(sigma)} A", *(_chance(row[name]) for name in names)) for sigma, row in table.items())
    head = "<p>Probability under white noise: exact; share of drawn noise with its 95 % band.</p>\n"
    return head + _table(("σ", *map(_words, names)), rows)


def _chance(value: Mapping[str, Any]) -> str:
    low, high = value["band"]
    exact = "–" if value["exact"] is None else f"{value['exact']:.4f}"
    return f"{exact}; {value['drawn']:.4f} [{low:.4f}, {high:.4f}]"


def _words(key: str) -> str:
    return key.replace("_", " ")


def _value(value: Any) -> str:
    """Return a nested value as one line of HTML."""
    if isinstance(value, Mapping):
        return ", ".join(f"{escape(_words(str(k)))}: {_value(v)}" for k, v in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(_value, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    return "–" if value is None else escape(str(value))


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>\n" for row in rows)
    return f"<table>\n<tr>{top}</tr>\n{body}</table>\n"


def _figure(name: str, file: Path) -> str:
    data = b64encode(file.read_bytes()).decode("ascii")
    return f'<figure><img alt="{escape(heading(name))}" src="data:image/png;base64,{data}"></figure>\n'
