"""What is promised of the default launch detector, on launches and disturbances drawn from seeds of their own.

The signals and their distributions are those of `uavsim.studies.signals`, decisions those of `step`
(`uavsim.studies.detections`). The detector's numbers were found with other seeds (below 10 000) than these. A promise
of a share is asked of the share that was found, so the detector's own must be better than what is promised; each test
says how much worse one would have to be that fails it in 19 of 20 runs. Where all of n must be right, a detector that
is wrong with the probability 3/n fails with 95 %: 1.5e-3 of 2000.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from math import radians, sin
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from uavsim.onboard.launch import DetectorSettings
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import count
from uavsim.studies.low_rates import alarms, delays
from uavsim.studies.neyman_pearson import earliest_deadline
from uavsim.studies.signals import LaunchSettings, Stroke
from uavsim.studies.trials import Drawn, Verdicts, join, judge
from uavsim.truth import STANDARD_GRAVITY as G0

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
Figure = Callable[..., None]
SEED = 41_000
OURS, PAPERS = DetectorSettings(), DetectorSettings(kind="multi-level-window")  # the paper's: n 18 at 1 kHz, 4.6 g
CERTIFY = pytest.mark.certify  # cells of a grid that `make validate` has the worst of
PEAKS = (6.0, 7.0, 8.0, 10.0, 12.0, 15.0)  # g
SIGMAS = (0.05, 0.3, 1.0)  # g
LOT = 500  # launches read at once


@cache
def tried(settings: LaunchSettings, n: int, *, seed: int = SEED, detector: DetectorSettings = OURS) -> Verdicts:
    """What a detector makes of n launches at 1 kHz."""
    drawn = Drawn(settings)
    lots = [drawn.read(seed, first, min(LOT, n - first)) for first in range(0, n, LOT)]
    return join([judge(detector, lot, drawn.rate) for lot in lots])


def launches(peak: float, sigma: float, **more: Any) -> LaunchSettings:
    return replace(LaunchSettings(peak_g=(peak, peak), sigma_g=sigma), **more)


def wrong(verdicts: Verdicts) -> int:
    """Launches that were missed, or shouted too early."""
    return int((~verdicts.detected).sum())


# -- false alarms ----------------------------------------------------------------------------------------------------


def test_no_false_alarm_in_200_hours_of_the_mix(figure: Figure, whole: bool) -> None:
    """360 000 shocks. A detector with 0.015 alarms an hour, which is 3 in 200 h, fails with 95 %. A part: 40 h."""
    hours = 200.0 if whole else 40.0
    found = count([OURS], {"mix": hours}, seed=SEED, workers=2)["mix"][0]
    assert found.hours == hours
    figure(f"false alarms in {hours:g} h", [found.alarms], "", 0, 0)


@pytest.mark.parametrize(("sigma", "most"), [(0.05, 0), (0.3, 0), (0.5, 0), (1.0, 3)])
def test_a_minute_at_4_1_g_is_no_launch(sigma: float, most: int, figure: Figure) -> None:
    """300 runs each. Where none may be one, a probability of 1 % fails with 95 %; at 1 g one of 2.6 %."""
    figure("runs taken for launches", [_held(4.1, sigma, 300, 60.0)], "", 0, most)


@pytest.mark.parametrize("sigma", [0.05, 0.3, 1.0])
def test_15_g_held_is_a_launch(sigma: float, figure: Figure) -> None:
    """300 of 300; a probability of a miss of 1 % fails with 95 %."""
    figure("runs taken for launches", [_held(15.0, sigma, 300, 1.0)], "", 300, 300)


def _held(level: float, sigma: float, n: int, seconds: float) -> int:
    """How many of n runs are recognised: half a second at rest, a ramp of 5 s up to the level, some time at it."""
    t = np.arange(round((5.5 + seconds) * 1000)) / 1000
    force = np.minimum(np.maximum(t - 0.5, 0.0) / 5.0, 1.0) ** 2 * level
    detector, found = BatchDetector(OURS, 1000.0), 0
    for run in range(n):
        generator = np.random.default_rng(np.random.SeedSequence(SEED, spawn_key=(run, round(100 * sigma))))
        detector.reset()
        reading = np.clip(force + sigma * generator.standard_normal(t.size), -16.0, 16.0) * G0
        found += bool(detector.alarms(reading).size)
    return found


# -- detection -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("bump", [False, True], ids=["", "bump"])
@pytest.mark.parametrize("sigma", [pytest.param(0.05, marks=CERTIFY), 0.3, pytest.param(1.0, marks=CERTIFY)])
def test_every_launch_of_6_to_15_g_is_detected(sigma: float, bump: bool, figure: Figure) -> None:
    """2000 of 2000 in each cell; an alarm before the onset is none."""
    figure("of 2000, wrong", [wrong(tried(launches(peak, sigma, bump=bump), 2000)) for peak in PEAKS], "", 0, 0)


@pytest.mark.parametrize("sigma", [pytest.param(0.3, marks=CERTIFY), 1.0])
@pytest.mark.parametrize("peak", [6.0, pytest.param(15.0, marks=CERTIFY)])
def test_every_corner_of_the_distributions_is_detected(peak: float, sigma: float, figure: Figure) -> None:
    """2000 of 2000 of either shape, shortest and longest, steepest and slowest, on the flattest and steepest rail."""
    corners = [
        {"shapes": ("half-sine",), "duration": (time, time), "elevation_deg": (rail, rail)}
        for time, rail in product((0.1, 0.4), (5.0, 35.0))
    ] + [
        {"shapes": ("trapezoid",), "duration": (time, time), "rise": (rise, rise), "elevation_deg": (rail, rail)}
        for time, rise, rail in product((0.1, 0.4), (0.010, 0.040), (5.0, 35.0))
    ]
    figure("of 2000, wrong", [wrong(tried(launches(peak, sigma, **corner), 2000)) for corner in corners], "", 0, 0)


@pytest.mark.parametrize(("sigma", "least"), [(0.05, 0.99), (0.3, 0.99), (1.0, 0.97)])
def test_launches_of_5_g(sigma: float, least: float, figure: Figure) -> None:
    """Of 4000. A detector that is right in 0.5 % less than is asked at 1 g, 0.3 % less at 0.3 g, fails with 95 %."""
    for bump in (False, True):
        verdicts = tried(launches(5.0, sigma, bump=bump), 4000)
        figure("share detected" + ", bump" * bump, [1.0 - wrong(verdicts) / 4000], "", least)
        figure("alarms before the onset" + ", bump" * bump, [int(verdicts.early.sum())], "", 0, 0)


def test_the_shortest_half_sine_of_5_g(figure: Figure) -> None:
    """0.1 s on a rail of 20°, of 2000; 0.6 % less than is asked fails with 95 %."""
    settings = launches(5.0, 0.3, shapes=("half-sine",), duration=(0.1, 0.1), elevation_deg=(20.0, 20.0))
    figure("share detected", [1.0 - wrong(tried(settings, 2000)) / 2000], "", 0.99)


# -- delay -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("sigma", "median", "late"), [
    pytest.param(0.05, 20.0, 32.0, marks=CERTIFY), (0.3, 20.0, 32.0), pytest.param(1.0, 22.0, 42.0, marks=CERTIFY),
])  # fmt: skip
def test_delay_after_the_crossing_of_4_5_g(sigma: float, median: float, late: float, figure: Figure) -> None:
    """Each of 6, 7, 8, 10, 12 and 15 g by itself, 2000 launches with and 2000 without a bump."""
    delays = [1e3 * tried(launches(peak, sigma, bump=b), 2000).since_crossing for b in (False, True) for peak in PEAKS]
    figure("median", [float(np.median(delay)) for delay in delays], "ms", 0, median)
    figure("95th percentile", [float(np.quantile(delay, 0.95)) for delay in delays], "ms", 0, late)


@pytest.mark.parametrize("peak", [5.0, 6.0, *(pytest.param(peak, marks=CERTIFY) for peak in PEAKS[1:])])
def test_delay_after_the_onset_is_near_the_bound(peak: float, figure: Figure) -> None:
    """Trapezoid of 0.1 s, rise 20 ms, rail 20°, σ 0.3 g, 2000 launches: 10 ms above Neyman and Pearson's for P_D 0.5.

    The bound is told shape and onset, and keeps a false-alarm probability of 1e-6 against 4.1 g.
    """
    rise, rail, sigma = 0.020, 20.0, 0.3
    shape: Any = {"shapes": ("trapezoid",), "duration": (0.1, 0.1), "rise": (rise, rise), "elevation_deg": (rail, rail)}
    felt = Stroke("trapezoid", peak * G0, 0.1, rise).force(np.arange(100) / 1000) + G0 * sin(radians(rail))
    bound = earliest_deadline(felt, level=4.1 * G0, sigma=sigma * G0, probability=0.5)
    assert bound is not None
    found = float(np.nanmedian(tried(launches(peak, sigma, **shape), 2000).since_onset))
    figure("median above the bound", [1e3 * (found - bound)], "ms", 0, 10)


# -- against the paper's ---------------------------------------------------------------------------------------------


def test_the_papers_detector_is_beaten(figure: Figure) -> None:
    """On the same 4000 launches: misses at 5 g and 1 g ten times fewer, the late ones at 10 g 2.5 times sooner.

    At no more false alarms: ours has none in 200 h of the mix, see above, so that the paper's cannot have fewer.
    """
    missed = [wrong(tried(launches(5.0, 1.0), 4000, detector=detector)) for detector in (PAPERS, OURS)]
    figure("misses, the paper's over ours", [missed[0] / missed[1]], "", 10)
    delays = [tried(launches(10.0, 1.0), 4000, detector=detector).since_crossing for detector in (PAPERS, OURS)]
    slow = [float(np.nanquantile(delay, 0.95)) for delay in delays]
    figure("95th percentile, the paper's over ours", [slow[0] / slow[1]], "", 2.5)


# -- slow recordings -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sigma", [0.05, 0.3])
@pytest.mark.parametrize(("rate", "median", "late"), [(50.0, 50.0, 65.0), (100.0, 40.0, 50.0), (200.0, 40.0, 50.0)])
def test_recordings_at_low_rates(rate: float, median: float, late: float, sigma: float, figure: Figure) -> None:
    """2000 strokes of the measured catapult, 6.7 g and 0.6 s, at any phase of the samples: none lost or too early."""
    found = 1e3 * delays(OURS, rate, 2000, seed=SEED, sigma_g=sigma)
    assert (found > 0.0).all()
    figure("median after the onset", [float(np.median(found))], "ms", 0, median)
    figure("95th percentile", [float(np.quantile(found, 0.95))], "ms", 0, late)


@pytest.mark.parametrize("rate", [50.0, 100.0, 200.0])
@pytest.mark.parametrize("kind", ["mix", "vibration", "centrifuge"])
def test_alarms_at_low_rates(rate: float, kind: str, figure: Figure, whole: bool) -> None:
    """What is above 0.4 of the rate was filtered off before it was sampled: at most one alarm an hour."""
    hours = 20.0 if whole else 4.0
    (found,) = alarms([OURS], rate, hours, seed=SEED, filtered=True, kind=kind)
    figure(f"alarms in {hours:g} h", [found.count], "", 0, hours)
