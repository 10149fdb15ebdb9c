"""The tube and the faults of a port, each alone.

Authorities: Bergh & Tijdeman's equation and its published-form figures (table of gains and resonances at sea level,
σ = 0, k = 1.4), Poiseuille, hydrostatics, the flow through a sharp-edged hole, scipy's first-order hold.
"""

from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete

from sensors.pneumatics import (
    GAS_CONSTANT,
    STANDARD,
    Line,
    SecondOrder,
    bergh_tijdeman,
    laminar_lag,
    second_order,
    steady_until,
    viscosity,
)
from sensors.settings import PortFault, TubeSettings
from sensors.unit import unit_vector

SEA_LEVEL = {"pressure": 101_325.0, "temperature": 288.15}
AFT = (-1.0, 0.0, 0.0)
DT = 1e-3
REST = (0.0, 0.0, -9.80665)
FREE = (0.0, 0.0, 0.0)

# L m, d mm, V mm³ · τ ms · gain at 10, 50, 100 Hz · height and place, Hz, of the resonance
TABLE = [
    ((0.15, 2.0, 50.0), 0.019, (1.00, 1.02, 1.06), (9.1, 479)),
    ((0.30, 2.0, 100.0), 0.077, (1.00, 1.07, 1.30), (6.3, 233)),
    ((0.60, 2.0, 50.0), 0.27, (1.01, 1.27, 3.0), (4.4, 120)),
    ((0.60, 1.0, 50.0), 1.2, (1.01, 1.26, 1.78), (1.8, 95)),
    ((1.0, 1.5, 1000.0), 2.7, (1.05, 1.72, 0.58), (1.9, 43)),
    ((0.30, 0.5, 100.0), 4.5, (0.99, 0.80, 0.53), None),
]


def _tube(length, diameter_mm, volume_mm3):
    return {"length": length, "diameter": diameter_mm * 1e-3, "volume": volume_mm3 * 1e-9, **SEA_LEVEL}


def _gain(lag, inertia, frequency):
    s = 2j * pi * frequency
    return np.abs(1 / (1 + lag * s + inertia * s * s))


# -- the equation ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("shape", "lag", "gains", "peak"), TABLE)
def test_bergh_tijdeman_table(shape, lag, gains, peak):
    """To a unit of the last printed digit."""
    tube = _tube(*shape)
    assert np.abs(bergh_tijdeman([10, 50, 100], **tube)) == pytest.approx(gains, abs=0.011, rel=0.006)
    frequency = np.arange(5.0, 800.0)
    gain = np.abs(bergh_tijdeman(frequency, **tube))
    if peak is None:
        assert gain.max() < 1.0
        assert frequency[np.argmax(gain < np.sqrt(0.5))] == pytest.approx(66, abs=1)
    else:
        assert (gain.max(), frequency[gain.argmax()]) == (
            pytest.approx(peak[0], abs=0.05),
            pytest.approx(peak[1], abs=1),
        )


@pytest.mark.parametrize(("shape", "lag", "gains", "peak"), TABLE)
def test_laminar_lag_table(shape, lag, gains, peak):
    """To a unit of the last printed digit."""
    assert 1e3 * laminar_lag(**_tube(*shape)) == pytest.approx(lag, rel=0.04)


def test_bergh_tijdeman_low_frequency_limit_is_poiseuilles_lag():
    """In a narrow tube the phase at f → 0 is that of the laminar lag, air isothermal in the tube, k in the volume."""
    tube = _tube(0.3, 0.2, 100.0)
    omega = 2 * pi * 1e-3
    delay = -np.angle(bergh_tijdeman(1e-3, **tube)) / omega
    assert delay == pytest.approx(laminar_lag(**tube, polytropic=1.4), rel=1e-3)


def test_viscosity_of_the_standard_atmosphere():
    """ISO 2533: 1.7894e-5 Pa s at 15 °C."""
    assert viscosity(288.15) == pytest.approx(1.7894e-5, rel=1e-4)


# -- its second-order equivalent ---------------------------------------------------------------------------------------

LIMITS = ((0.02, 0.2), (0.05, 0.36), (0.1, 0.55))  # share off up to this share of the natural frequency


@pytest.mark.parametrize("length", [0.05, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("diameter_mm", [0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("volume_mm3", [0.01, 50.0, 1000.0])
def test_equivalent_against_bergh_tijdeman(length, diameter_mm, volume_mm3):
    """As far as the module says that it holds."""
    tube = _tube(length, diameter_mm, volume_mm3)
    lag, inertia = second_order(**tube)
    natural = 1 / (2 * pi * np.sqrt(inertia))
    for off, share in LIMITS:
        frequency = np.linspace(0.01, share, 100) * natural
        assert _gain(lag, inertia, frequency) == pytest.approx(np.abs(bergh_tijdeman(frequency, **tube)), rel=off)
    frequency = np.linspace(0.3, 1.5, 4000) * natural
    exact, ours = np.abs(bergh_tijdeman(frequency, **tube)), _gain(lag, inertia, frequency)
    if exact.max() > 1.5:
        assert ours.max() == pytest.approx(exact.max(), rel=0.05)
        assert frequency[ours.argmax()] == pytest.approx(frequency[exact.argmax()], rel=0.03)


@pytest.mark.parametrize("shape", [row[0] for row in TABLE])
def test_equivalent_has_the_tables_resonances(shape):
    tube, peak = _tube(*shape), {row[0]: row[3] for row in TABLE}[shape]
    frequency = np.arange(5.0, 800.0)
    gain = _gain(*second_order(**tube), frequency)
    if peak is None:
        assert gain.max() < 1.0
    else:
        assert gain.max() == pytest.approx(peak[0], rel=0.055)
        assert frequency[gain.argmax()] == pytest.approx(peak[1], rel=0.025)


def test_equivalent_of_a_narrow_tube_is_the_laminar_lag():
    tube = _tube(1.0, 0.2, 1000.0)
    assert second_order(**tube)[0] == pytest.approx(laminar_lag(**tube, polytropic=1.4), rel=0.02)


@pytest.mark.parametrize(
    ("lag", "inertia"),
    [(1e-4, 1.1e-7), (2e-3, 1e-6), (2e-3 * (1 + 1e-9), 1e-6), (2e-3, 9e-7), (5e-2, 1e-6), (3.0, 1e-7), (1e-3, 1e-5)],
)
def test_steps_are_exact_for_an_input_linear_within_a_step(lag, inertia):
    """Under-, critically and overdamped; authority: scipy.signal.cont2discrete, first-order hold, to 1e-9."""
    num, den, _ = cont2discrete(([1.0], [inertia, lag, 1.0]), DT, method="foh")
    rng = np.random.default_rng(1)
    u = np.concatenate((np.zeros(1), rng.standard_normal(60)))
    expected = np.zeros_like(u)
    for k in range(1, u.size):  # direct form, at rest before
        past = [(u[k - i], expected[k - i]) if k >= i else (0.0, 0.0) for i in range(3)]
        expected[k] = sum(b * x for b, (x, _) in zip(num.ravel(), past, strict=True)) - sum(
            a * y for a, (_, y) in zip(den[1:], past[1:], strict=True)
        )
    tube = SecondOrder(lag, inertia, DT)
    assert [tube.step(x) for x in u.tolist()] == pytest.approx(expected.tolist(), abs=1e-9)


def test_steady_gain_is_one_and_it_begins_at_rest():
    tube = SecondOrder(*second_order(**_tube(0.6, 1.0, 50.0)), DT)
    assert [tube.step(101_325.0) for _ in range(50)] == pytest.approx([101_325.0] * 50, abs=1e-8)


def test_an_input_that_is_no_number_is_forgotten():
    tube = SecondOrder(*second_order(**_tube(0.6, 1.0, 50.0)), DT)
    tube.step(1e5)
    assert np.isnan(tube.step(float("nan")))
    assert tube.step(9e4) == 9e4
    assert tube.step(9e4) == pytest.approx(9e4, abs=1e-8)


# -- the line ----------------------------------------------------------------------------------------------------------

BARE = TubeSettings()
PIPE = TubeSettings(length=0.3, diameter=2e-3, volume=1e-7)


def _line(tube=BARE, faults=(), direction=AFT):
    return Line(tube, direction, faults, DT, **SEA_LEVEL)


def _run(line, count, port=1e5, bay=9e4, force=FREE, start=0):
    """Output of `count` steps; `port` a number or a function of time."""
    return np.array(
        [
            line.step(k * DT, port(k * DT) if callable(port) else port, bay, 288.15, force)
            for k in range(start, start + count)
        ]
    )


def test_without_a_tube_the_port_is_the_sensor():
    assert _run(_line(), 5, port=lambda t: 1e5 + 3e3 * t, force=(80.0, 5.0, -9.8)) == pytest.approx(
        [1e5 + 3e3 * k * DT for k in range(5)], abs=0
    )


def test_a_tube_straight_aft_adds_rho_a_length():
    """0.3 m at 10 g: 36 Pa (at sea level); nothing from other axes."""
    settled = _run(_line(PIPE), 400, port=101_325.0, force=(98.0665, 50.0, -30.0))[-1] - 101_325.0
    rho = 101_325.0 / (GAS_CONSTANT * 288.15)
    assert settled == pytest.approx(rho * 98.0665 * 0.3, rel=1e-6)
    assert settled == pytest.approx(36.0, abs=0.1)


def test_at_rest_a_tube_downwards_adds_the_weight_of_its_air():
    """Hydrostatics: ρ g h at 1 m; the specific force at rest points up."""
    line = _line(replace(PIPE, length=1.0, direction=(0.0, 0.0, 7.0)))
    rho = 101_325.0 / (GAS_CONSTANT * 288.15)
    assert _run(line, 3000, port=101_325.0, force=REST)[-1] - 101_325.0 == pytest.approx(rho * 9.80665, rel=1e-6)


def test_the_tube_answers_as_its_equivalent_does():
    """A 50 Hz tone has, settled, the second-order system's gain, but for the 0.8 % of a tone drawn by lines."""
    tube = _tube(0.6, 1.0, 50.0)
    line = _line(TubeSettings(length=0.6, diameter=1e-3, volume=5e-8))
    out = _run(line, 2000, port=lambda t: 1e5 + 100.0 * np.sin(2 * pi * 50.0 * t))[1000:] - 1e5
    assert np.sqrt(2) * out.std() / 100 == pytest.approx(float(_gain(*second_order(**tube), 50.0)), rel=0.01)
    assert np.sqrt(2) * out.std() / 100 == pytest.approx(float(np.abs(bergh_tijdeman(50.0, **tube))), rel=0.03)


@pytest.mark.parametrize("tube", [BARE, PIPE])
def test_a_blocked_port_holds_its_last_pressure_exactly(tube):
    line = _line(tube, (PortFault("blocked", start=0.1, stop=0.2),))
    out = _run(line, 500, port=lambda t: 1e5 + 2e4 * t, force=(20.0, 0.0, 0.0))
    assert (np.diff(out[:100]) > 0).all()
    assert (out[100:200] == out[99]).all()
    assert out[200] != out[199]
    assert out[499] == pytest.approx(_run(_line(tube), 500, port=lambda t: 1e5 + 2e4 * t, force=(20.0, 0.0, 0.0))[499])


def test_a_tube_fills_again_from_where_it_was_shut_off():
    """Narrow, lag 4.5 ms: no jump to the port's pressure, 63 % of the way after about the lag."""
    narrow = TubeSettings(length=0.3, diameter=0.5e-3, volume=1e-7)
    out = _run(_line(narrow, (PortFault("blocked", start=0.1, stop=0.2),)), 400, lambda t: 1e5 if t < 0.15 else 1.01e5)
    share = (out[199:] - 1e5) / 1e3
    assert share[0] == pytest.approx(0.0, abs=1e-6)
    assert share[1] < 0.35
    assert 0.5 < share[6] < 0.9
    assert share[100] == pytest.approx(1.0, abs=1e-3)


def test_blocked_from_the_start_with_what_is_there():
    assert _run(_line(faults=(PortFault("blocked"),)), 5, port=lambda t: 1e5 + 1e6 * t).tolist() == [1e5] * 5


@pytest.mark.parametrize("tube", [BARE, PIPE])
def test_a_leak_behind_a_blocked_port_decays_with_its_time_constant(tube):
    line = _line(tube, (PortFault("blocked", start=0.1), PortFault("leak", start=0.1, time_constant=0.25)))
    out = _run(line, 1000, port=1e5, bay=9e4)
    t = np.arange(1000) * DT
    after = t >= 0.1
    # it begins from the steady value of the step before: at once, at a tenth of a second
    assert out[after] - 9e4 == pytest.approx(1e4 * np.exp(-(t[after] - 0.099) / 0.25), rel=1e-9)


def _settled(tube, opening, area, port, bay):
    """Pressure that a cavity between port, tube and a leak's hole comes to: its filling, integrated until it rests."""
    section, density = 0.25 * pi * tube.diameter**2, 101_325.0 / (GAS_CONSTANT * 288.15)
    friction = 128.0 * viscosity(288.15) * tube.length / (pi * tube.diameter**4)

    def through(hole, drop):
        return 0.61 * hole * section * np.sign(drop) * np.sqrt(2.0 * abs(drop) / density)

    def into(pressure):
        """Flow through hole and tube, whose losses add up to the drop; found by halving."""
        low, high = 0.0, through(opening, abs(port - pressure))
        for _ in range(100):
            flow = 0.5 * (low + high)
            lost = friction * flow + 0.5 * density * (flow / (0.61 * opening * section)) ** 2
            low, high = (flow, high) if lost < abs(port - pressure) else (low, flow)
        return np.sign(port - pressure) * 0.5 * (low + high)

    def filling(_, pressure):
        return 1.4 * 1e5 / tube.volume * (into(pressure[0]) - through(area, pressure[0] - bay))

    return solve_ivp(filling, (0.0, 0.5), [0.5 * (port + bay)], method="LSODA", rtol=1e-8, atol=1e-6).y[0, -1]


@pytest.mark.parametrize("opening", [1.0, 0.3])
@pytest.mark.parametrize("area", [0.05, 1.0, 3.0])
@pytest.mark.parametrize(
    ("length", "diameter", "impact"), [(0.0, 2e-3, 400.0), (0.3, 2e-3, 400.0), (0.3, 2e-3, -600.0), (0.6, 1e-3, 4000.0)]
)
def test_a_leak_mixes_port_and_bay_as_the_flows_through_both_do(length, diameter, impact, area, opening):
    """What the cavity comes to by its own differential equation: Poiseuille's tube, two sharp-edged holes."""
    tube = TubeSettings(length=length, diameter=diameter, volume=1e-6)
    line = Line(tube, AFT, (PortFault("leak"),), DT, **SEA_LEVEL)
    found = 1e5 + line.share(impact, opening, area) * impact
    assert found == pytest.approx(_settled(tube, opening, area, 1e5 + impact, 1e5), abs=2e-3 * abs(impact))


@pytest.mark.parametrize("tube", [BARE, PIPE])
def test_a_leak_alone_is_felt(tube):
    """Torn off where it is short it halves 600 Pa; 0.3 m of 2 mm take 364, each hole 118. A pinhole takes nothing."""
    torn = _run(_line(tube, (PortFault("leak", start=0.2),)), 500, port=1e5 + 600.0, bay=1e5)
    sound = _run(_line(tube), 500, port=1e5 + 600.0, bay=1e5)
    assert (torn[:200] == sound[:200]).all()
    assert torn[250:] - 1e5 == pytest.approx(300.0 if tube is BARE else 118.1, rel=2e-3)
    pinhole = _run(_line(tube, (PortFault("leak", area=0.0),)), 500, port=1e5 + 600.0, bay=1e5)
    assert pinhole == pytest.approx(sound, abs=0.2)


def test_a_pinhole_and_an_open_port_give_a_steady_mixture_of_two_laminar_flows():
    """τ₀/(T + τ₀) of the way to the bay; τ₀ the laminar lag and the hole's 0.1 ms. A narrow tube: most of the way."""
    narrow = TubeSettings(length=0.3, diameter=0.5e-3, volume=1e-7)
    out = _run(_line(narrow, (PortFault("leak", time_constant=1e-3, area=0.0),)), 500)
    tau = 1e-4 + laminar_lag(length=0.3, diameter=0.5e-3, volume=1e-7, **SEA_LEVEL, polytropic=1.4)
    assert out[-1] == pytest.approx((1e-3 * 1e5 + tau * 9e4) / (1e-3 + tau), abs=1e-6)
    assert out[-1] < 9.3e4


def test_leaks_add_up():
    two = _run(_line(PIPE, (PortFault("leak", time_constant=2e-3, area=0.5),) * 2), 500)
    one = _run(_line(PIPE, (PortFault("leak", time_constant=1e-3, area=1.0),)), 500)
    assert two == pytest.approx(one, abs=1e-6)


def test_a_port_that_ices_while_it_leaks_goes_over_to_the_bay():
    """Half open it leaves 1/(1/g² + 1) = a fifth, shut nothing; no jump on the way."""
    faults = (PortFault("leak"), PortFault("ice", duration=2.0))
    out = _run(_line(BARE, faults), 3000, port=1e5 + 500.0, bay=1e5) - 1e5
    assert out[0] == pytest.approx(250.0, rel=1e-3)
    assert out[1000] == pytest.approx(100.0, rel=0.01)
    assert out[1990:] == pytest.approx(0.0, abs=0.1)
    assert np.abs(np.diff(out)).max() < 1.0


def test_ice_closes_gradually_and_then_holds():
    """A ramp is followed ever later: lag τ₀ (1/g - 1); shut after `duration`."""
    line = _line(PIPE, (PortFault("ice", start=1.0, stop=4.0, duration=2.0),))
    out = _run(line, 4500, port=lambda t: 1e5 + 1e3 * t)
    clear = _run(_line(PIPE), 4500, port=lambda t: 1e5 + 1e3 * t)
    behind = clear - out
    assert behind[:1000] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(behind[1100:3000]) > -1e-9).all()
    assert behind[2999] > 10.0
    half = 1e-4 + laminar_lag(length=0.3, diameter=2e-3, volume=1e-7, **SEA_LEVEL, polytropic=1.4)
    assert behind[2000] == pytest.approx(1e3 * half, rel=0.05)  # g = 1/2: the lag is τ₀
    assert (out[3000:4000] == out[2999]).all()
    assert out[4499] == pytest.approx(clear[4499], abs=1e-6)


def test_ice_grows_only_where_it_is_cold():
    """It is below 0 °C from 1 s to 1.5 s and from 2 s on: of 1 s half has grown at 1.5 s, all of it at 2.5 s."""
    line = _line(PIPE, (PortFault("ice", duration=1.0, stop=3.5, below_temperature=273.15),))
    cold = [265.0 if 1.0 <= k * DT < 1.5 or k >= 2000 else 280.0 for k in range(4000)]
    out = [line.step(k * DT, 1e5 + k * DT * 1e3, 1e5, cold[k], REST) for k in range(4000)]
    clear = _run(_line(PIPE), 4000, port=lambda t: 1e5 + 1e3 * t)
    half = 1e-4 + laminar_lag(length=0.3, diameter=2e-3, volume=1e-7, **SEA_LEVEL, polytropic=1.4)
    behind = clear - out
    assert behind[:1000] == pytest.approx(0.0, abs=1e-2)  # the air's column is of another temperature
    assert behind[1600] == pytest.approx(1e3 * half, abs=0.02)
    assert behind[1999] == pytest.approx(behind[1600], abs=0.01)
    assert len(set(out[2502:3500])) == 1
    assert out[3900] == pytest.approx(clear[3900], abs=0.1)


def test_ice_grows_in_a_cloud_that_is_passed_in_a_descent():
    """Between 300 m and 200 m of pressure height (97 773 and 98 945 Pa), sinking through it at 100 m/s in 1 s."""
    line = _line(BARE, (PortFault("ice", start=0.5, duration=0.5, between_heights=(200.0, 300.0)),))
    heights = 400.0 - 100.0 * np.arange(3000) * DT
    bays = 101_325.0 * (1.0 - heights / 44330.77) ** (1.0 / 0.190263)
    out = np.array([line.step(k * DT, bay + 500.0, bay, 280.0, REST) for k, bay in enumerate(bays.tolist())])
    assert out[:900] == pytest.approx(bays[:900] + 500.0)
    shut = int(np.flatnonzero(out != out[-1])[-1]) + 1
    assert 400.0 - 0.1 * shut == pytest.approx(250.0, abs=1.0)
    never = _line(BARE, (PortFault("ice", duration=0.5, between_heights=(500.0, 600.0)),))
    assert [never.step(k * DT, bay, bay, 280.0, REST) for k, bay in enumerate(bays.tolist())] == bays.tolist()


def test_a_plug_of_water_weighs():
    """5 mm at 80 m/s²: 400 Pa, ρ_w a l, on top of the air's."""
    force = (80.0, 0.0, -9.8)
    wet = _run(_line(PIPE, (PortFault("water", water_length=0.005),)), 3000, force=force)[-1]
    dry = _run(_line(PIPE), 3000, force=force)[-1]
    assert wet - dry == pytest.approx(400.0, rel=1e-6)


def test_a_plug_of_water_slows_the_response():
    """Its inertia lowers the natural frequency to that of mass 4/3 ρ_w A l on the spring γ p A²/(V + V_t/2)."""
    line = _line(replace(BARE, diameter=2e-3, volume=1e-6), (PortFault("water", water_length=0.02),))
    out = _run(line, 2000, port=lambda t: 1e5 if t < 0.5 else 1e5 + 100.0)[500:] - 1e5
    crossings = np.flatnonzero(np.diff(np.sign(out - 100.0)) != 0)
    area = pi * 1e-6
    natural = np.sqrt(1.4 * SEA_LEVEL["pressure"] * area / (4 / 3 * 1000.0 * 0.02 * 1e-6)) / (2 * pi)
    assert 0.5e3 / np.diff(crossings[:9]).mean() == pytest.approx(natural, rel=0.03)


@pytest.mark.parametrize("length", [0.0, 0.4])
def test_a_plug_of_water_rubs_by_poiseuille(length):
    """Behind a ramp of 1000 Pa/s by a₁ 1000 Pa, a₁ of the tube and 128 μ_w l/(πd⁴) · (V + V_t/2)/(γp) of the plug."""
    diameter, volume, plug = 0.5e-3, 1e-6, 0.02
    tube = TubeSettings(length=length, diameter=diameter, volume=volume)
    line = _line(tube, (PortFault("water", water_length=plug),))
    end = 6.0
    behind = 1e5 + 1e3 * end - _run(line, 6001, port=lambda t: 1e5 + 1e3 * t)[-1]
    capacity = (volume + pi * diameter**2 * length / 8.0) / (1.4 * SEA_LEVEL["pressure"])
    lag = 128.0 * 1.0e-3 * plug * capacity / (pi * diameter**4)
    if length:
        lag += second_order(length=length, diameter=diameter, volume=volume, **SEA_LEVEL)[0]
    assert behind == pytest.approx(1e3 * lag, rel=1e-4)
    assert behind > 80.0


def test_water_comes_and_goes():
    line = _line(BARE, (PortFault("water", start=0.1, stop=0.2, water_length=0.01),))
    out = _run(line, 2000, force=(50.0, 0.0, 0.0))
    assert out[:100] == pytest.approx(1e5)
    assert abs(out[100:200] - 1e5).max() > 100
    assert (out[200:] == 1e5).all()


def test_no_number_comes_and_goes_in_every_condition():
    for kind in ("blocked", "leak", "ice", "water"):
        line = _line(PIPE, (PortFault(kind, start=0.03, stop=0.06),))
        out = _run(line, 100, port=lambda t: float("nan") if 0.02 <= t < 0.0205 or 0.045 <= t < 0.0455 else 1e5)
        assert np.isnan(out[20])
        assert np.isfinite(out[61:]).all()


def test_a_direction_without_length_is_refused():
    with pytest.raises(ValueError, match="direction of a tube must be a finite vector other than zero"):
        _line(replace(PIPE, direction=(0.0, 0.0, 0.0)))
    assert unit_vector((3.0, 0.0, 4.0), "it") == pytest.approx((0.6, 0.0, 0.8))


def test_conditions_that_are_no_numbers_make_the_tube_for_sea_level():
    line = Line(PIPE, AFT, (), DT, pressure=float("nan"), temperature=float("nan"))
    assert _run(line, 50) == pytest.approx(_run(_line(PIPE), 50))


KINDS = st.sampled_from(["blocked", "leak", "ice", "water"])
FAULTS = st.builds(
    PortFault,
    kind=KINDS,
    start=st.floats(0, 0.02),
    stop=st.floats(0, 0.05),
    duration=st.floats(0, 3600, exclude_min=True),
    time_constant=st.floats(0, 3600, exclude_min=True),
    area=st.floats(0, 100),
    water_length=st.floats(0, 1, exclude_min=True),
    below_temperature=st.none() | st.floats(150, 400),
    between_heights=st.none() | st.tuples(st.floats(-5000, 11_000), st.floats(-5000, 11_000)),
)
TUBES = st.builds(
    TubeSettings,
    length=st.floats(0, 10),
    diameter=st.floats(1e-4, 0.05),
    volume=st.floats(1e-10, 1e-3),
    direction=st.none() | st.sampled_from([(0.0, 0.0, 1.0), (-1.0, 2.0, 0.5)]),
)


@given(
    tube=TUBES,
    faults=st.lists(FAULTS, max_size=3),
    pressures=st.lists(st.floats(1e3, 2e5), min_size=3, max_size=40),
    axial=st.floats(-1e3, 1e3),
    temperature=st.floats(200, 330),
)
def test_finite_in_finite_out(tube, faults, pressures, axial, temperature):
    line = Line(tube, AFT, faults, DT, pressure=pressures[0], temperature=temperature)
    out = [line.step(k * DT, p, 1e5, temperature, (axial, 3.0, -9.8)) for k, p in enumerate(pressures)]
    assert np.isfinite(out).all()


@given(length=st.floats(1e-6, 10), diameter=st.floats(1e-4, 0.05), volume=st.floats(1e-10, 1e-3))
def test_every_tube_is_stable(length, diameter, volume):
    lag, inertia = second_order(length=length, diameter=diameter, volume=volume, **SEA_LEVEL)
    assert lag > 0.0
    assert inertia > 0.0
    assert exp(-lag) < 1.0


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_plug_of_water_weighs_along_its_tube(axis):
    """5 mm in a tube along each axis of the body: ρ_w a l of the force along it, none of the others."""
    direction = tuple(-1.0 if k == axis else 0.0 for k in range(3))
    force = (80.0, -30.0, 20.0)
    wet = _run(_line(PIPE, (PortFault("water", water_length=0.005),), direction), 3000, force=force)[-1]
    dry = _run(_line(PIPE, (), direction), 3000, force=force)[-1]
    assert wet - dry == pytest.approx(5.0 * force[axis], rel=1e-6)


def test_a_leaking_line_is_well_again_after_one_pressure_that_is_none():
    """The volume forgets what was no number as soon as its tube's end is one."""
    line = _line(BARE, (PortFault("leak", time_constant=0.05),))
    sound = _run(_line(BARE, (PortFault("leak", time_constant=0.05),)), 2000)
    out = _run(line, 2000, port=lambda t: np.nan if abs(t - 0.5) < DT / 2 else 1e5)
    assert np.flatnonzero(np.isnan(out)).tolist() == [500]
    assert out[-1] == pytest.approx(sound[-1], abs=1e-6)


@pytest.mark.parametrize("air", [(1e5, np.nan), (np.nan, 288.0), (np.inf, 288.0), (1e5, 0.0), (0.0, 288.0)])
def test_a_tube_in_no_air_is_that_of_the_standard_air(air):
    """A pressure or a temperature alone that is no number of an air is enough."""
    pressure, temperature = air
    line = Line(PIPE, AFT, (), DT, pressure=pressure, temperature=temperature)
    standard = Line(PIPE, AFT, (), DT, **STANDARD)
    step = {"port": lambda t: 1e5 + 500.0 * (t > 0.01)}
    assert (_run(line, 200, **step) == _run(standard, 200, **step)).all()


def test_a_condition_lasts_until_it_changes():
    ice, leak = PortFault("ice", start=1.0, stop=9.0, duration=2.0), PortFault("leak", start=4.0, time_constant=0.1)
    for t, until in ((0.5, 1.0), (1.0, 1.0), (2.9, 2.9), (3.0, 4.0), (5.0, 9.0), (9.0, 3600.0)):
        assert steady_until((ice, leak), t) == until
