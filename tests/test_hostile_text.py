"""Text that somebody chose to be obeyed, not read: names, parts, keys, values on the terminal, in figures, on a page.

The strings are drawn from controls, escape codes, characters that turn or hide what is written, markup of rich,
mathtext of matplotlib, and HTML.
"""

import io
import sys
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors import record_at_rest
from sensors.bench import on_bench
from sensors.bench_log import read_bench_log
from sensors.catalogue import sheet
from uavsim import cli
from uavsim.flight import Flight
from uavsim.studies.paper import Entry
from uavsim.studies.sensor_bench import Bench, put_on_bench
from uavsim.views import characterisation, datasheets, figure, pressure, terminal
from uavsim.views.paper.page import page
from uavsim.views.record import Record
from uavsim.views.text import LONGEST, message, visible

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PIECES = st.sampled_from(
    [
        *(
            "\x1b[31m",
            "\x1b]0;title\x07",
            "\x07",
            "\x08",
            "\r",
            "\x7f",
            "\x9b31m",
            "\x85",
            "\u202e",
            "\u200b",
            "\u2028",
        ),
        *("\ufe0f", "\u3164", "\ue024", "\udcff", "[red]", "[/]", "[/red]", "[link=x]", "[", "\\", "$", r"\$", "$x^2$"),
        *(r"\frac{1}{0", "$f_x$", "<b>", "&amp;", "\"'", "{0}", "%s", ":smile:", "_", "\t", "\n", " "),
    ]
)
HOSTILE = st.lists(PIECES | st.text(max_size=4), min_size=1, max_size=8).map("".join)
STUBBORN = (
    *("\x1b[31mred\x07", "a\rb\x9bc\u202ed", "[red]x[/red] [/]", "[link=https://example.org]y[/link]", "$x^2$ and $"),
    *(r"\frac{1}{0", "$f_x$", "<b>h</b> &amp;", "\u98de\u884c \U0001f680", "_begins", "{0} %s :smile:", "\ue024"),
)


def is_seen(letter: str) -> bool:
    return letter == "\n" or (letter.isprintable() and letter not in "\u3164\ufe0f\u034f\u2800")


def printed(show: Callable[[], object], *, screen: bool = False) -> str:
    """What is written to standard output."""

    class Screen(io.StringIO):
        def isatty(self) -> bool:
            return screen

    before, sys.stdout = sys.stdout, Screen()
    try:
        show()
        return sys.stdout.getvalue()
    finally:
        sys.stdout = before


# -- one line --------------------------------------------------------------------------------------------------------


@settings(deadline=None, derandomize=True)
@given(HOSTILE)
def test_visible_text_has_nothing_to_obey_and_what_is_seen_stays(text: str) -> None:
    assert all(is_seen(letter) and letter != "\n" for letter in visible(text))
    assert all(map(is_seen, visible(text, keep="\n")))
    plain = "".join(letter for letter in text if is_seen(letter) and letter != "\n")
    assert visible(plain) == plain


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a\x1b[31mb", r"a\x1b[31mb"),
        ("\x9b", r"\x9b"),
        ("\u202e", r"\u202e"),
        ("\udcff", r"\udcff"),
        ("\U000e0100", r"\U000e0100"),
        ("a\nb", r"a\nb"),
        ("Überflug 飛行 µg/√Hz", "Überflug 飛行 µg/√Hz"),
    ],
)
def test_what_is_not_seen_stands_as_an_escape(text: str, shown: str) -> None:
    assert visible(text) == shown


def test_a_long_message_is_cut_in_its_middle_and_says_so() -> None:
    text = "Error: " + "a/" * 2400 + ": there is no such file"
    line = message(text)
    assert len(line) < LONGEST + 50
    assert line.startswith("Error: a/a/")
    assert line.endswith(": there is no such file")
    assert f"({len(text) - LONGEST} characters left out)" in line
    assert message("x" * LONGEST) == "x" * LONGEST


COMMANDS = ("fly", "fly --set", "sensors", "replay", "roc --detectors", "tune --detector", "survey", "fly --seeds")


@settings(deadline=None, derandomize=True, max_examples=40)
@given(HOSTILE, st.sampled_from(COMMANDS))
def test_an_error_is_one_line_of_what_is_seen(text: str, command: str) -> None:
    arguments, errors, kept = ["uavsim", *command.split(), "no/" + text], io.StringIO(), (sys.argv, sys.stderr)
    sys.argv, sys.stderr = arguments, errors
    try:
        with pytest.raises(SystemExit) as caught:
            cli.main()
    finally:
        sys.argv, sys.stderr = kept
    said = errors.getvalue()
    assert caught.value.code == 2
    assert said.startswith("Error: ")
    assert said.endswith("\n")
    assert said.count("\n") == 1
    assert all(map(is_seen, said))
    assert len(said) < LONGEST + 60


# -- the terminal ----------------------------------------------------------------------------------------------------


def in_file(text: str) -> str:
    """Return the text as a scenario's file can hold it: UTF-8 has no halves of characters, as JSON's escapes have."""
    return text.encode("utf-8", "replace").decode()


def named(flight: Flight, text: str) -> Flight:
    """The flight with text of somebody's wherever a folder may hold some."""
    unmet = {"key": text, "minimum": None, "maximum": 1.0, "value": 2.0, "met": False}
    score = {**flight.score, "requirements": [unmet], "expected": text}
    return replace(flight, scenario={**flight.scenario, "name": in_file(text)}, score=score)


@settings(deadline=None, derandomize=True, max_examples=20)
@given(text=HOSTILE)
def test_a_score_shows_hostile_names_as_text(catapult: Flight, text: str) -> None:
    out = printed(lambda: terminal.print_score(named(catapult, text)))
    assert all(map(is_seen, out))
    assert out.startswith("\n" + visible(in_file(text), keep="\n") + ", seed 1: ")


@settings(deadline=None, derandomize=True, max_examples=60)
@given(text=HOSTILE)
def test_a_line_and_a_table_show_text_as_it_is(text: str) -> None:
    assert printed(lambda: terminal.say(text)) == visible(text) + "\n"
    table = terminal._table((text, text))
    table.add_row(text, terminal.words((text, "bold")))
    out = printed(lambda: terminal._print(terminal._console(), table, text))
    assert all(map(is_seen, out))
    assert out.endswith(visible(text, keep="\n") + "\n")


def test_colours_on_a_screen_are_ours_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    out = printed(lambda: terminal.say("\x1b[31m[red]x[/red]:smile:"), screen=True)
    assert out == "\\x1b[31m[red]x[/red]:smile:\n"


@pytest.mark.parametrize("text", STUBBORN)
def test_a_preset_shows_hostile_text_as_it_is(tmp_path: Path, text: str) -> None:
    """In its part, document, filter and sources."""
    part = sheet("adxl345")
    part["part"] = part["document"] = text
    part["values"]["filters"], part["values"]["default_filter"] = [text], text
    part["sources"] = dict.fromkeys(part["sources"], text)
    (tmp_path / "part.toml").write_text(tomli_w.dumps(part), encoding="utf-8")
    out = printed(lambda: datasheets.print_preset(str(tmp_path / "part.toml")))
    assert all(map(is_seen, out))
    assert out.startswith(f"part: {visible(text)}\n{visible(text)}\n")


# -- figures ---------------------------------------------------------------------------------------------------------


def drawn(one: "Figure") -> list[str]:
    """What a figure shows once it is saved: all its text as matplotlib reads it, without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with tempfile.TemporaryDirectory() as place:
            figure.save(one, Path(place) / "drawn.png")
    return [as_read(text) for text in figure._texts(one)]


def as_read(text: object) -> str:
    said, is_math = text._preprocess_math(text.get_text())  # type: ignore[attr-defined]
    return str(said.replace(r"\$", "$") if is_math else said)


def as_drawn(text: str) -> str:
    """The text with escapes for what is not seen, and for the letters that the font lacks."""
    from matplotlib.font_manager import findfont, get_font

    there = get_font(findfont("DejaVu Sans")).get_charmap()
    return "".join(letter if ord(letter) in there else ascii(letter)[1:-1] for letter in visible(text))


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """A part on the bench with somebody's log beside it."""
    file = tmp_path_factory.mktemp("log") / "log.csv"
    record_at_rest("bmp390", duration=20.0, seed=2).to_csv(file, index=False)
    log = read_bench_log(file, ["t", "pressure"], [], {})
    return put_on_bench(on_bench("bmp390"), hours=0.01, seed=1, log=log)


@pytest.mark.parametrize("text", ["\x1b[31mred\x07", "$f_x$ and $", "_\u98de [/]"])
def test_a_bench_draws_hostile_names_as_they_are(bench: Bench, text: str) -> None:
    """Of the part in the title, of the log below it and in the legend."""
    assert bench.log is not None
    part, log = replace(bench.description, name=text), replace(bench.log, name=text[:20])
    shown = drawn(characterisation.allan(replace(bench, description=part, log=log)))
    assert any(line.startswith(f"{as_drawn(text)} on the bench") for line in shown)
    assert any(line.strip() == as_drawn(text[:20]) for line in shown)


def test_a_flights_figure_draws_a_hostile_name_as_it_is(catapult: Flight) -> None:
    text = r"$\frac{1}{0 \x1b[31m[red]"
    one = pressure.draw(Record(named(catapult, text)))
    assert one is not None
    assert any(line.startswith(as_drawn(text)) for line in drawn(one))


@settings(deadline=None, derandomize=True, max_examples=12)
@given(text=HOSTILE, ours=st.sampled_from(["$f_x$", "$-f_z$", "$p_t - p_s$"]))
def test_any_text_is_drawn_as_it_is_beside_our_own_symbols(text: str, ours: str) -> None:
    one, ((axes,),) = figure.sheet(text, text, (1.0,), size=(4.0, 3.0))
    axes.plot([0.0, 1.0], label=figure.literal(text))
    figure.label(axes, f"{ours}, {figure.literal(text)}", text)
    figure.legend(axes)
    shown = drawn(one)
    space = " " if visible(text).startswith("_") else ""  # matplotlib would hide what begins with an underscore
    assert f"{ours}, {space}{as_drawn(text)}" in shown
    assert f"{space}{as_drawn(text)}" in shown


def test_our_own_symbols_are_drawn_as_symbols_and_no_other() -> None:
    one, ((axes,),) = figure.sheet("title", "the true $f_x$ crossed", (1.0,))
    figure.label(axes, "$p_t - p_0$, Pa", "costs $5 and $6")
    drawn(one)
    math = {text.get_text(): text._preprocess_math(text.get_text())[1] for text in figure._texts(one)}  # type: ignore[attr-defined]
    assert math["$p_t - p_0$, Pa"]
    assert math["the true $f_x$ crossed"]
    assert not math[r"costs \$5 and \$6"]


# -- the page --------------------------------------------------------------------------------------------------------


@settings(deadline=None, derandomize=True)
@given(text=HOSTILE)
def test_a_page_shows_hostile_text_as_it_is(text: str) -> None:
    html = page({"table1": Entry(text, {text: text}, {text: [text]}, text, details={text: text})}, {})
    assert all(map(is_seen, html))
    plain = page({"table1": Entry("", {"": ""}, {"": [""]}, "", details={"": ""})}, {})
    assert html.count("<") == plain.count("<")
