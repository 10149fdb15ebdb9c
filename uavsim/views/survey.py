"""A survey's folder: which places, with what error; the position error that the probe model reads; a map.

`survey.json` has all figures, `survey.csv` a row a place and role, `position_error.toml` is a scenario whose static
port has the position error of the place that is named, `position_error.csv` the same as a table over Mach number, angle
of attack and sideslip, `map.png` the places on the aircraft's outline,
`pressures.png` the pressure along fuselage and wing in the published case. Written under another name and renamed when
it is whole.
"""

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uavsim import airdata
from uavsim.files import whole, write_json, write_toml
from uavsim.studies.survey import Survey, box, choose
from uavsim.studies.survey.paper_case import curves
from uavsim.studies.survey.ranking import EQUAL, Rank, pair_error
from uavsim.views.figure import BLACK, BLUE, DARK, GREY, LIGHT, RED, SMALL, dress, label, literal, sheet
from uavsim.views.figure import save as save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LISTED = 8  # places of each role that are printed, and the one named
COLUMNS = (
    "role", "rank", "rank_raw", "place", "part", "kind", "x", "y", "z", "share_mean", "share_least", "share_most",
    "rms_raw", "rms_calibrated", "rms_calibrated_angles", "rms_worst_phase", "available", "share_per_mm", "caveat",
)  # fmt: skip


def save(found: Survey, folder: Path, *, plots: bool) -> None:
    """Write a survey.

    Parameters
    ----------
    found
        The survey.
    folder
        One that is there, see `uavsim.folders`.
    plots
        Draw the map.
    """
    write_json(folder / "survey.json", summary(found))
    _write_rows(folder / "survey.csv", [COLUMNS, *_rows(found)])
    write_toml(folder / "position_error.toml", position_error(found))
    _write_rows(folder / "position_error.csv", _table(found))
    if plots:
        save_map(found, folder / "map.png")
        save_pressures(found, folder / "pressures.png")


def summary(found: Survey) -> dict[str, Any]:
    """Return what `survey.json` holds."""
    e = found.envelope
    total, static = choose(found.total), choose(found.static)
    raw, calibrated = pair_error(total.place, static.place, e)
    return {
        "aircraft": found.outline.name,
        "section_speed": found.source,
        "envelope": {
            "flights": list(e.source), "rows": int(e.mach.size),
            "alpha_deg": [math.degrees(v) for v in e.range("alpha")],
            "beta_deg": [math.degrees(v) for v in e.range("beta")],
            "mach": list(e.range("mach")), "airspeed": list(e.range("airspeed")),
            "wing_out": float(e.weight[e.wing_out].sum()),
        },
        "named": {
            "total": _rank(total), "static": _rank(static),
            "total_hole": _hole(found.total), "static_hole": _hole(found.static),
            "pair": {"rms_raw": raw, "rms_calibrated": calibrated},
        },
        "position_error": {
            **_coefficients(found), "largest_difference": found.polynomial_error, "scenario": "position_error.toml",
            "table": "position_error.csv",
        },
        "total": [_rank(each) for each in found.total],
        "static": [_rank(each) for each in found.static],
        "neuralfoil_minus_panels": None
        if found.cross_check is None
        else {f"{place:+g}": value for place, value in found.cross_check.items()},
        "paper_case": {**found.paper, "over_the_flights": _over_the_flights(found)},
    }  # fmt: skip


def _hole(ranks: list[Rank]) -> dict[str, Any] | None:
    """Return the best place flush with the surface, None if there is none."""
    return _rank(choose(ranks, "hole")) if any(each.place.kind == "hole" for each in ranks) else None


def _rank(each: Rank) -> dict[str, Any]:
    return dict(zip(COLUMNS[3:], _cells(each), strict=True))


def _cells(each: Rank) -> list[Any]:
    place = each.place
    return [
        place.name, place.part, place.kind, *place.position, each.mean, each.least, each.most, each.raw,
        each.constant, each.angles, each.worst_phase, each.available, each.slope, place.caveat,
    ]  # fmt: skip


def _rows(found: Survey) -> list[list[Any]]:
    """Return the places by role and rank: calibrated once, and as they are."""
    rows = []
    for role, ranks in (("total", found.total), ("static", found.static)):
        raw = {id(each): k for k, each in enumerate(sorted(ranks, key=lambda each: each.raw), start=1)}
        for number, each in enumerate(ranks, start=1):
            rows.append([role, number, raw[id(each)], *("" if cell is None else cell for cell in _cells(each))])
    return rows


def _coefficients(found: Survey) -> dict[str, float]:
    names = ("error", "error_alpha", "error_alpha2", "error_beta2", "error_mach2")
    return {name: term[0] for name, term in zip(names, found.polynomial.terms, strict=True)}


def position_error(found: Survey) -> dict[str, Any]:
    """Return a scenario whose head has the ports that are named: what the probe model reads."""
    static = choose(found.static)
    return {
        "description": f"{found.outline.name} with its static port at: {static.place.name}",
        "air_data": {"total_port": {"probe": "plain"}, "static_port": _coefficients(found)},
    }


def _table(found: Survey) -> list[list[Any]]:
    """Shares of both named places over a grid: mach, alpha, beta, total, static."""
    total, static = choose(found.total).place, choose(found.static).place
    alpha, beta, mach = box(found.envelope)
    m, a, b = (grid.ravel() for grid in np.meshgrid(mach, alpha, beta, indexing="ij"))
    columns = (m, a, b, total.share(a, b, m), static.share(a, b, m))
    rows = [[float(f"{value:.9g}") for value in row] for row in zip(*columns, strict=True)]
    return [["mach", "alpha", "beta", "total_share", "static_share"], *rows]


def _write_rows(path: Path, rows: Any) -> None:
    with whole(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


# -- what is printed


def lines(found: Survey) -> list[str]:
    """Return what the command prints: the named places and the best of each role."""
    e = found.envelope
    slow, fast = e.range("mach")
    alpha, beta = ([math.degrees(v) for v in e.range(name)] for name in ("alpha", "beta"))
    speed = (
        "NeuralFoil" if found.source == "neuralfoil" else "our vortex panels (NeuralFoil is not installed or not asked)"
    )
    said = [
        f"{found.outline.name}: {len(found.places)} places over {', '.join(e.source)}: alpha {alpha[0]:.1f} to "
        f"{alpha[1]:.1f}, beta {beta[0]:.1f} to {beta[1]:.1f} deg, Mach {slow:.3f} to {fast:.3f}",
        f"speed along wing sections: {speed}",
        "",
    ]
    caveats: dict[str, str] = {}
    for name, ranks in (("total pressure", found.total), ("static pressure", found.static)):
        said += [
            f"{name:<42}{'m/s rms raw':>12}{'calibrated':>12}{'in stream':>11}",
            *(_line(number, each, choose(ranks), caveats) for number, each in _listed(ranks)),
            "",
        ]
    said += [f"{letter}: {caveat}" for caveat, letter in caveats.items()]
    said += [
        "*: the port that is named: of the places in the stream all the time and without such a reason against them",
        f"   within {EQUAL:g} m/s of the least when calibrated, the one that is least off as it is",
        "",
    ]
    for role, ranks in (("total", found.total), ("static", found.static)):
        best, also = choose(ranks), ""
        if best.place.kind != "hole" and _hole(ranks) is not None:
            flush = choose(ranks, "hole")
            also = f"; flush with the surface: {flush.place.name}, {_figures(flush)}"
        said.append(f"{role} port: {best.place.name}, {_figures(best)}{also}")
    raw, calibrated = pair_error(choose(found.total).place, choose(found.static).place, e)
    said.append(f"both together: {raw:.2f} m/s rms, calibrated once {calibrated:.2f}")
    notes = [*found.paper["notes"], *_over_the_flights(found)]
    return [*said, "", "published case, Mach 0.6, alpha 1 deg:", *(f"  {note}" for note in notes)]


def _over_the_flights(found: Survey) -> list[str]:
    """What the flights make of the published places, windward front and leading edge: holes there, m/s rms."""
    holes = {each.place.part: each for each in reversed(found.total) if each.place.kind == "hole"}
    if "wing" not in holes:
        return []
    nose, wing = holes["nose"], holes["wing"]
    out = (
        "" if wing.available > 1.0 - 1e-9 else f", and it is in the stream in {100 * wing.available:.0f} % of the rows"
    )
    return [
        f"Over the flights a hole in the wing's leading edge costs {wing.raw:.2f} m/s rms at best{out}; one at the "
        f"nose's tip {nose.raw:.2f}, the tube named above {choose(found.total).raw:.2f}."
    ]


def _figures(each: Rank) -> str:
    return f"{each.raw:.2f} m/s rms, calibrated once {each.constant:.2f}"


def _listed(ranks: list[Rank]) -> list[tuple[int, Rank]]:
    """Return the best places with their rank, and the one that is named if it is not among them."""
    named = choose(ranks)
    return [(n, each) for n, each in enumerate(ranks, start=1) if n <= LISTED or each is named]


def _line(number: int, each: Rank, named: Rank, caveats: dict[str, str]) -> str:
    """Return a row; a reason against the place is a letter, which `caveats` keeps with the reason."""
    place = f"{number:>3} {each.place.name}"
    caveat = each.place.caveat
    letter = caveats.setdefault(caveat, "abcdefghijklmnopqrstuvwxyz"[len(caveats) % 26]) if caveat else ""
    mark = letter or ("*" if each is named else "")
    row = f"{place:<42}{each.raw:>12.3f}{each.constant:>12.3f}{100 * each.available:>10.0f}%"
    return f"{row} {mark}".rstrip()


# -- figures


def save_pressures(found: Survey, path: Path) -> None:
    """Draw Cp along fuselage and wing at Mach 0.6 and 1 degree, with the stagnation and the critical value."""
    figure, grid = sheet(
        f"Surface pressure at Mach 0.6, angle of attack 1 degree: {found.outline.name}",
        "Cp upwards is suction.  The published case (its Table 6) on this aircraft; beside the wing the fuselage is "
        "not computed",
        (1.0,), (1.0, 1.0), size=(11.5, 5.6), right=0.4, share=False, gap=(0.1, 0.2),
    )  # fmt: skip
    colours = {"top": BLUE, "side": GREY, "bottom": RED, "upper side": BLUE, "lower side": RED}
    for axes, part in zip(grid[0], ("fuselage", "wing"), strict=True):
        for curve in (each for each in curves(found.outline, found.source) if each.part == part):
            x, cp = np.array(curve.x), np.array(curve.cp)
            far = 0.5 * found.outline.wing.root_chord if part == "fuselage" else 1.0
            gaps = np.flatnonzero(np.diff(x) > far) + 1
            x, cp = (np.insert(column, gaps, np.nan) for column in (x, cp))
            colour = next(colours[key] for key in colours if curve.name.startswith(key))
            dashed = "--" if "90 %" in curve.name else "-"
            axes.plot(x, cp, color=colour, linestyle=dashed, linewidth=1.3, label=curve.name)
        for value, name in (("stagnation", "stagnation"), ("critical_cp", "sonic")):
            level = airdata.impact_over_dynamic(0.6) if value == "stagnation" else found.paper[value]
            axes.axhline(level, color=DARK, linewidth=0.8, linestyle=":")
            axes.annotate(name, (1.0, level), xycoords=("axes fraction", "data"), xytext=(-3, 3), ha="right",
                          textcoords="offset points", fontsize=SMALL, color=DARK)  # fmt: skip
        axes.set_ylim(1.25, -1.6)
        axes.margins(x=0.02)
        label(axes, "Cp", "x, aft of the nose, m" if part == "fuselage" else "x/c")
        axes.legend(fontsize=SMALL, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 0.1))
    save_figure(figure, path)


def save_map(found: Survey, path: Path) -> None:
    """Draw the places on the aircraft's outline from above and from the side, coloured by their airspeed error."""
    from matplotlib.colors import LogNorm

    e = found.envelope
    title = f"Where to mount the head: {found.outline.name}"
    subtitle = (
        "Airspeed error, m/s rms, calibrated once, over "
        f"{', '.join(map(literal, e.source))}.  Triangles: total, circles: static; hollow: not in the stream all the "
        "time, or another reason against it"
    )
    figure, grid = sheet(title, subtitle, (2.75, 1.0), size=(11.9, 10.6), right=0.8, share=False, gap=(0.16, 0.1))
    norm, shown = LogNorm(0.01, 5.0), None
    for axes, side in ((grid[0][0], False), (grid[1][0], True)):
        _outline(axes, found, side=side)
        for ranks, marker, size in ((found.static, "o", 26.0), (found.total, "^", 52.0)):
            shown = _dots(axes, ranks, marker, size, norm, side=side)
        for role, ranks, colour in (("total", found.total, RED), ("static", found.static, BLUE)):
            _point_out(axes, choose(ranks), role, colour, side=side)
        axes.set_aspect("equal")
        dress(axes)
        axes.margins(0.04)
        if not side:
            axes.set_ylim(-0.35 * found.outline.wing.tip, 1.05 * found.outline.wing.tip)
        label(axes, "z, up, m" if side else "y, right, m", "x, aft of the nose, m")
    assert shown is not None
    bar = figure.colorbar(shown, ax=[row[0] for row in grid], fraction=0.03, pad=0.02)
    bar.set_label("m/s rms, calibrated once", fontsize=SMALL)
    bar.ax.tick_params(labelsize=SMALL)
    save_figure(figure, path)


def _dots(axes: "Axes", ranks: list[Rank], marker: str, size: float, norm: Any, *, side: bool) -> Any:
    """Draw the places of a role, the worst first, so that the best is on top."""
    shown = None
    for sound in (False, True):
        drawn = [each for each in reversed(ranks) if each.sound is sound]
        x = [each.place.position[0] for each in drawn]
        y = [each.place.position[2 if side else 1] for each in drawn]
        errors = [max(each.constant, 1e-4) for each in drawn]
        if sound:
            shown = axes.scatter(
                x,
                y,
                c=errors,
                norm=norm,
                cmap="viridis_r",
                marker=marker,
                s=size,
                edgecolors=BLACK,
                linewidths=0.5,
                zorder=5,
            )
        else:
            hollow = axes.scatter(x, y, marker=marker, s=0.7 * size, facecolors="white", linewidths=1.2, zorder=4)
            from matplotlib import colormaps

            hollow.set_edgecolor(colormaps["viridis_r"](norm(np.array(errors))))
    return shown


def _point_out(axes: "Axes", each: Rank, role: str, colour: str, *, side: bool) -> None:
    """Name a place that is chosen."""
    at = each.place.position[0], each.place.position[2 if side else 1]
    up = 52.0 if role == "total" else -34.0 if side else -48.0
    right = -20.0 if side and role == "static" else 10.0
    axes.annotate(
        f"{role}: {each.place.name}", at, xytext=(right, up), textcoords="offset points",
        fontsize=SMALL, color=colour, arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8}, zorder=6,
    )  # fmt: skip


def _outline(axes: "Axes", found: Survey, *, side: bool) -> None:
    """Draw the aircraft from above or from its right."""
    o = found.outline
    x = np.linspace(o.stations[0], o.stations[-1], 200)
    r = np.array([o.radius(float(each)) for each in x])
    axes.fill_between(x, -r, r, facecolor=LIGHT, edgecolor=GREY, linewidth=0.8, zorder=1)
    if side:
        if o.fin is not None:
            _panel(axes, o.fin, 1.0)
        for surface in (o.wing, o.tail):
            if surface is not None:
                ends = (
                    surface.leading_edge(surface.root),
                    surface.leading_edge(surface.root) + surface.chord(surface.root),
                )
                axes.plot(ends, (surface.z, surface.z), color=DARK, linewidth=1.5, zorder=2)
        return
    for surface in (o.wing, o.tail):
        if surface is not None:
            for sign in (1.0, -1.0):
                _panel(axes, surface, sign)


def _panel(axes: "Axes", surface: Any, sign: float) -> None:
    corners = [
        (surface.leading_edge(y) + share * surface.chord(y), sign * y)
        for y, share in ((surface.root, 0.0), (surface.tip, 0.0), (surface.tip, 1.0), (surface.root, 1.0))
    ]
    axes.fill(*zip(*corners, strict=True), facecolor="#eeeeee", edgecolor=GREY, linewidth=0.8, zorder=1)
