"""The rooms beside the aided filter: air, unfolding wings, a launch's first total pressure, which port is to blame."""

from math import inf, nan

import pytest

from uavsim.onboard.airspeed import AidedSettings, EnergyFilter, NoiseModel
from uavsim.onboard.airspeed.air import Air
from uavsim.onboard.airspeed.onset import Onset
from uavsim.onboard.airspeed.ports import MOST_NEWS, PERSISTENT, Ports
from uavsim.onboard.airspeed.unfolding import Unfolding


def energy(**changes):
    settings = {
        "speed_sd": 1.1, "rest_force": 2.5, "rest_sd": 0.05, "bias_sd": 0.31, "bias_time": 5.3, "slope_rate": 0.7,
        "slope_time": 4.1, "static": 90_000.0, "static_sd": 10.0, "static_walk": 0.33, "difference_sd": 0.2,
        "difference_walk": 0.013, "acceleration_sd": 0.06,
    }  # fmt: skip
    return EnergyFilter(**settings | changes)


# -- air ---------------------------------------------------------------------------------------------------------------


def test_air_is_that_of_the_thermometer_and_the_static_pressure():
    """ρ = p/(R T) with R = 287.05 J/(kg·K) (ISO 2533), 1e-4; 7 R T has the calibration's square in it."""
    air = Air(AidedSettings(), calibration=1.1)
    assert not air.measured
    assert air.temperature == 288.15
    air.begin(260.0)
    assert air.measured
    air.at(80_000.0, 0.0)
    assert air.density == pytest.approx(80_000.0 / (287.05 * 260.0), rel=1e-4)
    assert air.heat == pytest.approx(7.0 * 287.05 * 260.0 * 1.21, rel=1e-4)
    air.warm(300.0)
    air.at(80_000.0, 0.0)
    assert air.density == pytest.approx(80_000.0 / (287.05 * 300.0), rel=1e-4)


def test_airspeed_of_two_pressures():
    """½ρV² at 10 m/s, from which the compressible relation differs by M²/4 = 2e-4; 0 if the total pressure is less."""
    air = Air(AidedSettings(), calibration=1.0)
    density = 101_325.0 / (287.05 * 288.15)
    assert air.speed(101_325.0 + 0.5 * density * 100.0, 101_325.0) == pytest.approx(10.0, rel=2e-4)
    assert air.speed(101_300.0, 101_325.0) == 0.0


def test_gusts_fall_with_the_height_that_the_pressure_tells():
    """60 m above the ground, 10 m being where the gusts are declared: σ_u²/L_u of MIL-F-8785C, h in feet, to 1 %."""
    aided = AidedSettings(gust_sd=2.0, gust_length=150.0, gust_height=10.0)
    air = Air(aided, calibration=1.0)
    air.begin(288.15)
    air.ground = 101_325.0
    air.at(101_325.0 - 60.0 * 9.80665 * 1.2207, 0.0)
    thinner = [(0.177 + 0.000823 * h / 0.3048) ** 0.4 / h for h in (60.0, 10.0)]
    assert air.gust == pytest.approx(2.0 * 4.0 / 150.0 * thinner[0] / thinner[1], rel=0.01)


# -- unfolding ---------------------------------------------------------------------------------------------------------


def test_unfolding_widens_the_speed_while_it_lasts():
    """(0.9 m/s)²/s over what an interval shares with 1.0 … 1.4 s; before, after and without it nothing."""
    wings = Unfolding(AidedSettings(unfolding_time=0.4, unfolding_rate=0.9))
    assert wings.end == -inf
    assert wings.variance(0.0, 10.0) == 0.0
    wings.begin(1.0)
    assert wings.end == pytest.approx(1.4)
    for start, end, share in ((0.5, 0.9, 0.0), (0.9, 1.1, 0.1), (1.1, 1.3, 0.2), (1.3, 1.7, 0.1), (1.5, 2.0, 0.0)):
        assert wings.variance(start, end) == pytest.approx(0.81 * share, abs=1e-12), (start, end)
    wings.forget()
    assert wings.variance(0.0, 10.0) == 0.0


# -- onset -------------------------------------------------------------------------------------------------------------


def launch(wind=0.0, patience=3.0):
    onset = Onset(each=8.0, tare_end=-inf, wind_sd=2.0)
    assert onset.look(None, (0.0, 0.01), 1.2) == 2.0
    onset.wind = wind
    onset.begin(patience)
    air = Air(AidedSettings(), calibration=1.0)
    air.begin(288.15)
    return onset, air


def total(speed, air):
    return 90_000.0 * (1.0 + speed**2 / air.heat) ** 3.5


def test_a_total_pressure_waits_for_three_deviations():
    """V = 3 σ_V is the least, and of either sign V counts: 3.2 and 3.4 m/s at σ = 1.1 m/s; −9 m/s is no push."""
    for v, settled in ((3.2, False), (3.4, True), (-9.0, False)):
        onset, air = launch()
        assert onset.settle(energy(speed=v), 1.0, total(5.0, air), air) is settled
        assert onset.settled is settled


def test_without_a_push_the_pressure_is_believed_at_last():
    """From the patience's end on V is the pressure's, its variance at least V²/9."""
    onset, air = launch(patience=1.5)
    core = energy(speed=0.3)
    assert not onset.settle(core, 1.49, total(6.0, air), air)
    assert onset.settle(core, 1.5, total(6.0, air), air)
    assert core.v == pytest.approx(6.0, rel=1e-9)
    assert core.vv == pytest.approx(4.0, rel=1e-9)


@pytest.mark.parametrize(("true", "after"), [(14.0, 14.0), (6.0, 6.0)])
def test_a_headwind_is_told_from_a_tailwind(true, after):
    """Wind of 4 m/s, a push of 10: V seems 14 m/s. If 6 are read it was a tailwind; the next reading is taken."""
    onset, air = launch(wind=4.0)
    core = energy(speed=14.0)
    first = onset.settle(core, 1.0, total(true, air), air)
    assert first is (true == 14.0)
    assert core.v == after
    assert onset.wind == 0.0
    assert onset.settle(core, 1.0, total(true, air), air)
    assert core.v == after


def test_before_the_push_tells_neither_is_taken():
    onset, air = launch(wind=4.0)
    onset._turning = 8.0
    core = energy(speed=7.0)
    assert not onset.settle(core, 1.0, total(7.0, air), air)
    assert onset.wind == 4.0


# -- ports -------------------------------------------------------------------------------------------------------------


class Watch:
    """Stands in for the watch over a port; `kind` is what its test finds."""

    def __init__(self, kind="", **state):
        self.kind, self.flagged, self.paused, self.faulty = kind, [], 0, False
        self.port = self.frozen = self
        self.lost, self.restarted = 0.07, 0
        self.unsure = self.suspect = self.repeating = self.doubtful = self.undecided = False
        for name, value in state.items():
            setattr(self, name, value)

    def take(self, *arguments):
        self.taken = arguments
        return self.kind

    def flag(self, kind, *_):
        self.flagged.append(kind)
        self.faulty = True

    def restart(self):
        self.restarted += 1

    def pause(self):
        self.paused += 1


def watched(total, static):
    air = Air(AidedSettings(), calibration=1.0)
    air.at(90_000.0, 0.0)
    ports = Ports(AidedSettings(), air, NoiseModel(2.0, 3.0, 0.0))
    ports.total, ports.static = total, static
    ports.seen_total, ports.seen_static = (91_000.0, 91_000.0, 1.3), (90_000.0, 4.99, 9.7)
    return ports


@pytest.mark.parametrize(
    ("kind", "of_static", "unsure", "blamed"),
    [
        ("frozen", {}, False, "total frozen"),
        ("drift", {}, True, "total drift"),
        ("unfit", {}, False, None),
        ("frozen", {"suspect": True}, False, "static frozen"),
        ("unfit", {"suspect": True}, False, "static frozen"),
        ("stuck", {"suspect": True}, False, "total stuck"),
        ("frozen", {"repeating": True}, False, None),
        ("frozen", {"doubtful": True}, True, None),
        ("frozen", {"doubtful": True}, False, "total frozen"),
        ("drift", {"doubtful": True}, True, "total drift"),
    ],
)
def test_which_port_is_to_blame(kind, of_static, unsure, blamed):
    """The rules of `ports`, where the total port's test has fired."""
    total, static = Watch(kind, unsure=unsure), Watch(**of_static)
    ports = watched(total, static)
    ports.judge(5.0, energy(), 4.98, 1.7)
    flags = [f"total {found}" for found in total.flagged] + [f"static {found}" for found in static.flagged]
    assert flags == ([] if blamed is None else [blamed])
    told = [] if blamed is None else [(5.0, "airspeed_fault", *blamed.split())]
    assert ports.news == told
    assert (ports.seen_total, ports.seen_static) == (None, None)


def test_a_static_port_is_flagged_by_its_own_test_or_by_misses():
    """Then the total port is not judged by what a wrong static pressure has made of it, and its test begins anew."""
    for kind, misses, found in (("frozen", 0, "frozen"), ("", PERSISTENT, "jump"), ("", PERSISTENT - 1, None)):
        total, static = Watch(), Watch(kind)
        ports = watched(total, static)
        ports.misses = misses
        ports.judge(5.0, energy(), 4.98, 1.7)
        assert static.flagged == ([found] if found else [])
        assert total.restarted == bool(found)
        assert hasattr(total, "taken") == (found is None)
        assert ports.misses == (0 if found else misses)


def test_missing_forces_let_the_total_ports_tests_begin_anew():
    """The lift of the last reading that had one goes on to the total port's test."""
    ports = watched(Watch(), Watch())
    ports.torn = True
    ports.judge(5.0, energy(), 4.98, 1.7)
    assert (ports.total.paused, ports.torn) == (1, False)
    assert ports.total.taken[3] == 9.7
    ports.seen_total, ports.seen_static = (91_000.0, 91_000.0, 1.3), (90_000.0, 4.99, nan)
    ports.judge(5.01, energy(), 4.99, 1.7)
    assert (ports.total.paused, ports.total.taken[3]) == (1, 9.7)


def test_a_jump_is_flagged_where_it_was():
    """Of both at once the static port is: its flag says why the total pressure jumped, too."""
    for which, flags in (((True, False), (1, 0)), ((False, True), (0, 1)), ((True, True), (0, 1))):
        total, static = Watch(), Watch()
        watched(total, static).jumped(5.0, energy(), (5.0, 0.0), *which)
        assert (len(total.flagged), len(static.flagged)) == flags
    total, static = Watch(), Watch(faulty=True)
    watched(total, static).jumped(5.0, energy(), (5.0, 0.0), True, True)
    assert (total.flagged, static.flagged) == ([], [])


def test_news_are_bounded_and_end_with_the_filter():
    """Constant memory; flags of ports end with a filter that has ended."""
    ports = watched(Watch(faulty=True), Watch())
    for k in range(MOST_NEWS + 10):
        ports.tell(float(k), "airspeed_fault", "total", "drift")
    assert len(ports.news) == MOST_NEWS
    assert ports.news[0][0] == 10.0
    ports.news.clear()
    ports.give_up(80.0, "diverged")
    assert ports.news == [(80.0, "airspeed_fault", "both", "diverged"), (80.0, "airspeed_recovered", "total", "")]
    assert ports.seen_total is None


def test_what_a_flagged_port_says_is_compared_and_doubted_by_that():
    """Total: the pressure's V less V, its variance by the slope ρ V. Static: pressures. Taken back, it is doubted."""
    core = energy(speed=30.0)
    before, p_before = core.vv, core.pp
    ports = watched(Watch(), Watch())
    heard = []
    ports.total.coast = lambda *arguments: bool(heard.append(arguments)) or True
    ports.static.coast = lambda *arguments: bool(heard.append(arguments)) or True
    air = ports._air
    tared = total(32.0, air)
    ports.raw_static = 90_011.0
    ports.hear_total(5.0, core, 4.99, tared + 7.0, tared, 4.5)
    slope = air.density * 32.0
    (reading, pressure, difference, spread, end), = heard  # fmt: skip
    assert (reading, pressure, end) == (tared + 7.0, tared, 4.99)
    assert difference == pytest.approx(2.0, rel=1e-9)
    assert spread == pytest.approx(before + (2.0 * 4.5 + p_before) / slope**2, rel=1e-9)
    assert core.vv == pytest.approx(before + 4.0, rel=1e-9)
    heard.clear()
    ports.hear_static(5.0, core, 4.98, 90_003.0, 3.0)
    assert heard == [(4.98, 90_011.0, 90_003.0, 3.0, p_before + 9.0)]
    assert core.pp == p_before + 9.0
    assert [news[1:3] for news in ports.news] == [("airspeed_recovered", "total"), ("airspeed_recovered", "static")]


def test_a_wind_is_looked_for_where_there_was_a_tare():
    """6 m/s between the tare's end and the launch, in 40 conversions without noise; its bar is that of the noise."""
    difference = 19.8 + 5.0, 8.0 / 40.0
    seen, blind = Onset(8.0, 1.0, 2.0), Onset(8.0, -inf, 2.0)
    assert seen.look(difference, (5.0, 0.01), 1.1) < 0.1
    assert seen.wind == pytest.approx(6.0, rel=1e-3)
    assert blind.look(difference, (5.0, 0.01), 1.1) == 2.0
    assert blind.wind == 0.0
