"""Figures of a part on the bench: what they show, that nothing covers anything, and the numbers beside them."""

import json
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from sensors import record_at_rest
from sensors.bench import columns_of, on_bench
from sensors.bench_log import read_bench_log
from uavsim.studies.sensor_bench import Bench, check_hours, put_on_bench, read_log
from uavsim.views import characterisation as view

PARTS = {"adxl345": ("fx", "fy", "fz"), "bmp390": ("pressure",)}


def on_the_bench(name: str, folder: Path | None = None, **settings: object) -> Bench:
    """Put a part on the bench for three minutes, with a log of another unit of it if there is a folder for that."""
    part = on_bench(name, **settings)  # type: ignore[arg-type]  # of either kind
    log = None
    if folder is not None:
        path = folder / "a-log-with-a-name-that-is-rather-long-for-a-legend.csv"
        record_at_rest(name, duration=120.0, seed=7).to_csv(path, index=False)
        log = read_bench_log(path, columns_of(part)[:2] if "bmp" in name else columns_of(part))
    return put_on_bench(part, hours=0.05, seed=1, log=log)


@pytest.fixture(scope="module", params=[(name, log) for name in PARTS for log in (False, True)], ids=str)
def bench(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Bench:
    name, log = request.param
    return on_the_bench(name, tmp_path_factory.mktemp("log") if log else None)


def curve(axes: Axes, name: str) -> tuple[np.ndarray, np.ndarray]:
    (line,) = [line for line in axes.lines if line.get_label() == name]
    x, y = line.get_data()
    return np.asarray(x), np.asarray(y)


def test_figures_and_numbers_are_written(bench: Bench, tmp_path: Path) -> None:
    view.save_bench(bench, tmp_path, plots=True)
    written = sorted(tmp_path.iterdir())
    assert [path.name for path in written] == ["allan.png", "bench.json", "histogram.png", "psd.png"]
    for path in written:
        if path.suffix == ".png":
            with Image.open(path) as image:
                assert "Software" not in image.info
                assert 900 <= image.width <= 2000
                inked = float((np.asarray(image.convert("L")) < 250).mean())
            assert 0.02 < inked < 0.9
    (tmp_path / "bare").mkdir()
    view.save_bench(bench, tmp_path / "bare", plots=False)
    assert [path.name for path in (tmp_path / "bare").iterdir()] == ["bench.json"]


@pytest.mark.parametrize("draw", view.FIGURES.values(), ids=view.FIGURES)
def test_nothing_is_cut_off_or_covered(bench: Bench, draw: object) -> None:
    """All words are on the sheet, and no two of the same sheet overlap."""
    assert callable(draw)
    figure = draw(bench)
    FigureCanvasAgg(figure).draw()
    words = [*figure.texts]
    for axes in figure.axes:
        words += [axes.title, axes.xaxis.label, axes.yaxis.label]
        legend = axes.get_legend()
        words += legend.get_texts() if legend is not None else []
    boxes = [(text.get_text(), text.get_window_extent()) for text in words if text.get_text()]
    assert len(boxes) >= 6
    for text, box in boxes:
        assert box.x0 >= 0.0, text
        assert box.y0 >= 0.0, text
        assert box.x1 <= figure.bbox.width, text
        assert box.y1 <= figure.bbox.height, text
    for i, (text, box) in enumerate(boxes):
        covered = [other for other, its in boxes[i + 1 :] if box.overlaps(its)]
        assert not covered, (text, covered)


def test_allan_deviation_is_drawn_where_it_is(bench: Bench) -> None:
    figure = view.allan(bench)
    channels = PARTS[bench.description.name]
    assert [axes.get_title() for axes in figure.axes] == list(channels)
    for i, axes in enumerate(figure.axes):
        found = bench.simulated[i].allan
        tau, deviation = curve(axes, "simulated")
        assert np.array_equal(tau, found.tau)
        assert np.array_equal(deviation, found.deviation)
        tau, promised = curve(axes, "promised: total")
        assert promised == pytest.approx(bench.promises[i].deviation(tau))
        terms = [line for line in axes.lines if str(line.get_label()).startswith("promised: ")]
        assert {"promised: white noise", "promised: total"} <= {line.get_label() for line in terms}
        low, high = axes.get_ylim()
        assert low < found.deviation.min()
        assert high > found.deviation.max()
        assert len(axes.collections) == 1 + len(bench.compared[:1])  # intervals
        unit = "Pa" if channels == ("pressure",) else "m/s²"
        assert axes.get_ylabel() == f"Allan deviation σ(τ) of {channels[i]}, {unit}"
        assert axes.get_xlabel() == "averaging time τ, s"
    assert "68 % intervals" in figure.texts[1].get_text()


def test_a_log_is_laid_over_in_every_figure(bench: Bench) -> None:
    assert (bench.log is not None) == bool(bench.compared)
    name = "…hat-is-rather-long-for-a-legend.csv"[-20:]
    for draw in (view.allan, view.psd):
        for i, axes in enumerate(draw(bench).axes):
            labels = [str(line.get_label()) for line in axes.lines]
            assert any(label.endswith(name[1:]) for label in labels) is bool(bench.compared)
            if bench.compared and draw is view.psd:
                x, y = curve(axes, labels[-1])
                assert np.array_equal(x, bench.compared[i].spectrum.frequency)
                assert np.array_equal(y, bench.compared[i].spectrum.density)


def test_density_and_histogram_have_their_promise(bench: Bench) -> None:
    for promise, axes in zip(bench.promises, view.psd(bench).axes, strict=True):
        f, promised = curve(axes, "promised")
        assert promised == pytest.approx(promise.density(f))
        assert f[-1] == pytest.approx(promise.rate / 2.0)
        _, level = curve(axes, "promised: n = √2 N")
        assert level == pytest.approx([2.0**0.5 * promise.N] * 2)
    for promise, axes in zip(bench.promises, view.histogram(bench).axes, strict=True):
        (line,) = axes.lines
        x, y = (np.asarray(values) for values in line.get_data())
        assert np.trapezoid(y, x) == pytest.approx(1.0, abs=1e-3)
        assert np.sqrt(np.trapezoid(y * x**2, x)) == pytest.approx(promise.noise_sd, rel=1e-2)


def test_a_low_pass_is_marked_at_its_frequency() -> None:
    filtered = on_the_bench("bmp390", iir=8)
    (axes,) = view.psd(filtered).axes
    x, _ = curve(axes, "promised: -3 dB")
    assert x == pytest.approx([filtered.promises[0].bandwidth] * 2)
    assert filtered.promises[0].bandwidth == pytest.approx(filtered.description.bandwidth)


def test_bins_of_coarse_readings_are_their_steps() -> None:
    """BMP390 x1: noise of 3.7 Pa in steps of 2.64 Pa."""
    part = on_the_bench("bmp390")
    (axes,) = view.histogram(part).axes
    assert "(bins are steps)" in axes.get_legend_handles_labels()[1][0]
    assert np.diff(part.simulated[0].histogram.edges) == pytest.approx(2.64)
    smooth = on_the_bench("bmp390", iir=32)
    (axes,) = view.histogram(smooth).axes
    assert "(bins are steps)" not in axes.get_legend_handles_labels()[1][0]


def test_a_record_that_does_not_move_is_drawn_all_the_same(tmp_path: Path) -> None:
    still = put_on_bench(on_bench("adxl345", noise_scale=0.0), hours=0.01, seed=1, unit="ideal")
    view.save_bench(still, tmp_path, plots=True)
    numbers = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))
    assert numbers["simulated"]["fx"]["fit"] is None


def test_equal_benches_give_equal_files_and_leave_nothing_behind(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        view.save_bench(on_the_bench("bmp390"), tmp_path / name, plots=True)
    for file in ("allan.png", "psd.png", "histogram.png", "bench.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
    assert dict(matplotlib.rcParams) == before


def test_numbers_are_what_was_found(bench: Bench) -> None:
    numbers = json.loads(json.dumps(view.numbers(bench), allow_nan=False))
    assert numbers["part"] == bench.description.name
    assert set(numbers["promised"]) == set(PARTS[bench.description.name])
    for found in bench.simulated:
        told = numbers["simulated"][found.channel]
        assert found.fit is not None
        assert told["fit"]["N"]["value"] == found.fit.N.value
        assert told["allan"]["tau"] == found.allan.tau.tolist()
    assert (numbers["compared"] is None) == (bench.log is None)


# -- the study behind them -------------------------------------------------------------------------------------------


def test_progress_rises_to_the_end() -> None:
    shares: list[float] = []
    put_on_bench(on_bench("lsm6dso32"), hours=0.2, seed=1, progress=shares.append)
    assert shares == sorted(shares)
    assert len(shares) > 3
    assert shares[-1] == pytest.approx(1.0, abs=1e-3)


def test_the_simulated_drift_has_the_promised_shape() -> None:
    for model, time in (("gauss-markov", 100.0), ("flicker", None)):
        part = on_bench("bmp390")
        drifting = part.scaled(1.0, type(part.errors)(drift_model=model))  # type: ignore[arg-type]
        found = put_on_bench(drifting, hours=0.05, seed=1)
        assert found.simulated[0].fit is not None
        assert found.simulated[0].fit.correlation_time == found.promises[0].correlation_time == time


@pytest.mark.parametrize("hours", [0.0, -3.0, float("nan"), float("inf"), 1e-5, 1001.0])
def test_impossible_hours_are_refused(hours: float) -> None:
    with pytest.raises(ValueError, match="give"):
        check_hours(on_bench("bmp390"), hours)


def test_a_log_is_read_by_the_parts_columns(tmp_path: Path) -> None:
    record = record_at_rest("bmp390", duration=20.0, seed=1)
    record.columns = ["t", "p hPa", "temperature"]
    record["p hPa"] /= 100.0
    record.to_csv(tmp_path / "log.csv", index=False)
    log = read_log(tmp_path / "log.csv", on_bench("bmp390"), "pressure=p hPa*100")
    assert log.columns == ("t", "pressure", "temperature")
    assert log.table[:, 1] == pytest.approx(100.0 * record["p hPa"].to_numpy())
