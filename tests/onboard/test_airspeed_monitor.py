"""The watch over the total pressure's port: what is flagged, what is not, and the way back.

Flights are drawn from the filter's own model (`studies.matched`), ports made to fail in them.
"""

from dataclasses import replace

import numpy as np
import pytest

from uavsim.airdata import STANDARD_TEMPERATURE
from uavsim.onboard.airspeed import AidedFilter, AidedSettings, EstimatorSettings
from uavsim.onboard.airspeed.monitor import PortMonitor
from uavsim.studies import matched
from uavsim.studies.matched import COVERED, LATENCY, MODES, REST, MatchedSettings

CALM = EstimatorSettings(kind="aided", wind_sd=0.2)
GUSTY = replace(CALM, wind_sd=1.0, aided=AidedSettings(gust_sd=1.0))
FAILS = 6.0  # s after the launch


def flights(estimator, runs, mode="bmp581 x4", duration=12.0, seed=31):
    settings = MatchedSettings(mode=MODES[mode], runs=runs, duration=duration, seed=seed, estimator=estimator)
    return settings, matched.draw(settings)


def watch(settings, drawn, i, total):
    """Rows of time after the failure, airspeed error, deviation, valid and flag; of flight `i` with `total` read."""
    estimator = AidedFilter(settings.estimator, settings.noise(), COVERED)
    s, found, k = drawn.schedule, [], 0
    for t, force in zip(drawn.courses.t.tolist(), drawn.force_read[i].tolist(), strict=True):
        estimator.accelerometer(t, force, 0.0, 0.0)
        if t >= REST + LATENCY and not estimator.flying:
            estimator.launched(t)
        while k < s.told.size and s.told[k] < t + 1e-3:
            row = estimator.step(
                s.told[k], float(total[k]), float(drawn.static[i, k]), STANDARD_TEMPERATURE, s.total_end[k],
                s.static_end[k],
            )  # fmt: skip
            true = np.interp(s.told[k], drawn.courses.t, drawn.courses.airspeed[i])
            found.append((s.told[k] - REST - FAILS, row[1] - true, row[2], row[6], estimator.port.faulty))
            k += 1
    return np.array(found, dtype=float)


def failed(drawn, i, how, noise, generator):
    """Total pressure of flight `i` as a port reads it that fails at `FAILS`."""
    s, total = drawn.schedule, drawn.total[i].copy()
    bad = s.total_end > REST + FAILS
    if how == "blocked":  # the air in the tube keeps its pressure
        total[bad] = total[~bad][-1] + noise * generator.standard_normal(int(bad.sum()))
    elif how == "stuck":
        total[bad] = total[~bad][-1]
    elif how == "torn":  # the tube is open inside the aircraft
        total[bad] = drawn.static[i, bad] + 30.0
    return total


@pytest.mark.parametrize("air", [CALM, GUSTY], ids=["calm", "gusty"])
@pytest.mark.parametrize("mode", ["ms5611 x4096", "bmp581 x4"])
def test_healthy_ports_are_not_flagged(mode, air):
    """8 flights of 12 s: no flag, and every estimate in flight is valid."""
    settings, drawn = flights(air, 8, mode)
    for i in range(settings.runs):
        rows = watch(settings, drawn, i, drawn.total[i])
        assert not rows[:, 4].any()
        assert rows[rows[:, 0] > 1.0 - FAILS, 3].all()


@pytest.mark.parametrize(("how", "air"), [("blocked", GUSTY), ("stuck", CALM), ("torn", CALM), ("torn", GUSTY)])
def test_failures_are_flagged_and_coasted(how, air):
    """6 flights each: flagged within 2 s, never valid while flagged, an error bar that grows.

    Blocked in the gusts that are declared, by its quiet; stuck by repeating; a torn tube by its distance.
    """
    settings, drawn = flights(air, 6)
    generator = np.random.default_rng(3)
    for i in range(settings.runs):
        rows = watch(settings, drawn, i, failed(drawn, i, how, settings.mode.noise, generator))
        after = rows[rows[:, 0] > 0.0]
        assert not rows[rows[:, 0] < 0.0, 4].any()
        assert after[:, 4].any()
        first = int(np.argmax(after[:, 4] > 0.0))
        assert after[first, 0] < 2.0
        assert not after[after[:, 4] > 0.0, 3].any()
        if how == "torn":
            assert after[-1, 4]
            assert after[-1, 2] > 1.5 * after[first, 2]


def test_recovers_when_the_port_does():
    """A tube that is open for 2 s: flagged, then taken back within 3 s, valid again and within 1 m/s."""
    settings, drawn = flights(CALM, 4)
    for i in range(settings.runs):
        total, s = drawn.total[i].copy(), drawn.schedule
        bad = (s.total_end > REST + FAILS) & (s.total_end < REST + FAILS + 2.0)
        total[bad] = drawn.static[i, bad] + 30.0
        rows = watch(settings, drawn, i, total)
        assert rows[(rows[:, 0] > 0.0) & (rows[:, 0] < 2.0), 4].any()
        late = rows[rows[:, 0] > 5.0]
        assert not late[:, 4].any()
        assert late[:, 3].all()
        assert np.abs(late[:, 1]).max() < 1.0


def test_slow_ice_is_seen_by_the_acceleration_that_is_not():
    """Total pressure that leaks away with 5 s, in calm air: no single innovation is large; flagged within 2 s."""
    settings, drawn = flights(CALM, 4)
    s = drawn.schedule
    bad = s.total_end > REST + FAILS
    share = 1.0 - np.exp(-(s.total_end[bad] - REST - FAILS) / 5.0)
    for i in range(settings.runs):
        total = drawn.total[i].copy()
        total[bad] -= share * (total[bad] - 30.0 - drawn.static[i, bad])
        rows = watch(settings, drawn, i, total)
        flagged = rows[(rows[:, 0] > 0.0) & (rows[:, 4] > 0.0), 0]
        assert flagged.size
        assert flagged[0] < 2.0


# -- the tests by themselves -------------------------------------------------------------------------------------------


def test_white_innovations_raise_nothing():
    """200 000 readings of white ν of variance 1: no flag."""
    monitor = PortMonitor(0.3)
    for k, nu in enumerate(np.random.default_rng(4).standard_normal(200_000).tolist()):
        assert not monitor.add(0.01 * k, 1e5 + nu, 5.0 * nu, nu * nu, 1.0, 0.0)


def test_quiet_counts_only_where_it_is_to_be_seen():
    """ν of a fifth of its deviation: flagged where the reading's noise is 4 % of what is expected, not at 80 %."""
    generator = np.random.default_rng(5)
    for variance, flagged in ((1.0, True), (20.0, False)):
        monitor = PortMonitor(0.3)
        raised = [
            monitor.add(0.01 * k, 1e5 + nu, 5.0 * nu, nu * nu, variance, 0.0)
            for k, nu in enumerate((0.2 * generator.standard_normal(500)).tolist())
        ]
        assert any(raised) is flagged


def test_noiseless_sensor_may_repeat_itself():
    monitor = PortMonitor(0.3)
    assert not any(monitor.add(0.01 * k, 1e5, 0.0, 0.0, 0.0, 0.0) for k in range(1000))


def test_flag_that_comes_back_stays_longer():
    """The time of agreement that takes a flag back doubles when the flag comes back within ten seconds."""
    monitor, times = PortMonitor(0.3), []
    t = 0.0
    for _ in range(3):
        while not monitor.add(t, t, 5.0, 0.0, 1.0, 9.0):  # b far off
            t += 0.01
        begun = t
        while not monitor.coast(t, t, 0.0, 1.0):
            t += 0.01
        times.append(t - begun)
        t += 0.01
    assert times == pytest.approx([1.0, 2.0, 4.0], abs=0.03)
