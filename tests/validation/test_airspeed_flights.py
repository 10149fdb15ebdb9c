"""Goals of the airspeed in flights of the loop: against the bound, against raw and the published filter, and the hold.

Ensembles with seeds that nothing was tuned on. The pair is an MS5611 at oversampling 4096 that takes a temperature
after every tenth pressure: 1.2 Pa a conversion, some 110 conversions a second.
"""

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

import uavsim
from uavsim.studies.airspeed_flights import Held, figures, hold, paper_rmse

pytestmark = pytest.mark.slow

Figure = Callable[..., None]
SEEDS = range(5001, 5051)
PART = 20  # of them in `make validate`
LIGHT = "environment.turbulence_wind_20ft=1.2"  # m/s: σ_u is 0.2 m/s at the height of cruise, the bound's own floor
GAINS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Overrides that fit the head with the pair."""
    part = (files("sensors") / "datasheets" / "ms5611.toml").read_text(encoding="utf-8")
    changes = (
        ('default_mode = "x1024/x1024"', 'default_mode = "x4096/10"'),
        ('name = "x4096/x4096"', 'name = "x4096/10"'),
        ("rate = 55.3", "rate = 110.6"),  # 10/(11·8.22 ms)
    )
    for old, new in changes:
        assert part.count(old) == 1
        part = part.replace(old, new)
    path: Path = tmp_path_factory.mktemp("part") / "ms5611.toml"
    path.write_text(part, encoding="utf-8")
    return [f"air_data.{channel}.preset={path}" for channel in ("total", "static")]


def flown(scenario: str, *overrides: str, whole: bool) -> list[Held]:
    seeds = SEEDS if whole else SEEDS[:PART]
    flights = [uavsim.fly(scenario, seed=seed, overrides=overrides) for seed in seeds]
    outcomes = [f.score["outcome"] for f in flights]
    assert set(outcomes) <= {"cruise", "timeout"}  # a gust in the last seconds is no fault of the estimate
    assert outcomes.count("cruise") >= 0.9 * len(flights)
    assert [e for f in flights for e in f.events if e["event"] == "airspeed_lost"] == []
    return [hold(flight) for flight in flights]


@pytest.fixture(scope="module")
def calm(pair: list[str], whole: bool) -> list[Held]:
    return flown("catapult", *pair, whole=whole)


@pytest.fixture(scope="module")
def light(pair: list[str], whole: bool) -> list[Held]:
    return flown("catapult", LIGHT, *pair, whole=whole)


@pytest.fixture(scope="module")
def pushed(pair: list[str], whole: bool) -> list[Held]:
    """Membranes that feel the push, calibrated to 30 % of what is usual."""
    return flown("catapult", LIGHT, "air_data.acceleration_sensitivity=true", *pair, whole=whole)


@pytest.fixture(scope="module")
def gusty(pair: list[str], whole: bool) -> list[Held]:
    return flown("gusty", "environment.gust_speed=0", *pair, whole=whole)


def near_the_bound(flights: list[Held], figure: Figure, name: str) -> None:
    """From climb on at most 1.25; in the air that is believed not less than what so many errors scatter by, 99.5 %."""
    found = figures(flights)
    for phase in ("stroke", "unfolding", "climb", "cruise"):
        f = found[phase]
        steady = phase in ("climb", "cruise")
        least = float(np.sqrt(chi2.ppf(0.005, len(flights)) / len(flights))) if steady and name != "calm" else 0.0
        label = f"{name}, {phase}: rmse {f.rmse:.4f}, bound {f.bound:.4f} m/s, ratio"
        figure(label, [f.ratio], "", least, 1.25 if steady else np.inf)
        figure(f"{name}, {phase}: NEES", [f.nees])


def test_climb_and_cruise_are_near_the_bound(
    calm: list[Held], light: list[Held], gusty: list[Held], pushed: list[Held], figure: Figure
) -> None:
    """At most 1.25 times the bound; in calm air, which is steadier than the bound's floor, less than that."""
    for name, flights in (("calm", calm), ("light", light), ("pushed", pushed), ("gusty", gusty)):
        near_the_bound(flights, figure, name)


def test_the_launch_is_known_from_its_beginning(calm: list[Held], figure: Figure) -> None:
    """60 % below raw and 2.5 times better than the published filter with the gain that is best for it here."""
    found = figures(calm)
    for phase, least, times in (("launch", 60.0, 2.5), ("detected", 50.0, 2.0)):
        paper = min(paper_rmse(calm, gain, phase) for gain in GAINS)
        figure(f"{phase}: rmse {found[phase].rmse:.3f}, raw {found[phase].raw:.3f} m/s, below raw", [
            found[phase].reduction
        ], "%", least)  # fmt: skip
        figure(f"{phase}: tuned published filter's rmse over ours", [paper / found[phase].rmse], "", times)


def test_the_launch_is_known_with_membranes_that_feel_it(pushed: list[Held], figure: Figure) -> None:
    found = figures(pushed)
    for phase, least, times in (("launch", 60.0, 2.5), ("detected", 50.0, 2.0)):
        paper = min(paper_rmse(pushed, gain, phase) for gain in GAINS)
        figure(f"pushed, {phase}: below raw", [found[phase].reduction], "%", least)
        figure(f"pushed, {phase}: tuned published filter's rmse over ours", [paper / found[phase].rmse], "", times)


def test_the_claim_is_what_it_is(
    light: list[Held], pushed: list[Held], gusty: list[Held], calm: list[Held], figure: Figure
) -> None:
    """95 % coverage at least 0.85 in the stroke, 0.92 to 0.98 in cruise where there is the declared turbulence.

    In dead calm air the claim, which holds for the floor of 0.2 m/s, is too modest.
    """
    for name, flights in (("light", light), ("pushed", pushed), ("gusty", gusty)):
        found = figures(flights)
        figure(f"{name}: coverage in the stroke", [found["stroke"].coverage], "", 0.85)
        figure(f"{name}: coverage in cruise", [found["cruise"].coverage], "", 0.92, 0.98)
    found = figures(calm)
    figure("calm: coverage in the stroke", [found["stroke"].coverage], "", 0.85)
    figure("calm: coverage in cruise", [found["cruise"].coverage], "", 0.92)


def test_airspeed_hold(calm: list[Held], pair: list[str], figure: Figure) -> None:
    """Within 0.2 m/s rms of the set point, and what the same hold does on an air-data head without errors."""
    figure("hold on the estimate, rms from the set point", [f.hold for f in calm], "m/s", 0.0, 0.2)
    perfect = ["estimator.kind=paper", "estimator.gain_total=0.99", "estimator.gain_static=0.99"]
    for channel in ("total", "static"):
        perfect += [f"air_data.{channel}.preset=bmp581", f"air_data.{channel}.mode=x1/x1"]
        perfect += [f"air_data.{channel}.unit=ideal", f"air_data.{channel}.noise_scale=0.01"]
        perfect += [f"air_data.{channel}.errors.{e}=0" for e in ("drift", "random_walk")]
        perfect += [f"air_data.{channel}.errors.quantisation=false"]
    truth = [hold(uavsim.fly("catapult", seed=seed, overrides=perfect)).hold for seed in list(SEEDS)[:10]]
    figure("hold on as good as the truth, rms from the set point", truth, "m/s", 0.0, 0.2)
    figure("difference", np.array([f.hold for f in calm[:10]]) - np.array(truth), "m/s", -0.1, 0.1)
