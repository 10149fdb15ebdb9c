"""Detectors, estimators and plants of one's own: they fly, are named, replay, fail with a reason, and are refused."""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import uavsim
from uavsim import plugins
from uavsim.flight import load
from uavsim.onboard.launch import DetectorSettings
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import PrescribedPlant
from uavsim.plugins import REGISTRIES, PluginError, find
from uavsim.scenario import Scenario, load_scenario
from uavsim.truth import OF_AIR

SHORT = ("duration=6", "launcher.wait_min=2.5", "launcher.wait_max=2.6", "expect=timeout")
PLUGIN = """
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

import uavsim
from uavsim.plugins import detector, estimator


@detector("held", level="f_x over level", unit="m/s²")
class Held:
    @dataclass(frozen=True)
    class Settings:
        level: Annotated[float, Interval(gt=0.0, le=500.0)] = 40.0
        hold: float = 0.010
        names: tuple[str, ...] = ()

    def __init__(self, rate, settings=Settings()):
        self.settings = settings
        self.reset()

    def reset(self):
        self.since, self.done = None, False

    def step(self, t, fx, fy, fz):
        self.level = fx - self.settings.level
        if self.level <= 0.0:
            self.since = None
        elif self.since is None:
            self.since = t
        if self.done or self.since is None or t - self.since < self.settings.hold:
            return False
        self.done = True
        return True


@estimator("bernoulli-alone")
class Alone(uavsim.onboard.airspeed.Estimator):
    def __init__(self, settings, knowledge, tare_window):
        self.sd = knowledge.total_sd

    def step(self, t, p_total, p_static, temperature, t_total, t_static):
        q = p_total - p_static
        if not q > 0.0:
            return float("nan"), float("nan"), False
        return (2.0 * q / 1.2) ** 0.5, 0.5, True
"""


@pytest.fixture(autouse=True)
def _forgotten() -> Iterator[None]:
    """Leave the registries as they were."""
    before = {what: list(registry) for what, registry in REGISTRIES.items()}
    loaded = dict(plugins._loaded)
    yield
    for what, registry in REGISTRIES.items():
        for name in [name for name in registry if name not in before[what]]:
            registry.remove(name)
    plugins._loaded.clear()
    plugins._loaded.update(loaded)
    for key in list(plugins._files):
        del plugins._files[key], sys.modules[key]


@pytest.fixture
def plugin(tmp_path: Path) -> Path:
    file = tmp_path / "mine.py"
    file.write_text(PLUGIN, encoding="utf-8")
    return file


def run(*arguments: object, cwd: Path | None = None) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "uavsim.cli", *map(str, arguments)]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=300, cwd=cwd)


def settings(*more: str) -> list[str]:
    return [part for change in (*SHORT, *more) for part in ("--set", change)]


# -- they fly --------------------------------------------------------------------------------------------------------


def test_a_detector_and_an_estimator_fly_are_named_and_replay_byte_for_byte(plugin: Path, tmp_path: Path) -> None:
    out, again = tmp_path / "out", tmp_path / "again"
    given = ("detector.kind=held", "detector.options.level=35", "estimator.kind=bernoulli-alone")
    flown = run("fly", "catapult", "--plugin", plugin, *settings(*given), "--no-plots", "--out", out)
    assert flown.returncode in (0, 1), flown.stderr
    flight = load(out)
    assert flight.score["launch"]["detector"] == "held"
    assert flight.score["airspeed"]["estimator"] == "bernoulli-alone"
    assert [(p["group"], p["name"], p["source"]) for p in flight.score["plugins"]] == [
        ("uavsim.detectors", "held", "mine.py"),
        ("uavsim.estimators", "bernoulli-alone", "mine.py"),
    ]
    assert len(flight.score["plugins"][0]["sha256"]) == 64
    assert flight.scenario["detector"]["options"] == {"level": 35.0, "hold": 0.010, "names": []}
    found = flight.detector
    assert found[["count", "total", "triggered"]].isna().all().all()  # it has none
    assert found["level"].max() > 0.0 > found["level"].min()
    assert found["recognised"].sum() == 1
    assert flight.score["launch"]["latency"] < 0.030

    refused = run("replay", out, "--out", again)
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1
    assert "'held' is not registered here; it was flown with 'held' of mine.py (SHA-256" in refused.stderr
    assert not again.exists()
    replayed = run("replay", out, "--plugin", plugin, "--no-plots", "--out", again)
    assert replayed.returncode == 0, replayed.stderr
    for name in ("estimate.parquet", "detector.parquet", "events.json"):
        assert (again / name).read_bytes() == (out / name).read_bytes()


def test_another_version_of_the_file_does_not_replay(plugin: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run("fly", "catapult", "--plugin", plugin, *settings("detector.kind=held"), "--no-plots", "--out", out)
    plugin.write_text(PLUGIN + "\n# better\n", encoding="utf-8")
    refused = run("replay", out, "--plugin", plugin)
    assert refused.returncode == 2
    assert "was flown with 'held' of mine.py (SHA-256" in refused.stderr
    assert "and here is 'held' of mine.py (SHA-256" in refused.stderr


def test_several_seeds_fly_in_processes_of_their_own(plugin: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    flown = run(
        "fly", "catapult", "--plugin", plugin.name, *settings("detector.kind=held"), "--seeds", "1-3", "--no-plots",
        "--out", out, cwd=tmp_path,
    )  # fmt: skip
    assert flown.returncode in (0, 1), flown.stderr
    import pandas as pd

    runs = pd.read_parquet(out / "runs.parquet")
    assert runs["launch.detector"].tolist() == ["held"] * 3
    assert runs["launch.latency"].notna().all()


def test_classes_fly_in_python_whether_they_are_registered_or_not() -> None:
    class Sudden:
        def __init__(self, rate: float) -> None: ...

        def reset(self) -> None: ...

        def step(self, t: float, fx: float, fy: float, fz: float) -> bool:
            return fx > 40.0

    class Constant(uavsim.onboard.airspeed.Estimator):
        def __init__(self, *given: Any) -> None:
            self.given = given

        def step(self, *reading: float) -> Any:
            return 20.0, 5.0, True

    flight = uavsim.fly("catapult", overrides=SHORT, detector=Sudden, estimator=Constant)
    assert flight.score["launch"]["detector"] == "Sudden"
    assert flight.score["airspeed"]["estimator"] == "Constant"
    assert flight.estimate["airspeed"].eq(20.0).all()
    usual = uavsim.fly("catapult", overrides=(*SHORT, "estimator.kind=paper"), detector=Sudden)
    same = flight.estimate["t"].isin(usual.estimate["t"])
    raw = usual.estimate["airspeed_raw"][usual.estimate["t"].isin(flight.estimate["t"])]
    early = flight.estimate["t"][same] < 2.6  # the same flight as long as nothing was commanded
    np.testing.assert_array_equal(
        flight.estimate["airspeed_raw"][same][early].to_numpy(), raw[: early.sum()].to_numpy()
    )


def test_ours_by_name_fly_in_python() -> None:
    flight = uavsim.fly("catapult", overrides=SHORT, detector="cusum", estimator="paper")
    assert (flight.score["launch"]["detector"], flight.score["airspeed"]["estimator"]) == ("cusum", "paper")
    assert flight.score["plugins"] == []


class Bench(PrescribedPlant):
    """A push along x."""

    @dataclass(frozen=True)
    class Settings:
        push: float = 60.0

    def __init__(self, settings: Any, run: Run) -> None:
        since = run.time - run.release_time
        push = np.where((since >= 0.0) & (since < 0.4), settings.push, 3.0)
        super().__init__(run, {"fx": push, "fy": 0.0 * push, "fz": 0.0 * push - 9.4})


def test_a_plant_flies_as_a_rig() -> None:
    plugins.plant("bench")(Bench)
    flight = uavsim.fly("catapult", overrides=(*SHORT, "expect=completed"), plant=Bench)
    assert flight.score["outcome"] == "completed"
    assert flight.truth["fx"].max() == 60.0
    assert flight.score["launch"]["detected_time"] is not None
    assert flight.score["plugins"][0]["group"] == "uavsim.plants"
    harder = uavsim.fly("catapult", overrides=(*SHORT, "plant.kind=bench", "plant.options.push=80"))
    assert harder.truth["fx"].max() == 80.0


# -- they fail -------------------------------------------------------------------------------------------------------


def _detector(step: Any) -> type:
    return type("Bad", (), {"__init__": lambda self, rate: None, "reset": lambda self: None, "step": step})


def _estimator(step: Any) -> type:
    return type("Bad", (uavsim.onboard.airspeed.Estimator,), {"__init__": lambda self, *given: None, "step": step})


def _raises_late(self: Any, t: float, *_: float) -> bool:
    if t > 1.5:
        raise ZeroDivisionError("no force")
    return False


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"detector": _detector(_raises_late)}, "detector 'Bad' raised ZeroDivisionError: no force at 1.5"),
        ({"detector": _detector(lambda self, *_: "yes")}, "detector 'Bad' answered 'yes' at 0.0"),
        ({"detector": _detector(lambda self, *_: None)}, "detector 'Bad' answered None at 0.0"),
        ({"detector": _detector(lambda self, *_: sys.exit(3))}, "detector 'Bad' raised SystemExit: 3 at 0.0"),
        ({"estimator": _estimator(lambda self, *_: (float("nan"), 1.0, True))}, "a valid airspeed is a number from 0"),
        ({"estimator": _estimator(lambda self, *_: (30.0, float("inf"), True))}, "deviation of a valid airspeed"),
        ({"estimator": _estimator(lambda self, *_: (30.0, 1.0))}, r"answered \(30.0, 1.0\) at 0.0"),
        ({"estimator": _estimator(lambda self, *_: 30.0)}, "answered 30.0 at 0.0"),
        ({"estimator": _estimator(lambda self, *_: (-3.0, 1.0, False))}, "neither airspeed nor standard deviation"),
        ({"estimator": _estimator(lambda self, *_: (3.0, 1.0, 7))}, "valid must be True or False"),
    ],
)
def test_what_raises_or_gives_nonsense_ends_the_flight_with_a_reason(
    given: dict[str, type], reason: str, tmp_path: Path
) -> None:
    import re

    flight = uavsim.fly("catapult", overrides=SHORT, **given)  # type: ignore[arg-type]
    assert flight.score["outcome"] == "onboard_failed"
    assert re.search(reason, flight.score["reason"]), flight.score["reason"]
    assert "\n" not in flight.score["reason"]
    flight.save(tmp_path / "flight")
    assert load(tmp_path / "flight").score["reason"] == flight.score["reason"]
    from uavsim.cosim import replay

    again = replay(flight)
    assert again.events == flight.events
    assert again.estimate.equals(flight.estimate)
    assert (again.score["outcome"], again.score["reason"]) == ("onboard_failed", flight.score["reason"])


def test_not_a_number_that_is_not_valid_is_an_answer() -> None:
    silent = _estimator(lambda self, *_: (float("nan"), float("nan"), False))
    flight = uavsim.fly("catapult", overrides=SHORT, estimator=silent)
    assert flight.score["outcome"] in ("timeout", "cruise")
    assert flight.score["airspeed"]["valid_fraction"] == 0.0


def test_a_plant_that_fails_ends_the_flight_with_a_reason() -> None:
    class Breaks(Bench):
        def step(self) -> None:
            super().step()
            if self.k == 1234:
                raise RuntimeError("the arm came off")

    flight = uavsim.fly("catapult", overrides=(*SHORT, "expect=completed"), plant=Breaks)
    assert flight.score["outcome"] == "onboard_failed"
    assert flight.score["reason"] == "plant 'Breaks' raised RuntimeError: the arm came off at 1.2340 s"
    assert len(flight.truth) == 1235


# -- they are refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "there is no such file"),
        ("x = 1\n", "registers no detector, estimator or plant"),
        ("import nowhere_at_all\n", "mine.py, line 1: ModuleNotFoundError: No module named 'nowhere_at_all'"),
        ("\n\ndef f(:\n", "mine.py, line 3: SyntaxError"),
        ("x = 1\n1 / 0\n", "mine.py, line 2: ZeroDivisionError"),
        ("import sys\nsys.exit(4)\n", "ends the program as it is imported (4)"),
        (
            "from uavsim.plugins import detector\n@detector('cusum')\nclass A:\n"
            "    def step(self): ...\n    def reset(self): ...\n",
            "there is already a detector 'cusum'",
        ),
        (
            "from uavsim.plugins import detector\n@detector('a')\nclass A:\n    def reset(self): ...\n",
            "A has no method 'step'",
        ),
        (
            "from uavsim.plugins import estimator\n@estimator('a')\nclass A:\n    pass\n",
            "A has no method 'step'",
        ),
        ("\x00", "mine.py"),
    ],
)
def test_a_file_that_is_no_plugin_is_one_line(content: str | None, says: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "mine.py").write_text(content, encoding="utf-8")
    out = tmp_path / "out"
    refused = run("fly", "catapult", "--plugin", tmp_path / "mine.py", "--out", out)
    assert refused.returncode == 2
    assert refused.stderr.startswith("Error: --plugin ")
    assert refused.stderr.count("\n") == 1, refused.stderr
    assert says in refused.stderr
    assert refused.stdout == ""
    assert not out.exists()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (("detector.kind=helt",), "detector.kind = 'helt' is not registered; did you mean 'held'?"),
        (("detector.kind=mine.py",), "names a file, and a scenario runs none"),
        (
            ("detector.kind=held", "detector.options.levl=3"),
            "detector.options: unknown key 'levl'; did you mean 'level'?",
        ),
        (("detector.kind=held", "detector.options.level=0"), "level = 0: must be a number above 0 and of at most 500"),
        (("detector.kind=held", "detector.options.level=high"), "level = 'high': must be a number"),
        (("detector.kind=held", "detector.threshold=30"), "detector.threshold: is not read by kind = 'held'"),
        (("detector.options.level=3",), "detector.options: this detector has no options"),
        (
            ("estimator.kind=bernoulli-alone", "estimator.options.x=3"),
            "estimator.options: this estimator has no options",
        ),
        (("estimator.kind=best",), "estimator.kind = 'best' is not registered; there are paper"),
        (("plant.kind=moon",), "plant.kind = 'moon' is not registered"),
    ],
)
def test_what_a_scenario_cannot_name_is_one_line(given: tuple[str, ...], says: str, plugin: Path) -> None:
    plugins.load([str(plugin)])
    with pytest.raises(ValueError, match=r"^--set: ") as caught:
        load_scenario("catapult", overrides=given)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_kind_says_how_one_is_registered() -> None:
    with pytest.raises(PluginError, match=r"--plugin FILE\.py .* entry point group uavsim\.detectors"):
        find("detector", "nobody")


def test_a_scenario_never_runs_a_file(tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    (tmp_path / "evil.py").write_text(f"open({str(mark)!r}, 'w')\n", encoding="utf-8")
    for kind in ("evil.py", "evil", str(tmp_path / "evil.py"), "evil:Detector"):
        (tmp_path / "s.toml").write_text(f"[detector]\nkind = {json.dumps(kind)}\n", encoding="utf-8")
        refused = run("fly", "s.toml", cwd=tmp_path)
        assert refused.returncode == 2
        assert "Error: s.toml: detector.kind = " in refused.stderr
    assert not mark.exists()


# -- packages --------------------------------------------------------------------------------------------------------

POINTS = {
    "good": "held = good_package.parts:Held",
    "broken": "broken = broken_package:Nothing",
}


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Two packages as pip leaves them: one that is good, one that cannot be imported."""
    for name, point in POINTS.items():
        package = tmp_path / f"{name}_package"
        package.mkdir()
        (package / "__init__.py").write_text("" if name == "good" else "raise ImportError('no such library')\n")
        info = tmp_path / f"{name}_package-1.4.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}-package\nVersion: 1.4\n")
        (info / "entry_points.txt").write_text(f"[uavsim.detectors]\n{point}\n")
        (info / "top_level.txt").write_text(f"{name}_package\n")
        (info / "RECORD").write_text(f"{name}_package/__init__.py,,\n")
    (tmp_path / "good_package" / "parts.py").write_text(PLUGIN, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    yield SimpleNamespace(folder=tmp_path)
    for name in [name for name in sys.modules if name.split(".")[0] in ("good_package", "broken_package")]:
        del sys.modules[name]


def test_only_the_package_that_is_named_is_imported(installed: SimpleNamespace) -> None:
    listed = {s.name: s for s in plugins.sources("detector")}
    assert (listed["broken"].source, listed["broken"].version) == ("broken_package:Nothing", "1.4")
    assert not {"good_package", "broken_package"} & set(sys.modules)
    scenario = Scenario.from_dict({"detector": {"kind": "held"}})
    assert "good_package" in sys.modules
    assert "broken_package" not in sys.modules
    (source,) = scenario.plugins
    assert (source.name, source.source, source.version) == ("held", "good-package: good_package.parts", "1.4")
    with pytest.raises(ValueError, match=r"'broken' of broken-package: .*ImportError: no such library"):
        Scenario.from_dict({"detector": {"kind": "broken"}})


# -- the list --------------------------------------------------------------------------------------------------------


def test_the_list_names_ours_and_theirs(plugin: Path) -> None:
    listed = run("plugins", "--plugin", plugin)
    assert listed.returncode == 0
    rows = [line.split() for line in listed.stdout.splitlines()]
    assert ["detector", "cusum", "uavsim.onboard.launch.cusum", uavsim.__version__] in rows
    assert any(row[:4] == ["detector", "held", "mine.py", "SHA-256"] for row in rows)
    assert {row[0] for row in rows} == {"detector", "estimator", "plant"}


# -- operating curves ------------------------------------------------------------------------------------------------


def test_a_detector_without_a_loop_is_tried_and_counted_as_ours(plugin: Path) -> None:
    from uavsim.studies.false_alarms import count
    from uavsim.studies.operating import launches_of, tried

    plugins.load([str(plugin)])
    both = [DetectorSettings(kind="held", options={"level": 30.0}), DetectorSettings(kind="single-threshold")]
    held, threshold = tried(both, launches_of((6.0, 0.3, True)), seed=1, trials=20)
    assert held.detected.sum() == threshold.detected.sum() == 20
    assert np.median(held.since_onset) < np.median(threshold.since_onset)
    (alarms, _) = count(both, {"centrifuge": 0.1}, seed=1)["centrifuge"]
    assert alarms.alarms > 0  # 4.1 g is above its level


@pytest.mark.slow
def test_a_detector_without_a_loop_has_an_operating_curve(plugin: Path, tmp_path: Path) -> None:
    out = tmp_path / "roc"
    given = ("--plugin", plugin, "--detectors", "held,cusum", "--hours", "0.05", "--trials", "20", "--cells", "2")
    curves = run("roc", *given, "--out", out)
    assert curves.returncode == 0, curves.stderr
    import pandas as pd

    rows = pd.read_csv(out / "roc.csv")
    held = rows[rows["detector"] == "held"]
    assert held["key"].unique().tolist() == ["options.level"]
    assert held["level"].tolist() == pytest.approx(
        [40.0 * f for f in (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6)]
    )
    assert held["pd"].max() > 0.9
    assert (out / "plots" / "levels.png").is_file()


def test_a_detector_without_a_level_has_one_point() -> None:
    from uavsim.studies.operating import levels

    plugins.detector("yes")(_detector(lambda self, *_: False))
    assert [factor for factor, _ in levels(DetectorSettings(kind="yes"))] == [1.0]


def test_the_hours_that_plain_python_cannot_do_are_left_out_and_told(plugin: Path) -> None:
    from uavsim.studies import reach

    plugins.load([str(plugin)])
    plain = reach.plain([DetectorSettings(kind="held"), DetectorSettings(kind="cusum")], 1000.0)
    assert [one.kind for one in plain] == ["held"]
    asked = reach.Work(1000.0, 100_000, 1000)
    done = reach.within_reach(asked, detectors=11, compared=30, rate=1000.0)
    assert done.hours < asked.hours
    assert reach.told(asked, done, reach.why(plain)).startswith(
        "held: without a compiled loop: so that it ends in about ten minutes, "
    )


def test_what_a_plugin_prints_is_not_in_the_document(tmp_path: Path) -> None:
    (tmp_path / "beside.py").write_text("LEVEL = 40.0\n", encoding="utf-8")
    (tmp_path / "loud.py").write_text("import beside\nprint('hello')\n" + PLUGIN, encoding="utf-8")
    loud = run("fly", "--plugin", "loud.py", *settings("detector.kind=held"), "--no-plots", "--json", cwd=tmp_path)
    assert json.loads(loud.stdout)["score"]["launch"]["detector"] == "held"
    assert "hello" in loud.stderr


# -- odd ones --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["", "a b", "../x", "x.py", "-x", "x\n", "x" * 65, "é\u202e"])
def test_a_name_that_cannot_be_named_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="cannot be a detector's name"):
        plugins.detector(name)(_detector(lambda self, *_: False))


def test_an_object_in_place_of_its_class_is_refused() -> None:
    with pytest.raises(ValueError, match="give the class, not"):
        uavsim.fly("catapult", overrides=SHORT, detector=_detector(lambda self, *_: False)(1000.0))
    with pytest.raises(ValueError, match="give the class, not"):
        uavsim.fly("catapult", overrides=SHORT, estimator=_estimator(lambda self, *_: None)())


def test_settings_that_are_no_dataclass_are_refused() -> None:
    odd = _detector(lambda self, *_: False)
    odd.Settings = dict  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="Settings must be a dataclass"):
        plugins.detector("odd")(odd)


def test_settings_within_settings_come_as_their_classes() -> None:
    @dataclass(frozen=True)
    class Inner:
        hold: float = 0.02
        names: tuple[str, ...] = ("a",)

    @dataclass(frozen=True)
    class Outer:
        inner: Inner = Inner()

    seen = []
    odd = _detector(lambda self, *_: False)
    odd.Settings = Outer  # type: ignore[attr-defined]
    odd.__init__ = lambda self, rate, settings: seen.append(settings)  # type: ignore[misc]
    plugins.detector("nested")(odd)
    flight = uavsim.fly("catapult", overrides=(*SHORT, "detector.kind=nested", "detector.options.inner.hold=1"))
    assert seen[-1] == Outer(Inner(1.0, ("a",)))
    assert flight.scenario["detector"]["options"] == {"inner": {"hold": 1.0, "names": ["a"]}}
    assert Scenario.from_dict(flight.scenario).detector.options == seen[-1]


class MuteError(Exception):
    def __str__(self) -> str:
        raise RuntimeError


def test_an_exception_that_cannot_be_told_is_told(tmp_path: Path) -> None:
    def fail(self: Any, *_: float) -> bool:
        raise MuteError

    flight = uavsim.fly("catapult", overrides=SHORT, detector=_detector(fail))
    assert flight.score["reason"].startswith("detector 'Bad' raised MuteError: it does not say what at 0.0")


@pytest.mark.parametrize(
    ("news", "fails"), [([(1.0, "airspeed_note", "total", "own")], False), ([1], True), ("told", True)]
)
def test_an_estimators_news_are_events_or_a_reason(news: Any, fails: bool) -> None:
    class Tells(uavsim.onboard.airspeed.Estimator):
        def __init__(self, *given: Any) -> None:
            self.told = news

        news = property(lambda self: self.told)

        def step(self, *reading: float) -> Any:
            return 20.0, 5.0, True

    flight = uavsim.fly("catapult", overrides=SHORT, estimator=Tells)
    assert (flight.score["outcome"] == "onboard_failed") is fails
    if not fails:
        assert [e for e in flight.events if e["event"] == "airspeed_note"] == [
            {"t": 1.0, "event": "airspeed_note", "channel": "total", "kind": "own"}
        ]


def test_what_is_called_as_we_are_is_not_ours(tmp_path: Path) -> None:
    (tmp_path / "uavsim.py").write_text(PLUGIN, encoding="utf-8")
    plugins.load([str(tmp_path / "uavsim.py")])
    (source,) = Scenario.from_dict({"detector": {"kind": "held"}}).plugins
    assert (source.name, source.source) == ("held", "uavsim.py")


def test_a_part_that_raises_ends_the_operating_curve_with_a_line(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text(PLUGIN.replace("self.level = fx - self.settings.level", "1 / 0"), encoding="utf-8")
    given = ("--plugin", "bad.py", "--detectors", "held", "--hours", "0.05", "--trials", "5", "--cells", "0")
    refused = run("roc", *given, cwd=tmp_path)
    assert refused.returncode == 2
    assert refused.stderr == "Error: detector 'held' raised ZeroDivisionError: division by zero at 0.0000 s\n"


class Divided:
    """A level that is a share of what has not been counted yet."""

    level = property(lambda self: 1 / self.count)
    count = total = 0
    triggered = False

    def __init__(self, rate: float) -> None: ...

    def reset(self) -> None: ...

    def step(self, *_: float) -> bool:
        return False


def _with(**attributes: Any) -> type:
    return type("Odd", (Divided,), {"level": 0.0, **attributes})


@pytest.mark.parametrize(
    ("cls", "says"),
    [
        (Divided, r"detector 'Divided', attribute 'level', raised ZeroDivisionError: division by zero at 1\.5"),
        (_with(level="high"), "attribute 'level', raised ValueError"),
        (_with(count=1j), "attribute 'count', raised TypeError"),
        (_with(total=10**400), "attribute 'total', raised OverflowError"),
        (_with(triggered=property(lambda self: sys.exit(0))), "attribute 'triggered', raised SystemExit"),
        (_with(step=lambda self, *_: 1 + 0j), r"answered \(1\+0j\) at 0\.0"),
        (_with(step=lambda self, *_: np.array([True])), r"answered array\(\[ True\]\) at 0\.0"),
    ],
)
def test_a_state_that_is_none_ends_the_flight(cls: type, says: str) -> None:
    import re

    flight = uavsim.fly("catapult", overrides=SHORT, detector=cls)
    assert flight.score["outcome"] == "onboard_failed"
    assert re.search(says, flight.score["reason"]), flight.score["reason"]


@pytest.mark.parametrize("raises", ["import sys; sys.exit(0)", "raise GeneratorExit", "1 / 0", "raise KeyError"])
def test_a_part_that_cannot_be_made_is_one_line(raises: str, tmp_path: Path) -> None:
    code = PLUGIN.replace("        self.settings = settings\n", f"        {raises}\n")
    (tmp_path / "bad.py").write_text(code, encoding="utf-8")
    refused = run("fly", "--plugin", "bad.py", *settings("detector.kind=held"), cwd=tmp_path)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.startswith("Error: ")
    assert "detector 'held' cannot be made: " in refused.stderr
    assert refused.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "answer", [(10**400, 1.0, True), ("20", "1", "1"), "201", (1e300, 1.0, False), (20.0, 1.0, True, 3.0), [None] * 9]
)
def test_an_answer_that_is_none_ends_the_flight(answer: Any) -> None:
    flight = uavsim.fly("catapult", overrides=SHORT, estimator=_estimator(lambda self, *_: answer))
    assert flight.score["outcome"] == "onboard_failed"
    assert "estimator 'Bad' answered " in flight.score["reason"]


def test_news_may_be_a_list_of_its_own_that_is_replaced() -> None:
    class Tells(uavsim.onboard.airspeed.Estimator):
        def __init__(self, *given: Any) -> None:
            self.news = []

        def step(self, t: float, *reading: float) -> Any:
            if 1.0 < t < 1.02:
                self.news = [*self.news, (t, "airspeed_note", "total", "")]
            return 20.0, 5.0, True

    flight = uavsim.fly("catapult", overrides=SHORT, estimator=Tells)
    assert {e["channel"] for e in flight.events if e["event"] == "airspeed_note"} == {"total"}
    assert uavsim.onboard.airspeed.Estimator().news == []


def test_a_plant_need_not_know_what_the_airs_motion_is_made_of_and_may_remark() -> None:
    def truth(self: Any) -> dict[str, Any]:
        return {name: column for name, column in Bench.truth(self).items() if name not in OF_AIR}

    plain = type("Plain", (Bench,), {"truth": truth, "remarks": ["on a\nbench"]})
    flight = uavsim.fly("catapult", overrides=(*SHORT, "expect=completed"), plant=plain)
    assert flight.score["outcome"] == "completed"
    assert flight.truth[list(OF_AIR)].isna().all().all()
    assert flight.score["remarks"] == ["on a bench"]
    mute = type("Mute", (Bench,), {"remarks": property(lambda self: 1 / 0)})
    assert uavsim.fly("catapult", overrides=(*SHORT, "expect=completed"), plant=mute).score["remarks"] == []


@pytest.mark.parametrize(
    ("method", "value", "says"),
    [
        ("truth", lambda self: 1 / 0, "has no whole truth after .* rows: ZeroDivisionError"),
        ("truth", lambda self: None, "has no whole truth"),
        ("truth", lambda self: {"t": np.zeros(3)}, "has no whole truth"),
        ("flow", lambda self: (1.0, 2.0), r"has flow = \(1\.0, 2\.0\)"),
        ("failure", "the arm\ncame off", "has failed at 0.0000 s: the arm came off"),
        ("finite", property(lambda self: np.array([1, 2])), "raised ValueError"),
    ],
)
def test_a_plants_nonsense_ends_the_flight_or_is_refused(method: str, value: Any, says: str) -> None:
    import re

    odd = type("Odd", (Bench,), {method: value})
    overrides = (*SHORT, "expect=completed", "air_data.static_port.error=0.02")
    try:
        flight = uavsim.fly("catapult", overrides=overrides, plant=odd)
        assert flight.score["outcome"] == "onboard_failed"
        told = flight.score["reason"]
    except ValueError as error:  # before it flew
        told = str(error)
    assert re.search(says, told), told


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("x: object = object()", "cannot be read|must be|holds what a file cannot"),
        ("x: float = float('nan')", "detector.options: "),
        ("x: Annotated[float, Interval(ge=2.0)] = 1.0", r"x = 1\.0: must be a number of at least 2"),
        ("x: 'Unknown' = 1.0", "cannot be read"),
        ("x: int", "detector.options: x is missing"),
    ],
)
def test_settings_that_a_file_cannot_hold_are_refused_before_they_fly(body: str, says: str, tmp_path: Path) -> None:
    code = PLUGIN.replace(
        "        hold: float = 0.010\n        names: tuple[str, ...] = ()\n", "        hold: float = 0.01\n"
    )
    code = code.replace("        level: Annotated", f"        {body}\n        level: Annotated")
    (tmp_path / "odd.py").write_text(code.replace("settings=Settings()", "settings"), encoding="utf-8")
    plugins.load([str(tmp_path / "odd.py")])
    with pytest.raises(ValueError, match=says) as caught:
        load_scenario("catapult", overrides=["detector.kind=held"])
    assert "\n" not in str(caught.value)


def test_settings_may_check_themselves() -> None:
    @dataclass(frozen=True)
    class Own:
        low: float = 1.0
        high: float = 2.0

        def __post_init__(self) -> None:
            if self.low > self.high:
                raise ValueError("low is above high")

    odd = _detector(lambda self, *_: False)
    odd.Settings = Own  # type: ignore[attr-defined]
    plugins.detector("own")(odd)
    with pytest.raises(ValueError, match=r"^--set: detector\.options: low is above high$"):
        load_scenario("catapult", overrides=["detector.kind=own", "detector.options.low=3"])


def test_an_entry_point_by_another_name_keeps_what_the_decorator_says(
    installed: SimpleNamespace, tmp_path: Path
) -> None:
    info = installed.folder / "good_package-1.4.dist-info"
    points = "[uavsim.detectors]\nother = good_package.parts:Held\npx4 = good_package.parts:Held\n"
    (info / "entry_points.txt").write_text(points)
    kind = find("detector", "other")
    assert (kind.watches, kind.unit) == ("f_x over level", "m/s²")
    assert find("detector", "px4").ours
    listed = [s for s in plugins.sources("detector") if s.name == "px4"]
    assert [s.source for s in listed][1:] == ["good_package.parts:Held (not used: the name is taken)"]


def test_the_code_of_a_class_without_a_file_is_known_by_its_hash() -> None:
    def made(level: float) -> Any:
        names: dict[str, Any] = {"__name__": "__nowhere__"}
        exec(
            "class Cell:\n def __init__(self, rate): pass\n def reset(self): pass\n"
            f" def step(self, t, fx, fy, fz): return fx > {level}\n",
            names,
        )
        return names["Cell"]

    one, other, again = (
        uavsim.fly("catapult", overrides=SHORT, detector=made(level)).score["plugins"][0]["sha256"]
        for level in (40.0, 41.0, 40.0)
    )
    assert one == again != other


def test_what_is_written_to_the_terminal_by_others_is_not_in_the_document(tmp_path: Path) -> None:
    loud = PLUGIN.replace("        self.settings = settings\n", "        self.settings = settings\n        loud()\n")
    loud += "\n\ndef loud():\n    import os\n    os.write(1, b'by number')\n    os.system('echo by a process')\n"
    (tmp_path / "loud.py").write_text(loud, encoding="utf-8")
    given = ("fly", "--plugin", "loud.py", *settings("detector.kind=held"), "--no-plots", "--json")
    flown = run(*given, cwd=tmp_path)
    assert json.loads(flown.stdout)["score"]["launch"]["detector"] == "held"
    assert "by number" in flown.stderr
    assert "by a process" in flown.stderr


def test_what_is_hashed_is_what_runs_and_nothing_is_left_beside_it(plugin: Path) -> None:
    """Not the code that Python kept of an earlier version, of the same size and second."""
    plugins.load([str(plugin)])
    plugin.write_text(
        PLUGIN.replace(
            "level: Annotated[float, Interval(gt=0.0, le=500.0)] = 40.0",
            "level: Annotated[float, Interval(gt=0.0, le=500.0)] = 41.0",
        ),
        encoding="utf-8",
    )
    plugins.load([str(plugin)])
    assert Scenario.from_dict({"detector": {"kind": "held"}}).detector.options.level == 41.0
    assert [file.name for file in plugin.parent.iterdir()] == ["mine.py"]
