"""The launch-force curve as a rig: its shapes, its way, its noise, and its run in the loop."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import uavsim
from uavsim.cosim import replay
from uavsim.flight import load
from uavsim.onboard.launch import MultiLevelWindow
from uavsim.plants.plant import Run
from uavsim.plants.prescribed import room
from uavsim.plants.rigs.launch_curve import LaunchCurveSettings, launch_curve, shape
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.truth import STANDARD_GRAVITY

LEVEL, RELEASE, END = 8.0, 0.5, 1.5  # g, s, s
RING = LaunchCurveSettings()
RUN = Run(EnvironmentSettings(), LauncherSettings(peak_specific_force_g=LEVEL), END, RELEASE)


def columns(settings: LaunchCurveSettings = RING, run: Run = RUN) -> dict[str, np.ndarray]:
    plant = launch_curve(settings, run)
    for _ in range(round(1000 * END)):
        plant.step()
    return plant.truth()


def felt(settings: LaunchCurveSettings, run: Run = RUN) -> np.ndarray:
    plant, rows = launch_curve(settings, run), []
    for _ in range(round(1000 * END)):
        plant.step()
        rows.append(plant.force)
    return np.array(rows)


def test_the_ring_is_the_published_equation() -> None:
    t = np.arange(0.0, 0.250, 1e-3)
    expected = np.minimum(t / 3e-3, 1.0) * (1.0 + 0.5 * np.exp(-t / 0.05) * np.cos(2 * np.pi * 120 * t + 1.75 * np.pi))
    np.testing.assert_allclose(shape(RING, t), expected, atol=1e-12)


@pytest.mark.parametrize("level", [1.0, 5.0, 15.0])
def test_the_ring_gives_the_published_counts(level: float) -> None:
    """7, 14, 22 and 32 of 10, 20, 30, 40, recognised in window 4 (table 2), at any level: G is 3/4 of it."""
    detector = MultiLevelWindow(trigger=0.75 * level, threshold=0.75 * level, samples=10, levels=4, ratio=0.8)
    counts = []
    for k, force in enumerate(level * shape(RING, np.arange(100) / 1000.0)):
        recognised = detector.step(k / 1000.0, force, 0.0, 0.0)
        if detector.total and detector.total % 10 == 0:
            counts.append((detector.total, detector.count))
        if recognised:
            break
    assert counts == [(10, 7), (20, 14), (30, 22), (40, 32)]


@pytest.mark.parametrize("kind", ["half-sine", "trapezoid"])
def test_the_other_shapes_have_their_peak_and_their_impulse(kind: str) -> None:
    """2/π of length for a half-sine, length less half of rise and fall for a trapezoid; trapezium rule, 1e-4."""
    settings = LaunchCurveSettings(shape=kind, length=0.2, rise=0.03, fall=0.05)  # type: ignore[arg-type]
    t = np.arange(-0.05, 0.3, 1e-4)
    force = shape(settings, t)
    assert force.max() == pytest.approx(1.0, abs=1e-6)
    assert np.all(force[(t < 0.0) | (t > 0.2)] == 0.0)
    impulse = 0.2 * 2.0 / np.pi if kind == "half-sine" else 0.2 - 0.5 * (0.03 + 0.05)
    assert np.trapezoid(force, t) == pytest.approx(impulse, rel=1e-4)


def test_before_and_after_it_rests_on_the_rail() -> None:
    c, angle = columns(), np.radians(LauncherSettings().elevation_deg)
    rest = (c["t"] < RELEASE) | (c["t"] > RELEASE + RING.length)
    np.testing.assert_allclose(c["fx"][rest], STANDARD_GRAVITY * np.sin(angle))
    np.testing.assert_allclose(c["fz"], -STANDARD_GRAVITY * np.cos(angle))
    assert np.all(c["fx"] >= c["fx"][0])  # the stop pushes when the curve does not


def test_the_way_is_what_the_force_makes() -> None:
    """Constant force less g sin θ over 0.2 s: s = a t²/2; the steep edges of 1 ms shift it by less than 1 %."""
    settings = LaunchCurveSettings(shape="trapezoid", length=0.2, rise=0.001, fall=0.001)
    c, angle = columns(settings), np.radians(LauncherSettings().elevation_deg)
    a = STANDARD_GRAVITY * (LEVEL - np.sin(angle))
    assert c["rail_s"][-1] == pytest.approx(0.5 * a * 0.2**2, rel=0.012)
    assert np.all(np.diff(c["rail_s"]) >= -1e-12)


def test_noise_is_felt_white_and_not_part_of_the_truth() -> None:
    """1500 samples: standard deviation within 8 % (4.4 sigma), neighbours uncorrelated within 0.11 (4.3 sigma)."""
    noisy = replace(RING, noise_sd_g=0.4)
    np.testing.assert_array_equal(columns(noisy)["fx"], columns()["fx"])
    noise = (felt(noisy) - felt(RING)) / STANDARD_GRAVITY
    assert noise[:, 0].std() == pytest.approx(0.4, rel=0.08)
    assert abs(np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]) < 0.11
    assert not noise[:, 1:].any()
    np.testing.assert_array_equal(felt(noisy), felt(noisy))
    assert np.abs(felt(noisy, replace(RUN, random_seed=2)) - felt(noisy)).max() > 0.1


def test_the_room_has_the_standard_atmosphere() -> None:
    """ISO 2533, table 5, at a geometric height of 1000 m: 898.76 hPa, 281.651 K."""
    pressure, temperature = room(EnvironmentSettings(ground_elevation=1000.0))
    assert pressure == pytest.approx(89_876.2, abs=0.5)
    assert temperature == pytest.approx(281.651, abs=5e-4)


def test_it_flies_and_replays_byte_for_byte(tmp_path: Path) -> None:
    flight = uavsim.fly("launch-curve")
    launch = flight.score["launch"]
    assert flight.score["outcome"] == flight.score["expected"] == "completed"
    assert all(r["met"] for r in flight.score["requirements"])
    assert launch["release_time"] < launch["crossing_time"] < launch["detected_time"]
    assert launch["true_time"] - launch["release_time"] < 0.010
    assert flight.score["airspeed"]["rmse"] is None
    again = replay(load(flight.save(tmp_path / "rig")))
    assert again.events == flight.events
    assert again.score == flight.score
    assert again.estimate.equals(flight.estimate)


def test_commands_change_nothing() -> None:
    plant, other = launch_curve(RING, RUN), launch_curve(RING, RUN)
    plant.command((1.0, 1.0, 0.2, 0.1, 1.0))
    for _ in range(600):
        plant.step()
        other.step()
    assert plant.force == other.force
    assert plant.finite
