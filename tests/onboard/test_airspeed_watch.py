"""What healthy ports do in turns, pulls, turbulence and at speed is no fault: readings built by hand, test by test."""

from types import SimpleNamespace

import numpy as np
import pytest

from uavsim.onboard.airspeed import AidedSettings, NoiseModel
from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.climb import GRAVITY, ClimbTest
from uavsim.onboard.airspeed.frozen import FrozenTest
from uavsim.onboard.airspeed.monitor import CALM, FROZEN, PortMonitor
from uavsim.onboard.airspeed.ports import SHUT_OUT, Ports
from uavsim.onboard.airspeed.watch import SHUT, TotalWatch
from uavsim.onboard.repeats import LEAST

DT = 0.01  # s
WEIGHT, DENSITY = 12.0, 1.2  # Pa/m, kg/m³


def wander(sd, time, size, generator):
    """A first-order process: what gusts do to a port's pressure, Pa."""
    keep, found, value = np.exp(-DT / time), np.empty(size), 0.0
    for k, white in enumerate(generator.standard_normal(size).tolist()):
        value = keep * value + np.sqrt(1.0 - keep * keep) * sd * white
        found[k] = value
    return found


def static_evidence(pressure, lift, *, sd, speed, seed=0):
    """W of static pressures, Pa, and lifts, m/s², read with a noise, Pa."""
    generator = np.random.default_rng(seed)
    test = ClimbTest(sd * sd, float(pressure[0]), 0.2)
    read = pressure + sd * generator.standard_normal(len(pressure))
    return np.array([test.add(p, DT, n, WEIGHT, speed) for p, n in zip(read.tolist(), lift.tolist(), strict=True)])


def turn(bank_deg, readings=2000):
    """Lift of a level turn, m/s²: rolled into in 2 s, held for 6 s, and out of."""
    bank = np.radians(bank_deg) * np.interp(np.arange(readings) * DT, [5.0, 7.0, 13.0, 15.0], [0.0, 1.0, 1.0, 0.0])
    return GRAVITY / np.cos(bank)


@pytest.mark.parametrize("bank", [15.0, 20.0, 22.0, 25.0, 32.0, 55.0])
@pytest.mark.parametrize("pushed", [False, True])
@pytest.mark.parametrize("sd", [0.1, 1.0, 3.7])
def test_a_level_turn_is_no_climb_that_did_not_come(bank, pushed, sd):
    """However quiet the sensor is: below the level, and far from it; after a climb at 12° that ends 2 s before, too."""
    time = np.arange(2000) * DT
    push = np.where((time > 0.5) & (time < 3.5), -2.2 if pushed else 0.0, 0.0)
    climb = np.cumsum(push) * DT
    pressure = -WEIGHT * np.cumsum(climb - climb[-1]) * DT
    assert static_evidence(pressure, turn(bank) + push, sd=sd, speed=32.0).max() < 0.7 * SHUT


def test_a_turn_is_known_by_what_is_beyond_the_offset_of_f_z():
    """An accelerometer known to read 5.7 m/s² too little, and 1.0 m/s² too much of it in a turn: 6.7 m/s² of pull."""
    test = ClimbTest(9.0, 0.0, 9.8)
    test.a = -5.7
    test.add(0.0, 1.0, GRAVITY + 1.0, WEIGHT, 54.0)
    assert test._pull.mean == pytest.approx(6.7)


@pytest.mark.parametrize("speed", [32.0, 80.0, 145.0])
def test_gusts_that_move_a_quiet_static_port_are_no_fault(speed):
    """What a gust of 1 m/s does to a port that is off by 2 % of q, in level flight at that speed, m/s."""
    for seed in range(3):
        generator = np.random.default_rng(seed)
        moved = wander(0.02 * DENSITY * speed, 0.5, 3000, generator)
        lift = GRAVITY + wander(0.7, 0.2, 3000, generator)
        assert static_evidence(moved, lift, sd=0.1, speed=speed, seed=seed).max() < SHUT


@pytest.mark.parametrize("sd", [0.1, 2.7])
def test_a_static_port_that_shuts_in_a_climb_is_known_however_quiet_its_sensor(sd):
    """At 2 m/s of climb, within 1 s."""
    pressure = -WEIGHT * 2.0 * DT * np.minimum(np.arange(1500), 1000)
    found = static_evidence(pressure, np.full(1500, GRAVITY + 0.1), sd=sd, speed=32.0)
    assert found[:1000].max() < SHUT
    assert (found[1000:1100] > SHUT).any()


def test_after_an_acceleration_b_is_known_as_well_as_scale_errors_allow():
    """5 m/s² for 15 s: 2 % of that, 0.1 m/s², as it begins and as it ends; in steady flight b is known to 0.03 m/s²."""
    generator, sd = np.random.default_rng(2), 1.0
    t = np.arange(4000) * DT
    speed = np.interp(t, [15.0, 30.0], [50.0, 125.0])
    test, known, found = FrozenTest(sd * sd, 0.002, False), [], []
    for k in range(1, len(t)):
        reading = 0.5 * DENSITY * speed[k] ** 2 + sd * generator.standard_normal()
        turned = GRAVITY**2 / speed[k] ** 2
        gained = 1.02 * (speed[k] - speed[k - 1]) + (0.1 + 5.0 * turned) * DT
        gust = 7.2e-5 * speed[k] * DT
        found.append(test.add(reading, 0.0, 0.0, gained, DT, DENSITY * speed[k], gust, turned))
        known.append(test.lost_variance**0.5)
    assert max(found) < 0.5 * CALM
    assert known[1490] < 0.03
    assert max(known[1500:1700]) > 0.04
    assert max(known[3000:3200]) > 0.04


@pytest.mark.parametrize(("straight", "shut"), [(True, True), (False, False)])
def test_stillness_in_a_pull_is_no_evidence(straight, shut):
    """Two seconds in which the total pressure stands still: a shut port in straight flight, and nothing in a pull."""
    generator, sd, speed = np.random.default_rng(3), 1.0, 47.0
    gust = 2.0 * 1.0**2 / 200.0 * speed * DT
    still = np.cumsum(np.sqrt(gust) * generator.standard_normal(1200)) * DENSITY * speed
    still[1000:] = still[1000]
    test = FrozenTest(sd * sd, 0.002, True)
    found = [
        test.add(z + sd * e, 0.0, 0.0, 0.0, DT, DENSITY * speed, gust, 0.04, straight or k < 1000)
        for k, (z, e) in enumerate(zip(still.tolist(), generator.standard_normal(1200).tolist(), strict=True))
    ]
    assert (max(found) > FROZEN) == shut


def monitored(nus):
    """At which of the innovations, in standard deviations, a drift is told; none: all of them."""
    monitor = PortMonitor(0.002, 25.0, 0.01, LEAST, True)
    for k, nu in enumerate(nus):
        if monitor.add(1e5 + k, 5.0 * nu, nu * nu, 0.0) == "drift":
            return k
    return len(nus)


def test_a_filter_that_is_narrow_for_long_makes_no_drift_but_a_leak_does():
    """Innovations of four standard deviations for half a minute, and then runs of ±6 for 0.8 s; a leak after 20 s."""
    generator = np.random.default_rng(4)
    white = generator.standard_normal(3000).tolist()
    runs = [6.0 * (-1) ** (k // 80) for k in range(2400)]
    assert monitored([4.0 * e for e in white] + runs) == len(white) + len(runs)
    assert monitored(white + [6.0] * 200) < len(white) + 70


def test_a_gust_that_comes_at_once_is_not_shut_out():
    """After five total pressures beyond the gate V is known less well by a gust that is declared."""
    aided = AidedSettings(gust_sd=1.0)
    ports = Ports(aided, Air(aided, 1.0), NoiseModel(total_sd=1.0, static_sd=1.0, temperature_sd=0.5))

    class Energy:
        widened = 0.0

        def widen_speed(self, variance):
            self.widened += variance

    energy = Energy()
    for k in range(2 * SHUT_OUT):
        ports.gate(energy)
        assert energy.widened == float((k + 1) // SHUT_OUT)


def slides(speed, gained, bias):
    """When, s, a drift is told of airspeeds, m/s, what the force gave for each reading, m/s, and b, m/s²; or None."""
    aided = AidedSettings()
    air = Air(aided, 1.0)
    air.begin(288.15)
    air.density = DENSITY
    watch = TotalWatch(aided, variance=9.0, walk=0.007)
    noise = 3.0 * np.random.default_rng(5).standard_normal(len(speed))
    energy = SimpleNamespace(p=1e5, pp=1.0, s=0.0, vv=0.01, innovation=0.0)
    total = 0.0
    for k in range(1, len(speed)):
        energy.v, energy.b = float(speed[k]), float(bias[k])
        total += float(gained[k])
        reading = 1e5 + 0.5 * DENSITY * energy.v**2 * (1.0 + energy.v**2 / (4.0 * 340.0**2)) + float(noise[k])
        kind = watch.take(energy, k * DT, total, GRAVITY, reading, reading, 0.0, air)
        if kind:
            return kind, k * DT
    return None


def test_an_angle_of_attack_that_stays_is_no_slide():
    """From 37 m/s in 4 s down to 20 m/s and on: c of 11 m makes 1.8 m/s² of b, six of its standard deviations."""
    t = np.arange(3000) * DT
    speed = np.interp(t, [12.0, 16.0], [37.0, 20.0])
    bias = 11.0 * GRAVITY**2 * (speed**-2 - 37.0**-2)
    assert slides(speed, np.gradient(speed) + bias * DT, bias) is None


def test_an_offset_that_stays_is_no_slide():
    """Of 1.7 m/s² at 83 m/s, which b takes up within some seconds."""
    bias = 1.7 * (1.0 - np.exp(-np.arange(3000) * DT / 4.0))
    assert slides(np.full(3000, 83.0), np.full(3000, 1.7 * DT), bias) is None


def test_a_port_that_slides_away_from_the_force_is_told():
    """By 1.8 m/s each second, which b takes up within half a second, from 32 m/s on."""
    t = np.arange(3000) * DT
    slid = np.clip(t - 20.0, 0.0, None)
    kind, when = slides(32.0 - 1.8 * slid, np.zeros(3000), 1.8 * (1.0 - np.exp(-slid / 0.2)))
    assert kind == "drift"
    assert when < 22.0


@pytest.mark.parametrize(("gust", "off"), [(1.0, 11.25), (0.2, 2.25)])
def test_without_a_static_port_the_bar_grows_with_the_gusts(gust, off):
    """15 s after its flag V was 18 m/s off in gusts of 1 m/s, and the filter's own bar 1.5 m/s."""
    aided = AidedSettings(gust_sd=gust)
    ports = Ports(aided, Air(aided, 1.0), NoiseModel(total_sd=1.0, static_sd=1.0, temperature_sd=0.5))
    assert ports.astray(10.0) == 0.0
    ports.static.since = 10.0
    assert ports.astray(10.0) == 0.0
    assert ports.astray(25.0) ** 0.5 == pytest.approx(off)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_sink_that_is_felt_and_not_read_tells_of_a_shut_port(sign):
    """A pull upwards may be a turn's; half a second of 0.6 g less makes the aircraft sink, or the port is shut."""
    time = np.arange(1500) * DT
    lift = GRAVITY + sign * 6.0 * ((time > 6.0) & (time < 6.5))
    found = static_evidence(np.zeros(1500), lift, sd=1.0, speed=32.0)
    assert (found.max() > SHUT) == (sign < 0.0)


def test_on_its_back_nothing_is_felt_that_must_be_read():
    """Half a roll in 1 s, and on at -1 g: what f_z says of the climb is 2 g off then, and the port is sound."""
    time = np.arange(1500) * DT
    rolled = np.clip(time - 6.0, 0.0, 1.0)
    lift, bank = GRAVITY * (1.0 - 2.0 * rolled), np.pi * rolled
    climb = np.cumsum(lift * np.cos(bank) - GRAVITY) * DT
    pressure = -WEIGHT * np.cumsum(climb) * DT
    assert static_evidence(pressure, lift, sd=1.0, speed=32.0).max() < 0.7 * SHUT
