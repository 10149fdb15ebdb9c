"""One description, two uses: a noise that is the part's is the filter's too; one of `[mismatch]` is not.

Authority: Kalman, 1960 (innovations of a filter that believes the truth are white and of the variance it computes:
the mean of NIS is 1), and the Riccati equation of a scalar filter that does not.
"""

import numpy as np
import pytest

from sensors import PressureSensor, Streams
from uavsim.beliefs import believed_noise
from uavsim.onboard.airspeed import EstimatorSettings, RandomWalk, process_noise, steady_gain
from uavsim.scenario import Scenario, load_scenario

COUNT = 20_000


def scenario(*overrides: str) -> Scenario:
    return load_scenario("catapult", overrides=overrides)


def filter_of(flown: Scenario) -> tuple[float, float]:
    """Q and R of the total channel, Pa²."""
    noise = believed_noise(flown)
    return process_noise(EstimatorSettings(), noise)[0], noise.total_sd**2


def nis_on_a_walk(flown: Scenario, q: float) -> float:
    """Mean NIS of the total channel on a pressure that walks by `q` a conversion, read by the scenario's sensor.

    Drift and random walk stay (0.6 Pa and 5e-3 Pa/√s: 1e-6 of the variance a conversion); turn-on errors are constant.
    """
    device = PressureSensor(flown.air_data.total.description(), Streams(5))
    values = iter((95e3 + np.cumsum(np.random.default_rng(17).normal(0.0, q**0.5, COUNT))).tolist())
    channel = RandomWalk(*filter_of(flown))
    nis = []
    for _ in range(COUNT):
        pressure, _, _ = device.read(device.end, lambda _: (next(values), 288.15))
        channel.add(pressure)
        nis.append(channel.nis)
    return float(np.mean(nis[100:]))


@pytest.mark.parametrize("key", ["total", "static"])
def test_three_times_the_noise_of_a_part_is_nine_times_the_filters_variance(key: str) -> None:
    plain, noisy = believed_noise(scenario()), believed_noise(scenario(f"air_data.{key}.noise_scale=3"))
    assert getattr(noisy, f"{key}_sd") ** 2 == pytest.approx(9.0 * getattr(plain, f"{key}_sd") ** 2, rel=1e-12)
    doubted = believed_noise(scenario(f"mismatch.{key}_noise=3"))
    assert getattr(doubted, f"{key}_sd") ** 2 == pytest.approx(9.0 * getattr(plain, f"{key}_sd") ** 2, rel=1e-12)


def test_mismatch_changes_what_is_believed_and_not_what_is_read() -> None:
    """The descriptions, of which the units are drawn, are the same."""
    plain, doubted = scenario(), scenario("mismatch.total_noise=3", "mismatch.static_noise=2", "mismatch.temperature=2")
    assert plain.air_data == doubted.air_data
    assert believed_noise(doubted).temperature_sd == pytest.approx(2.0 * believed_noise(plain).temperature_sd)
    assert believed_noise(doubted).static_sd == pytest.approx(2.0 * believed_noise(plain).static_sd)


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_nis_is_one_for_the_parts_noise(scale: float) -> None:
    """On the walk that the filter was tuned for. n = 19 900; 4 deviations of a mean of χ²₁ are 4 √(2/n) = 4 %."""
    flown = scenario(f"air_data.total.noise_scale={scale}")
    assert nis_on_a_walk(flown, filter_of(flown)[0]) == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize("factor", [3.0, 1.0 / 3.0])
def test_nis_is_not_one_through_mismatch(factor: float) -> None:
    """It is what the Riccati equation of the wrong filter says, to 5 % (n = 19 900, 4 deviations 4 %)."""
    flown = scenario(f"mismatch.total_noise={factor!r}")
    q, believed = filter_of(flown)
    true = believed / factor**2
    gain = steady_gain(q, believed)
    error = (q * (1.0 - gain) ** 2 + gain**2 * true) / (1.0 - (1.0 - gain) ** 2)  # variance of x less the truth
    expected = (error + q + true) * (1.0 - gain) / believed
    assert not 0.7 < expected < 1.2
    assert nis_on_a_walk(flown, q) == pytest.approx(expected, rel=0.05)


def test_nis_of_a_flight_follows_the_description_and_not_the_mismatch() -> None:
    """In flight the pressure hardly walks, so NIS is below 1; three times the noise leaves it where it was.

    Total channel, about 3000 conversions in the scored rows, innovations correlated over two: 4 √(2/1500) = 15 % are
    four deviations. The stroke, whose rise is no noise, is 1 % of them and adds up to 10 % to the plain one's mean.
    """
    import uavsim

    flights = {
        name: uavsim.fly("catapult", overrides=overrides).score["pressure"]["total"]["nis_mean"]
        for name, overrides in (
            ("plain", ()),
            ("noisy", ("air_data.total.noise_scale=3",)),
            ("doubted", ("mismatch.total_noise=3",)),
        )
    }
    assert flights["noisy"] == pytest.approx(flights["plain"], rel=0.25)
    assert flights["doubted"] < 0.5 * flights["plain"]
