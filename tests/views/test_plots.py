"""Plots of flights: drawn for whatever a record holds, readable, equal for equal flights."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

import uavsim
from uavsim.flight import UNITS, Flight
from uavsim.judged import Judged
from uavsim.onboard.launch import DetectorSettings, build
from uavsim.scenario import Scenario
from uavsim.score import score
from uavsim.studies.batch import Batch
from uavsim.studies.campaign.flown import ErrorTrace, row_of
from uavsim.truth import STANDARD_GRAVITY
from uavsim.views import launch, plots, pressure, track, trajectory
from uavsim.views.curves import thin
from uavsim.views.figure import BLUE, PHASES, RED, make_room, sheet
from uavsim.views.marks import Mark, flags, stack
from uavsim.views.record import Record

RELEASE, END, PUSH = 2.0, 6.5, 76.0  # s, s, m/s^2 along the rail
ALL = ["launch.png", "pressure.png", "airspeed.png", "trajectory.png", "track.png"]


def made_up(*, push: float = PUSH, end: float = END, seed: int = 1) -> Flight:
    """Make a flight of constant push along a level rail, then constant speed; the detector is the real one."""
    scenario = Scenario(name="made up", seed=seed)
    stroke, noise = scenario.launcher.stroke, np.random.default_rng(seed)
    t = np.arange(0.0, end, 0.004)
    since = np.clip(t - RELEASE, 0.0, np.sqrt(2.0 * stroke / push))
    gone, speed = 0.5 * push * since**2, push * since
    free = gone >= stroke
    truth = {name: np.zeros(t.size) for name in UNITS["truth"] if name != "phase"}
    truth |= {"t": t, "airspeed": speed, "vn": speed, "rail_s": gone}
    truth["north"] = gone + np.where(free, speed * (t - t[np.argmax(free)]), 0.0) if free.any() else gone
    truth["altitude"] = 1.5 + 0.1 * truth["north"]
    truth["p_static"] = 101325.0 - 12.0 * truth["altitude"]
    truth["p_total"] = truth["p_static"] + 0.6 * speed**2
    truth["fx"] = np.where((since > 0.0) & ~free, push, 0.0)
    truth["fz"] = np.full(t.size, -STANDARD_GRAVITY)
    out = RELEASE + 0.8
    truth["wing"] = np.clip((t - out) / 0.2, 0.0, 1.0)
    at = np.arange(0.001, end, 0.0012)
    felt = {axis: np.interp(at, t, truth[axis]) + noise.normal(0.0, 1.0, at.size) for axis in ("fx", "fy", "fz")}
    accelerometer = pd.DataFrame({"t": at, **felt})
    detector, rows = build(DetectorSettings(), 1.0 / 0.0012), []
    for row in accelerometer.itertuples(index=False):
        seen = detector.step(*row)
        if row.t > RELEASE - 1.0:
            rows.append((row.t, detector.level, detector.count, detector.total, detector.triggered, seen))
    table = pd.DataFrame(rows, columns=list(UNITS["detector"]))
    events = [{"t": float(when), "event": "launch_detected"} for when in table["t"][table["recognised"]]]
    if events:
        events += [{"t": out, "event": "wings_commanded"}, {"t": out + 0.3, "event": "motor_on"}]
    polled = np.arange(0.005, end, 0.01)
    air = {
        name: np.interp(polled, t, truth[name]) + noise.normal(0.0, 3.0, polled.size)
        for name in ("p_total", "p_static")
    }
    air_data = pd.DataFrame({"t": polled, **air, "temperature": 288.15, "t_total": polled, "t_static": polled})
    true_speed = np.interp(polled, t, speed)
    estimate = pd.DataFrame(
        {
            "t": polled,
            "airspeed": true_speed + noise.normal(0.0, 0.1, polled.size),
            "airspeed_sd": 0.1,
            "airspeed_raw": true_speed + noise.normal(0.0, 0.2, polled.size),
            **air,
            "valid": true_speed > 5.0,
            "nis_total": np.ones_like(true_speed),
            "nis_static": np.ones_like(true_speed),
        }
    )
    tables = {"accelerometer": accelerometer, "air_data": air_data, "estimate": estimate, "detector": table}
    judged = Judged(scenario, {"truth": truth, **tables}, events, RELEASE, "completed", {})
    phases = pd.DataFrame({**truth, "phase": judged.phases()})
    return Flight(scenario.to_dict(), {"truth": phases, **tables}, events, score(judged))


def without(flight: Flight, *tables: str) -> Flight:
    """Make the recording of a flight that lacks some tables, and with them every figure that needs the truth."""
    rest = {name: table for name, table in flight.tables.items() if name not in tables}
    return Flight(flight.scenario, rest, flight.events, {"launch": {"release_time": None}})


def blank(flight: Flight) -> Flight:
    """Make a flight whose readings and estimates are all missing."""
    tables = dict(flight.tables)
    for name in ("accelerometer", "air_data", "estimate"):
        tables[name] = tables[name].assign(**{c: np.nan for c in tables[name] if c not in ("t", "valid")})
    return Flight(flight.scenario, tables, flight.events, flight.score)


@pytest.fixture(scope="module")
def flight() -> Flight:
    return made_up()


def check_png(path: Path) -> None:
    """Check that a file is a PNG of a sensible size with something drawn on it."""
    with Image.open(path) as image:
        assert image.format == "PNG"
        assert "Software" not in image.info
        width, height = image.size
        pixels = np.asarray(image.convert("L"))
    assert 900 <= width <= 2000
    assert 250 <= height <= 1500
    inked = float((pixels < 250).mean())
    assert 0.02 < inked < 0.9


CASES: dict[str, tuple[Callable[[Flight], Flight], list[str]]] = {
    "complete": (lambda flight: flight, ALL),
    "missed": (lambda _: made_up(push=36.0), ALL),
    "no truth": (lambda flight: without(flight, "truth"), ALL[:3]),
    "accelerometer alone": (lambda flight: without(flight, "truth", "air_data", "estimate", "detector"), ALL[:1]),
    "nothing but NaN, ended on the rail": (lambda _: blank(made_up(end=RELEASE + 0.2)), ALL),
}


@pytest.mark.parametrize("case", CASES)
def test_each_plot_that_has_data_is_drawn(case: str, flight: Flight, tmp_path: Path) -> None:
    change, expected = CASES[case]
    written = plots.save_plots(change(flight), tmp_path / "new" / "plots")
    assert [path.name for path in written] == expected
    assert sorted(path.name for path in (tmp_path / "new" / "plots").iterdir()) == sorted(expected)
    for path in written:
        check_png(path)


def test_the_made_up_flights_are_what_they_stand_for(flight: Flight) -> None:
    assert flight.score["launch"]["detected_time"] is not None
    assert flight.score["airspeed"]["cruise"]["samples"] > 0
    assert made_up(push=36.0).score["outcome"] == "missed_launch"
    assert made_up(end=RELEASE + 0.2).score["flight"]["rail_exit_time"] is None


def test_without_truth_the_launch_is_the_detection_that_the_stroke_confirmed(flight: Flight) -> None:
    knock = [{"t": 1.5, "event": "launch_detected"}, {"t": 1.6, "event": "not_a_launch"}]
    recorded = without(flight, "truth")
    detected = flight.score["launch"]["detected_time"]
    events = [*knock, *recorded.events, {"t": detected + 0.4, "event": "stroke_end"}]
    record = Record(Flight(recorded.scenario, recorded.tables, events, recorded.score))
    assert record.start == detected
    assert record.launch == pytest.approx((detected - 0.2, detected + 0.8))
    assert [mark.label for mark in record.milestones] == ["detected", "stroke end noticed", "wings commanded"]
    assert [mark.t for mark in record.named("false detection")] == [1.5]


def test_equal_flights_give_equal_files_and_nothing_is_left_behind(flight: Flight, tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    for name in ("a", "b"):
        plots.save_plots(without(flight, "truth", "air_data", "estimate"), tmp_path / name)
    assert (tmp_path / "a" / "launch.png").read_bytes() == (tmp_path / "b" / "launch.png").read_bytes()
    assert dict(matplotlib.rcParams) == before


def test_thinning_keeps_extremes_and_ends() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(30_000) * 1e-3
    y = rng.normal(size=t.size)
    y[12_345], y[23_456] = 40.0, -40.0
    y[100:160] = np.nan
    few_t, few = thin(t, y, 2000)
    assert few_t.size < 4000
    assert np.all(np.diff(few_t) > 0.0)
    assert (few_t[0], few_t[-1]) == (t[0], t[-1])
    assert few_t[np.nanargmax(few)] == t[12_345]
    assert few_t[np.nanargmin(few)] == t[23_456]
    # every block's range is kept: the greatest of any stretch of two blocks is among the points drawn
    for start in range(0, t.size - 60, 1000):
        inside = (few_t >= t[start]) & (few_t <= t[start + 59])
        assert np.nanmax(few[inside]) >= np.nanmax(y[start + 15 : start + 45])


def test_labels_of_marks_never_cover_each_other_nor_cross_a_line() -> None:
    figure, ((axes,),) = sheet("title", "subtitle", (1.0,))
    axes.set_xlim(0.0, 10.0)
    rng = np.random.default_rng(5)
    marks = [Mark(float(t), "mark " * int(n)) for t, n in rng.uniform((-1.0, 1.0), (11.0, 4.0), (25, 2))]
    placed = stack(axes, marks)
    assert {mark.t for mark, _, _ in placed} == {mark.t for mark in marks if 0.0 <= mark.t <= 10.0}
    make_room(figure, 1 + max(line for _, _, line in placed))
    flags([axes], placed)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in axes.texts]
    lines = [x for _, x, _ in placed]
    for i, (box, (_, x, line)) in enumerate(zip(boxes, placed, strict=True)):
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])
        low, high = (axes.transData.inverted().transform((edge, 0.0))[0] for edge in (box.x0, box.x1))
        crossing = [
            other for other, (_, _, top) in zip(lines, placed, strict=True) if low < other < high and top >= line
        ]
        assert crossing in ([], [x])


def test_height_is_exaggerated_by_as_much_as_is_said(flight: Flight) -> None:
    figure = trajectory.draw(Record(flight))
    assert figure is not None
    for axes in figure.axes[:2]:
        words = axes.get_title(loc="right")
        factor = 1.0 if words == "true aspect" else float(words.split()[-1].removesuffix("×"))
        box = axes.get_window_extent()
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        assert (box.height / (top - bottom)) / (box.width / (right - left)) == pytest.approx(factor, rel=1e-6)
        shown = [y for x, y in zip(*path(axes), strict=True) if left <= x <= right]
        assert bottom < 0.0 < max(shown) < top


@pytest.mark.parametrize(
    ("outcome", "marked"), [("cruise", []), ("landed", ["end (landed)"]), ("crashed", ["end (crashed)"])]
)
def test_where_a_flight_touched_the_ground_is_marked(flight: Flight, outcome: str, marked: list[str]) -> None:
    figure = trajectory.draw(Record(dataclasses.replace(flight, score={**flight.score, "outcome": outcome})))
    assert figure is not None
    ends = [line for line in figure.axes[0].lines if str(line.get_label()).startswith("end (")]
    assert [line.get_label() for line in ends] == marked
    assert {line.get_color() for line in ends} <= {BLUE if outcome == "landed" else RED}


def path(axes: Axes) -> tuple[list[float], list[float]]:
    """Return the points of the trajectory."""
    pairs = [line.get_data() for line in axes.lines if line.get_label() in ("rail", *PHASES)]
    return [float(x) for pair in pairs for x in pair[0]], [float(y) for pair in pairs for y in pair[1]]


def test_the_ground_track_is_to_scale_and_shows_the_whole_way(flight: Flight) -> None:
    """An aircraft that drifts 60 m to the east of north, in a wind from the west: the way, the rail, the arrow."""
    n = len(flight.truth)
    way = {
        "north": np.linspace(0.0, 300.0, n),
        "east": np.linspace(0.0, 60.0, n),
        "mean_wind_e": 5.0,
        "mean_wind_n": 0.0,
    }
    tables = {**flight.tables, "truth": flight.truth.assign(**way)}
    figure = track.draw(Record(dataclasses.replace(flight, tables=tables)))
    assert figure is not None
    (axes,) = figure.axes
    x, y = path(axes)
    assert (max(x), max(y)) == pytest.approx((60.0, 300.0), rel=0.01)
    (left, right), (bottom, top), box = axes.get_xlim(), axes.get_ylim(), axes.get_window_extent()
    assert left < min(x) < max(x) < right
    assert bottom < min(y) < max(y) < top
    assert (box.height / (top - bottom)) / (box.width / (right - left)) == pytest.approx(1.0)
    assert "mean wind 5.0 m/s" in [text.get_text() for text in axes.texts]


def test_readings_and_truth_are_drawn_where_they_are(flight: Flight) -> None:
    """The curves are the tables' numbers, in the units that the axes name."""
    figure = launch.draw(Record(flight))
    assert figure is not None
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    x, y = (np.asarray(values, float) for values in lines["$f_x$ measured"].get_data())
    start = flight.score["launch"]["true_time"]
    at = np.searchsorted(flight.accelerometer["t"], start + 1e-3 * x[10] - 1e-9)
    assert y[10] * STANDARD_GRAVITY == pytest.approx(flight.accelerometer["fx"].iloc[at])
    assert lines["c = 4.50 g"].get_ydata()[0] == pytest.approx(4.5, abs=1e-3)
    marks = {text.get_text(): text for text in figure.axes[0].texts}
    assert {"release", "true launch", "true 4.5 g", "detected", "rail exit"} <= marks.keys()


# -- several flights -------------------------------------------------------------------------------------------------


def batch_of(flights: list[Flight], *, complete: bool = True) -> Batch:
    """Gather flights as `fly_seeds` does."""
    rows = [row_of(f, index=f.score["seed"], columns={}) for f in flights]
    rng = np.random.default_rng(7)
    traces = [
        ErrorTrace(f.score["seed"], 0.1 * rng.random(40), 0.2 * rng.random(40), rng.chisquare(1, 40)) for f in flights
    ]
    kept = {flights[0].score["seed"]: flights[0]}
    return Batch(Scenario(name="made up"), pd.DataFrame(rows), traces, kept, complete, 1.5)


@pytest.fixture(scope="module")
def several(flight: Flight) -> Batch:
    return batch_of([flight, made_up(seed=2), made_up(push=36.0, seed=3)])


def test_faults_and_what_was_noticed_of_them_are_marked() -> None:
    """Of both, from the scenario and from on board, and no mark for a fault that begins after the end."""
    faults = 'air_data.total_port.faults=[{kind="blocked",start=6,stop=9},{kind="ice",start=300}]'
    flight = uavsim.fly("catapult", overrides=["duration=12", faults])
    record = Record(flight)
    marks = {mark.label: mark.t for mark in record.milestones}
    assert marks["total port blocked"] == 6.0
    assert marks["end of blockage"] == 9.0
    assert marks["total flagged"] == next(e["t"] for e in flight.events if e["event"] == "airspeed_fault")
    assert not any("icing" in name for name in marks)
    assert {mark.label for mark in record.milestones} - {mark.label for mark in record.marks} == set()


@pytest.mark.parametrize(("tare", "words"), [("covered", "filtered (tared)"), ("none", "filtered")])
def test_the_pressure_figure_says_tared_only_of_what_is(flight: Flight, tare: str, words: str) -> None:
    scenario = {**flight.scenario, "air_data": {**flight.scenario["air_data"], "tare": tare}}
    figure = pressure.draw(Record(dataclasses.replace(flight, scenario=scenario)))
    assert figure is not None
    labels = {str(line.get_label()) for line in figure.axes[0].lines}
    assert words in labels
    assert len({name for name in labels if name.startswith("filtered")}) == 1
    notes = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any("cover" in text for text in notes) is (tare == "covered")


def test_a_prescribed_course_has_a_way_and_a_track() -> None:
    flown = uavsim.fly("manoeuvres", seed=2, overrides=["duration=7"])
    for view in (trajectory, track):
        figure = view.draw(Record(flown))
        assert figure is not None
        assert "course" in {str(line.get_label()) for line in figure.axes[0].lines}


def test_the_labels_of_many_faults_stay_out_of_the_path_above(flight: Flight) -> None:
    """The trajectory has room for six lines of labels; all the marks are in the other figures."""
    kinds = enumerate(("blocked", "leak", "ice", "water"))
    faults = [{"kind": kind, "start": 2.5 + 0.5 * i, "stop": 2.7 + 0.5 * i} for i, kind in kinds]
    ports = {name: {**flight.scenario["air_data"][name], "faults": faults} for name in ("total_port", "static_port")}
    scenario = {**flight.scenario, "air_data": {**flight.scenario["air_data"], **ports}}
    found = {"t": 4.0, "event": "airspeed_fault", "channel": "total", "kind": "frozen"}
    figure = trajectory.draw(Record(dataclasses.replace(flight, scenario=scenario, events=[*flight.events, found])))
    assert figure is not None
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # which puts the axes' names in place
    renderer = canvas.get_renderer()
    path, angle = figure.axes[0], max(figure.axes, key=lambda axes: len(axes.texts))
    drawn = {text.get_text(): text.get_window_extent(renderer) for text in angle.texts}
    assert "total flagged" in drawn
    assert max(box.y1 for box in drawn.values()) < path.xaxis.label.get_window_extent(renderer).y0 + 1.0


def test_a_flight_that_diverged_before_its_first_row_draws_no_empty_panels(tmp_path: Path) -> None:
    """A wing that JSBSim cannot fly: two rows of truth, neither of them a number."""
    vast = "aircraft.properties.metrics/Sw-sqft=1e9"
    flight = uavsim.fly("catapult", seed=1, overrides=["duration=5", vast])
    assert flight.score["outcome"] == "diverged"
    assert plots.save_plots(flight, tmp_path) == []


@pytest.mark.parametrize(
    ("kind", "levels"),
    [
        ("multi-level-window", {"$G_1$ = $G_2$": 4.6}),
        ("sliding-window", {"level": 4.6}),
        ("adaptive-cusum", {"c": 4.5}),
        ("cusum", {"c": 4.5}),
        ("px4", {}),
    ],
)
def test_the_launch_figure_draws_the_levels_that_the_kind_reads(kind: str, levels: dict[str, float]) -> None:
    from uavsim.views import launch
    from uavsim.views.record import Record

    flight = uavsim.fly("catapult", overrides=[f"detector.kind={kind}", "duration=6"])
    assert launch.levels(Record(flight)) == pytest.approx(levels, abs=0.01)


@pytest.mark.parametrize("kind", ["adaptive-cusum", "cusum", "single-threshold"])
def test_the_launch_figure_draws_what_passes_its_limit(kind: str) -> None:
    """The state that is found again from the readings passes the limit at the sample that the flight recognised."""
    from uavsim.views import launch
    from uavsim.views.record import Record

    flight = uavsim.fly("catapult", overrides=[f"detector.kind={kind}", "duration=6"])
    figure = launch.draw(Record(flight))
    assert figure is not None
    lines = {str(line.get_label()): line for line in figure.axes[4].lines}
    value = next(np.asarray(line.get_ydata(), float) for name, line in lines.items() if name in ("sum S", "time held"))
    limit = next(
        np.asarray(line.get_ydata(), float) for name, line in lines.items() if name.startswith(("lim", "time t"))
    )
    ((x,), (y,)) = (np.asarray(values, float) for values in lines["recognised"].get_data())
    launch_score = flight.score["launch"]
    assert x == pytest.approx(1e3 * launch_score["latency"], abs=1e-6)
    last = int(np.flatnonzero(np.isfinite(value))[-1])
    assert value[last] == y >= limit[last] * (1.0 - 1e-5)
    assert np.all(value[:last] < limit[:last])
    assert np.isnan(value[last + 1 :]).all()


def test_an_angle_of_attack_without_air_from_ahead_is_not_drawn() -> None:
    """On the rail in a crosswind it is anything from −180° to 180°, and would set the scale of the whole flight."""
    flight = uavsim.fly("crosswind", seed=1, overrides=["duration=7"])
    waiting = flight.truth["t"] < 3.0
    assert np.degrees(flight.truth["alpha"][waiting]).abs().max() > 90.0
    figure = trajectory.draw(Record(flight))
    assert figure is not None
    drawn = [line for axes in figure.axes for line in axes.lines if line.get_label() == "angle of attack"]
    assert drawn
    assert max(np.nanmax(np.abs(line.get_ydata())) for line in drawn) < 60.0
