"""The air-data head: what its bus reads, when, and under the cover."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors import (
    AirDataHead,
    AirDataSettings,
    PressureDescription,
    PressureErrors,
    PressureSettings,
    Streams,
    preset,
    presets,
)
from sensors.settings import (
    Fault,
    PortFault,
    StaticPortSettings,
    ThermalSettings,
    TotalPortSettings,
    TubeSettings,
)

DT = 1e-3


def bare(**chosen):
    """A head whose ports read the truth, but for what is chosen."""
    return AirDataSettings(**({"total_port": ideal_total(), "static_port": ideal_static()} | chosen))


def ideal_total(**chosen):
    return TotalPortSettings(**({"probe": "ideal"} | chosen))


def ideal_static(**chosen):
    return StaticPortSettings(**({"error": 0.0, "error_alpha2": 0.0, "error_beta2": 0.0} | chosen))


QUIET = bare(
    thermal=ThermalSettings(lag=1e-9),  # a die as warm as the air
    total=PressureSettings(preset="bmp581", mode="x1/x1", noise_scale=0.0),
    static=PressureSettings(preset="bmp581", mode="x1/x1", noise_scale=0.0),
)
STEP = 1 / 64  # Pa, of a BMP581


class Around:
    """Surroundings that are a function of time, or a flow that its owner sets."""

    def __init__(self, air=None):
        self.now, self._air = None, air

    def flow(self):
        return self.now

    def air(self, time):
        return self._air(time)


def _fly(head, air, duration, dt=DT):
    """Rows polled while the truth is air(t)."""
    rows, head.surroundings = [], Around(air)
    for k in range(1, round(duration / dt) + 1):
        t1 = k * dt
        if head.due <= t1:
            rows += head.step(t1)
    return np.array(rows)


def _calm(_t):
    return (101_325.0, 101_325.0, 288.15)


def test_polls_come_at_their_own_rate_and_phase():
    rows = _fly(AirDataHead(bare(rate=100.0), Streams(1)), _calm, 2.0)
    phase = rows[0, 0]
    assert 0 <= phase < 0.01
    assert rows[:, 0].tolist() == [phase + k / 100.0 for k in range(200)]


def test_a_row_carries_finished_conversions_and_tells_their_ends():
    """Never from the future, never older than a period; not a number until there is one."""
    settings = bare(rate=1000.0)
    head = AirDataHead(settings, Streams(2))
    rows = _fly(head, _calm, 1.0)
    for value, end, device in ((1, 4, head.total), (2, 5, head.static)):
        missing = np.isnan(rows[:, end])
        assert missing.any()
        assert np.array_equal(missing, np.isnan(rows[:, value]))
        first = np.argmin(missing)
        assert not missing[first:].any()
        age = rows[first:, 0] - rows[first:, end]
        assert age.min() >= 0
        assert age.max() <= 1 / (200 * (1 + device.rate_error)) + 1e-12


def test_a_value_polled_again_is_the_same_with_the_same_end():
    """A BMP390 at 200 Hz polled at 1 kHz: each value five times or so."""
    rows = _fly(AirDataHead(bare(rate=1000.0), Streams(3)), _calm, 1.0)[20:]
    new = np.diff(rows[:, 4]) > 0
    assert new.sum() == pytest.approx(0.98 * 200, abs=15)
    assert np.array_equal(rows[1:][~new, 1], rows[:-1][~new, 1])


def test_the_pair_is_not_simultaneous_and_each_clock_drifts_its_own_way():
    rows = _fly(AirDataHead(bare(), Streams(4)), _calm, 3.0)[5:]
    apart = rows[:, 4] - rows[:, 5]
    assert np.ptp(apart) > 1e-3


def test_values_are_the_truth_of_the_middle_of_the_conversion():
    """A ramp in total, static and temperature, noise off, an ideal unit: to a step of the reading."""

    def ramp(t):
        return (101_325 + 1000 * t, 101_325 - 200 * t, 288.15 + 2 * t)

    head = AirDataHead(QUIET, Streams(5), unit="ideal")
    rows = _fly(head, ramp, 0.5)[5:]
    half = 0.5e-3
    drift = 0.3  # Pa: half a second of random walk and Gauss-Markov drift is 0.05 Pa at 1 sigma
    assert rows[:, 1] == pytest.approx(101_325 + 1000 * (rows[:, 4] - half), abs=STEP + drift)
    assert rows[:, 2] == pytest.approx(101_325 - 200 * (rows[:, 5] - half), abs=STEP + drift)
    assert rows[:, 3] == pytest.approx(288.15 + 2 * (rows[:, 5] - half), abs=1e-4)


def test_rows_do_not_depend_on_the_plants_step():
    """Linear truth: a step of 4 ms, with several events in it, gives what one of 0.5 ms gives."""

    def ramp(t):
        return (101_325 + 500 * t, 101_325 - 100 * t, 288.15 + t)

    fine = _fly(AirDataHead(bare(), Streams(6)), ramp, 1.0, dt=5e-4)
    coarse = _fly(AirDataHead(bare(), Streams(6)), ramp, 1.0, dt=4e-3)
    assert coarse == pytest.approx(fine, abs=1e-9, nan_ok=True)


def test_the_cover_hides_the_wind_until_it_is_off():
    """Both ports feel the static pressure: 250 Pa of wind appear with the first conversion after the cover."""
    head = AirDataHead(QUIET, Streams(7), covered_until=0.5, unit="ideal")
    rows = _fly(head, lambda t: (101_575.0, 101_325.0, 288.15), 1.0)[5:]
    middle = rows[:, 4] - 0.5e-3
    covered = middle < 0.5
    assert 40 < covered.sum() < 60
    assert rows[covered, 1] == pytest.approx(101_325.0, abs=0.5)
    assert rows[~covered, 1] == pytest.approx(101_575.0, abs=0.5)
    assert rows[:, 2] == pytest.approx(101_325.0, abs=0.5)


@pytest.mark.parametrize("tube", [0.0, 0.05])
def test_a_cover_left_on_hides_the_wind_for_good(tube):
    settings = _quiet(cover_left_on=True, pipe=tube)
    head = AirDataHead(settings, Streams(7), covered_until=0.5, unit="ideal")
    flow = _flow(total=101_925.0, force=(0.0, 0.0, 0.0))
    rows = _tell(head, flow, 2.0) if head.full else _fly(head, lambda t: flow[:3], 2.0)
    assert rows[5:, 1:3] == pytest.approx(101_325.0, abs=0.01)


def test_swapped_tubes_bring_each_pressure_to_the_other_sensor():
    """The airspeed's difference is negative. Each port keeps its own tube and faults."""
    blocked = ideal_static(faults=(PortFault("blocked", start=0.3),))
    settings = _quiet(swapped_tubes=True, static_port=blocked)
    head = AirDataHead(settings, Streams(1), covered_until=0.1, unit="ideal")
    rows = _tell(head, lambda t: _flow(total=101_925.0 - 100.0 * t, static=101_325.0 - 100.0 * t), 1.0)[5:]
    late = rows[:, 4] > 0.35
    assert rows[late, 1] == pytest.approx(101_325.0 - 100.0 * 0.299, abs=1e-6)
    assert rows[late, 2] == pytest.approx(101_925.0 - 100.0 * rows[late, 5], abs=1.0)
    assert AirDataHead(QUIET, Streams(1)).full is False
    assert AirDataHead(replace(QUIET, swapped_tubes=True), Streams(1)).full is True


def test_both_ports_ice_at_once():
    settings = _quiet(port_faults=(PortFault("ice", start=0.2, duration=0.2),))
    head = AirDataHead(settings, Streams(1), unit="ideal")
    rows = _tell(head, lambda t: _flow(total=101_925.0 - 500 * t, static=101_325.0 - 500 * t), 1.0)[5:]
    shut = rows[:, [4, 5]].min(axis=1) > 0.41
    assert np.ptp(rows[shut, 1]) == np.ptp(rows[shut, 2]) == 0.0
    assert rows[-1, 1] - rows[-1, 2] == pytest.approx(600.0, abs=0.5)
    assert rows[-1, 2] == pytest.approx(101_325.0 - 500 * 0.4, abs=20.0)  # nearly shut it lags


def test_the_thermometer_breaks_by_itself():
    """Not a number, silent, out of range: the pressures stay, and silence leaves the last value on the bus."""
    faults = (
        Fault("invalid", start=0.2, stop=0.3),
        Fault("dropout", start=0.4, stop=0.5),
        Fault("dead", start=0.6, stop=0.7, size=1000.0),
    )
    settings = replace(QUIET, thermometer_faults=faults)
    rows = _fly(AirDataHead(settings, Streams(3), unit="ideal"), lambda t: (101_925.0, 101_325.0, 280.0 + 10 * t), 1.0)
    sound = _fly(AirDataHead(QUIET, Streams(3), unit="ideal"), lambda t: (101_925.0, 101_325.0, 280.0 + 10 * t), 1.0)
    t = rows[:, 0]
    assert (rows[:, [1, 2, 4, 5]][5:] == sound[:, [1, 2, 4, 5]][5:]).all()
    assert np.isnan(rows[(t >= 0.2) & (t < 0.3), 3]).all()
    silent = rows[(t >= 0.4) & (t < 0.5), 3]
    assert len(set(silent)) == 1
    assert silent[0] == sound[t < 0.4, 3][-1]
    assert set(rows[(t >= 0.6) & (t < 0.7), 3]) == {1000.0}
    assert (rows[t >= 0.7, 3] == sound[t >= 0.7, 3]).all()


def test_no_cover_by_default():
    rows = _fly(AirDataHead(QUIET, Streams(7), unit="ideal"), lambda t: (101_575.0, 101_325.0, 288.15), 0.2)[5:]
    assert rows[:, 1] == pytest.approx(101_575.0, abs=0.5)


def test_temperature_is_the_static_sensors():
    head = AirDataHead(bare(), Streams(8))
    rows = _fly(head, _calm, 1.0)[5:]
    assert rows[:, 3].mean() == pytest.approx(288.15 + head.static.temperature_offset, abs=0.01)
    assert head.static.temperature_offset != head.total.temperature_offset


def test_each_sensor_is_as_its_own_settings_say():
    settings = bare(
        total=PressureSettings(preset="bmp581", mode="x4/x1", offset_pa=40.0),
        static=PressureSettings(preset="bmp390", mode="x8/x1", iir=4),
    )
    head = AirDataHead(settings, Streams(9), unit="ideal")
    assert head.total.description.mode.name == "x4/x1"
    assert head.total.offset == 40.0
    assert (head.static.description.name, head.static.description.iir) == ("bmp390", 4)


def test_two_sensors_of_a_kind_are_two_units_with_independent_noise():
    """n = 2000 pairs; correlation below 4/√n by chance but for 6 in 100 000."""
    head = AirDataHead(replace(bare(), rate=100.0), Streams(10))
    rows = _fly(head, _calm, 20.0)[5:]
    assert head.total.offset != head.static.offset
    assert abs(np.corrcoef(rows[:, 1], rows[:, 2])[0, 1]) < 4 / np.sqrt(len(rows))


# -- told of each step -------------------------------------------------------------------------------------------------

SILENT = PressureErrors(drift=0.0, random_walk=0.0, quantisation=False)
LEVEL = (0.0, 0.0, -9.80665)
RHO = 101_325.0 / (287.05287 * 288.15)  # kg/m³, of the calm air below


def _quiet(mode="x1/x1", **more):
    """A pair of BMP390 without noise, drift and steps."""
    sensor = PressureSettings(mode=mode, noise_scale=0.0, errors=SILENT)
    return replace(bare(total=sensor, static=sensor, thermal=ThermalSettings(lag=1e-9)), **more)


FEELING = _quiet(acceleration_sensitivity=True)
SHAKEN = bare(acceleration_sensitivity=True)  # as the parts come


def _flow(total=101_325.0, static=101_325.0, temperature=288.15, *, angles=(0.0, 0.0), throttle=0.0, force=LEVEL):
    return (total, static, temperature, 0.1, *angles, throttle, *force)


def _tell(head, flow, duration, dt=DT):
    """Rows polled by a head that is told of each step; `flow` one flow or a function of time."""
    rows, head.surroundings = [], Around()
    for k in range(round(duration / dt) + 1):
        *head.surroundings.now, fx, fy, fz = flow(k * dt) if callable(flow) else flow
        head.feel(k * dt, (fx, fy, fz))
        if head.due <= k * dt:
            rows += head.step(k * dt)
    return np.array(rows)


BLOCKED = (PortFault("blocked", start=0.2),)
REASONS = [
    _quiet(pipe=0.05),
    _quiet(total_port=ideal_total(probe="kiel")),
    _quiet(total_port=ideal_total(slipstream=0.1)),
    _quiet(total_port=ideal_total(tube=TubeSettings(length=0.1))),
    _quiet(total_port=ideal_total(faults=BLOCKED)),
    _quiet(static_port=ideal_static(error=0.01)),
    _quiet(static_port=ideal_static(tube=TubeSettings(length=0.1))),
    _quiet(static_port=ideal_static(faults=BLOCKED)),
]


@pytest.mark.parametrize("choice", REASONS)
def test_anything_between_air_and_sensors_makes_a_head_full(choice):
    assert AirDataHead(choice, Streams(1), unit="ideal").full


def test_a_bare_pair_need_not_be_told():
    assert not AirDataHead(bare(), Streams(1)).full
    assert not AirDataHead(FEELING, Streams(1), unit="ideal").full  # nothing is felt by its membranes
    assert AirDataHead(FEELING, Streams(1), unit="typical").full
    sensors = PressureSettings(errors=PressureErrors(acceleration=0.0))
    assert not AirDataHead(bare(total=sensors, static=sensors, acceleration_sensitivity=True), Streams(1)).full


def test_a_head_that_is_told_nothing_reads_no_number():
    for head in (AirDataHead(bare(), Streams(1)), AirDataHead(_quiet(pipe=0.05), Streams(1))):
        rows = np.array(head.step(1.0))
        assert len(rows) == 100
        assert np.isnan(rows[:, 1:4]).all()


def test_each_sensors_unit_is_its_own_settings():
    settings = bare(total=PressureSettings(unit="ideal"), static=PressureSettings(unit="typical"))
    head = AirDataHead(settings, Streams(1))
    assert (head.total.offset, head.static.offset) == (0.0, 50.0)
    assert AirDataHead(settings, Streams(1), unit="ideal").static.offset == 0.0


def test_rate_errors_and_normals_are_the_settings():
    sensor = PressureSettings(rate_error_percent=5.0, normal=(0.0, 2.0, 0.0))
    head = AirDataHead(bare(total=sensor), Streams(1), unit="typical")
    assert head.total.acceleration == (0.0, 0.2, 0.0)
    assert head.static.acceleration == (0.0, 0.0, 0.2)
    assert 2 * head.total.half_window == pytest.approx(4.82e-3 / (1 + 0.02 + 0.05))


@pytest.mark.parametrize("mode", ["x1/x1", "x8/x1", "x32/x2"])
def test_both_ways_agree_on_a_ramp(mode):
    """The mean of a ramp is its middle: a probe in a straight flow changes nothing. Noise and drift as they come."""

    def air(t):
        return (101_325 + 900 * t, 101_325 - 90 * t, 288.15)

    sensor = PressureSettings(mode=mode, errors=PressureErrors(acceleration=0.0, quantisation=False))
    settings = bare(total=sensor, static=sensor)
    open_ = AirDataHead(settings, Streams(6))
    told = AirDataHead(replace(settings, total_port=ideal_total(probe="kiel")), Streams(6))
    assert (open_.full, told.full) == (False, True)
    rows = _tell(told, lambda t: (*air(t), 0.1, 0.0, 0.0, 0.0, *LEVEL), 1.0)
    assert rows == pytest.approx(_fly(open_, air, 1.0), abs=1e-7, nan_ok=True)


@pytest.mark.parametrize("mode", ["x1/x1", "x8/x1", "x32/x2"])
@pytest.mark.parametrize("frequency", [7.3, 50.0, 150.0])
def test_a_conversion_is_the_mean_over_its_window(mode, frequency):
    """A tone: its closed form A sin(2πft) sinc(fT), to what a tone is less when drawn by lines, 2(2πf Δt)²/12 of A.

    And to 1e-6 Pa the integral of the very lines.
    """
    amplitude = 500.0

    def total(t):
        return 101_325.0 + amplitude * np.sin(2 * np.pi * frequency * t)

    head = AirDataHead(_quiet(mode, total_port=ideal_total(probe="kiel")), Streams(8), unit="ideal")
    window = 2 * head.total.half_window
    rows = _tell(head, lambda t: _flow(total=float(total(t))), 1.0)
    rows = rows[np.isfinite(rows[:, 4])]
    ends = rows[:, 4]
    closed = amplitude * np.sin(2 * np.pi * frequency * (ends - window / 2)) * np.sinc(frequency * window)
    assert rows[:, 1] - 101_325.0 == pytest.approx(closed, abs=amplitude * (2 * np.pi * frequency * DT) ** 2 / 6)
    steps = np.arange(1001) * DT
    integral = np.concatenate(([0.0], np.cumsum(0.5 * DT * (total(steps[1:]) + total(steps[:-1])))))

    def up_to(t):
        k = np.minimum((t / DT).astype(int), 999)
        w = t / DT - k
        here, there = total(steps[k]), total(steps[k + 1])
        return integral[k] + DT * w * (here + 0.5 * w * (there - here))

    assert rows[:, 1] == pytest.approx((up_to(ends) - up_to(ends - window)) / window, abs=1e-6)


def test_conversions_made_before_the_poll_are_the_same(monkeypatch):
    """A head that is polled once in 2.5 s remembers no more than it needs; with a filter, that is every conversion."""
    for iir in (0, 4):
        settings = bare(total=PressureSettings(iir=iir), static=PressureSettings(iir=iir), rate=0.4, pipe=0.05)
        monkeypatch.setattr("sensors.head.MOST_REMEMBERED", 10**9)
        at_once = _tell(AirDataHead(settings, Streams(2)), _flow(), 8.0)
        monkeypatch.setattr("sensors.head.MOST_REMEMBERED", 64)
        head = AirDataHead(settings, Streams(2))
        assert _tell(head, _flow(), 8.0) == pytest.approx(at_once, abs=1e-9, nan_ok=True)
        assert len(at_once) == 3
        assert len(head._total_felt) <= 80  # what is under way, and what was before
        assert len(head._static_felt) <= 80


@pytest.mark.parametrize(("force", "total", "static"), [((100.0, 0.0, 0.0), 1, 0), ((0.0, 0.0, 100.0), 0, 1)])
def test_membranes_at_right_angles_do_not_feel_the_same(force, total, static):
    """The push along x shifts the total sensor by 0.2 Pa/(m/s²), a typical unit's, and leaves the static one alone."""
    still, pushed = (
        _tell(AirDataHead(FEELING, Streams(1), unit="typical"), _flow(force=f), 0.2)[5:] for f in ((0, 0, 0), force)
    )
    felt = 0.2 * 100.0 * (1 + 3e-4)  # with a typical unit's scale error
    assert pushed[:, 1] - still[:, 1] == pytest.approx(felt * total, abs=1e-8)
    assert pushed[:, 2] - still[:, 2] == pytest.approx(felt * static, abs=1e-8)
    assert np.array_equal(pushed[:, 3:], still[:, 3:])


def test_nothing_is_felt_across_a_membrane():
    still, shaken = (
        _tell(AirDataHead(FEELING, Streams(1), unit="typical"), _flow(force=f), 0.2)[5:]
        for f in ((0.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    )
    assert np.array_equal(still, shaken)


def test_vibration_averages_over_the_window():
    """A tone of 10 m/s² at 300 Hz on a membrane of 0.2 Pa/(m/s²): of its 2 Pa the window of 4.7 ms leaves sinc(fT).

    Drawn by lines between steps of 1 ms the tone has sinc²(f Δt) of its height, and an image at 700 Hz.
    """

    def flow(t):
        return _flow(force=(10.0 * np.sin(2 * np.pi * 300.0 * t), 0.0, 0.0))

    head = AirDataHead(FEELING, Streams(1), unit="typical")
    rows = _tell(head, flow, 2.0)[5:]
    window = 2 * head.total.half_window
    middle = rows[:, 4] - window / 2
    tones = [trig(2 * np.pi * f * middle) for f in (300.0, 700.0) for trig in (np.sin, np.cos)]
    fitted, *_ = np.linalg.lstsq(np.column_stack([*tones, np.ones_like(middle)]), rows[:, 1], rcond=None)
    tone, image = (2.0 * np.sinc(f * window) * np.sinc(f * DT) ** 2 for f in (300.0, 700.0))
    assert fitted[:4] == pytest.approx([tone, 0.0, -image, 0.0], abs=1e-3)


def test_a_pipe_adds_the_weight_of_its_air():
    """The published head's 5 cm against none: in the push, ρ a L = 4.9 Pa at 80 m/s² on the total sensor."""
    push = _flow(force=(80.0, 0.0, -9.80665))
    bare, piped = (
        _tell(
            AirDataHead(_quiet(total_port=ideal_total(probe="kiel"), pipe=pipe), Streams(1), unit="ideal"),
            push,
            0.5,
        )
        for pipe in (0.0, 0.05)
    )
    assert (piped - bare)[20:, 1] == pytest.approx(RHO * 80.0 * 0.05, rel=1e-5)
    assert (piped - bare)[20:, 2] == pytest.approx(RHO * 9.80665 * 0.05, rel=1e-4)  # straight down


def test_a_pipe_replaces_both_tubes_and_keeps_their_directions():
    aft, up = TubeSettings(length=3.0), TubeSettings(length=2.0, direction=(0.0, 0.0, -1.0))
    settings = _quiet(total_port=ideal_total(tube=aft), static_port=ideal_static(tube=up), pipe=0.1)
    rows = _tell(AirDataHead(settings, Streams(1), unit="ideal"), _flow(force=(50.0, 0.0, -9.80665)), 0.5)[20:]
    assert rows[:, 1] - 101_325.0 == pytest.approx(RHO * 50.0 * 0.1, rel=1e-4)
    assert rows[:, 2] - 101_325.0 == pytest.approx(-RHO * 9.80665 * 0.1, rel=1e-4)


def test_ports_errors_reach_the_readings():
    port = ideal_total(probe="plain", slipstream=0.5)
    settings = _quiet(total_port=port, static_port=ideal_static(error=0.1))
    flow = _flow(total=101_925.0, angles=(np.radians(20.0), 0.0), throttle=1.0)
    rows = _tell(AirDataHead(settings, Streams(1), unit="ideal"), flow, 0.2)[5:]
    assert rows[:, 1] == pytest.approx(101_325.0 + 600.0 * 1.5 * 0.99, abs=1e-6)
    assert rows[:, 2] == pytest.approx(101_325.0 + 60.0, abs=1e-6)


def test_the_cover_hides_wind_and_position_error_alike():
    port, tube = ideal_total(probe="plain"), TubeSettings(length=0.05)
    settings = _quiet(total_port=port, static_port=ideal_static(error=0.1, tube=tube))
    head = AirDataHead(settings, Streams(7), covered_until=0.5, unit="ideal")
    rows = _tell(head, _flow(total=101_575.0, force=(0.0, 0.0, 0.0)), 1.0)[5:]
    covered = rows[:, [4, 5]].max(axis=1) < 0.5
    later = rows[:, [4, 5]].min(axis=1) > 0.52
    assert 40 < covered.sum() < 60
    assert rows[covered, 1:3] == pytest.approx(101_325.0, abs=1e-6)
    assert rows[later, 1] == pytest.approx(101_575.0, abs=1e-6)
    assert rows[later, 2] == pytest.approx(101_350.0, abs=0.01)


def test_a_blocked_total_port_holds_while_the_static_pressure_goes_on():
    settings = _quiet(total_port=ideal_total(faults=(PortFault("blocked", start=0.3, stop=0.6),)))
    head = AirDataHead(settings, Streams(1), unit="ideal")
    rows = _tell(head, lambda t: _flow(total=101_925.0 - 500 * t, static=101_325.0 - 500 * t), 1.0)[5:]
    held = (rows[:, 4] > 0.31) & (rows[:, 4] < 0.6)
    assert rows[held, 1] == pytest.approx(101_925.0 - 500 * 0.299, abs=1e-6)
    assert (np.diff(rows[held, 2]) < 0).all()
    after = rows[:, 4] > 0.61
    assert rows[after, 1] == pytest.approx(101_925.0 - 500 * (rows[after, 4] - 0.00241), abs=1e-6)


@pytest.mark.parametrize("pipe", [0.0, 0.05])
def test_the_thermometer_reads_a_die_that_is_warmer_than_the_air(pipe):
    settings = _quiet(pipe=pipe, thermal=ThermalSettings(self_heating=5.0))
    head = AirDataHead(settings, Streams(1), unit="ideal")
    rows = _tell(head, _flow(), 0.2) if head.full else _fly(head, _calm, 0.2)
    assert rows[5:, 3] == pytest.approx(293.15, abs=1e-6)


def test_clocks_run_free_and_rows_tell_their_conversions():
    """Told of each step as well: ends are the sensors' own, never of the future, and not simultaneous."""
    rows = _tell(AirDataHead(SHAKEN, Streams(4)), _flow(), 3.0)[5:]
    age = rows[:, :1] - rows[:, 4:]
    assert age.min() >= 0
    assert age.max() < 0.006
    assert np.ptp(rows[:, 4] - rows[:, 5]) > 1e-3
    assert rows[:, 0] == pytest.approx(rows[0, 0] + np.arange(len(rows)) / 100.0)


@pytest.mark.parametrize("iir", [0, 4])
@pytest.mark.parametrize("port", [ideal_total(), ideal_total(probe="plain", tube=TubeSettings(length=0.3))])
def test_air_that_is_no_number_is_read_so_and_forgotten(iir, port):
    """Told of each step: NaN while it lasts, a number one conversion later; the temperature is that of the poll."""
    sensor = PressureSettings(iir=iir)
    head = AirDataHead(replace(SHAKEN, total=sensor, static=sensor, total_port=port), Streams(3))
    rows = _tell(head, lambda t: (float("nan"),) * 10 if 0.3 <= t < 0.4 else _flow(), 1.0)
    starts, ends = rows[:, 4] - 2 * head.total.half_window, rows[:, 4]
    assert np.isnan(rows[(ends > 0.3) & (starts < 0.399), 1]).all()
    assert np.isfinite(rows[(starts > 0.4) | (ends < 0.289), 1]).all()
    assert np.isfinite(rows[-1]).all()


@pytest.mark.parametrize("iir", [0, 4])
def test_air_that_is_no_number_comes_and_goes_in_a_bare_head(iir):
    head = AirDataHead(bare(total=PressureSettings(iir=iir)), Streams(3), unit="ideal")
    rows = _fly(head, lambda t: (float("nan"),) * 3 if 0.3 <= t < 0.4 else _calm(t), 1.0)
    assert np.isnan(rows[(rows[:, 4] > 0.305) & (rows[:, 4] < 0.4), 1]).all()
    assert np.isfinite(rows[-50:]).all()


@pytest.mark.parametrize("unit", ["random", "ideal"])
def test_a_second_head_changes_no_draw(unit):
    alone = _tell(AirDataHead(bare(pipe=0.05), Streams(5), unit=unit), _flow(), 0.5)
    streams = Streams(5)
    other = AirDataHead(SHAKEN, streams, name="spare")
    head = AirDataHead(bare(pipe=0.05), streams, unit=unit)
    spare = _tell(other, _flow(), 0.5)
    assert np.array_equal(_tell(head, _flow(), 0.5), alone, equal_nan=True)
    assert not np.array_equal(spare, alone, equal_nan=True)


def test_a_head_polled_by_nobody_in_between_draws_the_same():
    """One polled at 1 kHz sees the conversions that one polled at 100 Hz sees, and others."""
    often = _tell(AirDataHead(replace(SHAKEN, rate=1000.0), Streams(9)), _flow(), 1.0)
    rarely = _tell(AirDataHead(SHAKEN, Streams(9)), _flow(), 1.0)
    values = dict(often[:, [4, 1]].tolist())
    assert all(values[end] == value for end, value in rarely[5:, [4, 1]].tolist())


def test_a_tube_whose_direction_has_no_length_is_refused_at_once():
    tube = TubeSettings(length=0.1, direction=(0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="direction of a tube"):
        AirDataHead(_quiet(total_port=ideal_total(tube=tube)), Streams(1))
    with pytest.raises(ValueError, match="normal of a membrane"):
        AirDataHead(bare(total=PressureSettings(normal=(0.0, 0.0, 0.0))), Streams(1))


# -- anything ----------------------------------------------------------------------------------------------------------


def _span(low, high, **more):
    return st.floats(low, high, **more)


ABOVE_0 = {"exclude_min": True}
VECTORS = st.none() | st.tuples(*[_span(-10, 10)] * 3).filter(lambda v: max(map(abs, v)) > 1e-100)
START_STOP = {"start": _span(0, 0.06), "stop": _span(0, 0.08)}
PORT_FAULTS = st.lists(
    st.builds(
        PortFault,
        kind=st.sampled_from(["blocked", "leak", "ice", "water"]),
        **START_STOP,
        duration=_span(1e-6, 3600),
        time_constant=_span(1e-6, 3600),
        area=_span(0, 100),
        below_temperature=st.none() | _span(150, 400),
        water_length=_span(1e-6, 1),
    ),
    max_size=2,
).map(tuple)
TUBES = st.builds(
    TubeSettings, length=_span(0, 10), diameter=_span(1e-4, 0.05), volume=_span(1e-10, 1e-3), direction=VECTORS
)
TOTAL_PORTS = st.builds(
    TotalPortSettings,
    probe=st.sampled_from(["ideal", "plain", "bevelled", "kiel"]),
    slipstream=_span(-0.9, 5),
    tube=TUBES,
    faults=PORT_FAULTS,
)
STATIC_PORTS = st.builds(
    StaticPortSettings,
    error=_span(-1, 1),
    error_alpha=_span(-10, 10),
    error_alpha2=_span(-100, 100),
    error_beta2=_span(-100, 100),
    error_mach2=_span(-10, 10),
    slipstream=_span(-0.9, 5),
    tube=TUBES,
    faults=PORT_FAULTS,
)
CHOICES = [
    {"preset": name, "mode": mode.name, "iir": coefficient}
    for name in presets()
    if type(preset(name)) is PressureDescription
    for mode in preset(name).modes
    for coefficient, _ in preset(name).iir_weights
]
FACTORS = _span(0, 1000)
SENSORS = st.builds(
    lambda choice, **more: PressureSettings(**choice, **more),
    choice=st.sampled_from(CHOICES),
    errors=st.builds(
        PressureErrors,
        offset=FACTORS,
        solder=FACTORS,
        scale=FACTORS,
        temperature=FACTORS,
        acceleration=FACTORS,
        thermometer=FACTORS,
        drift=FACTORS,
        random_walk=FACTORS,
        clock=FACTORS,
        drift_model=st.sampled_from(["gauss-markov", "flicker"]),
        saturation=st.booleans(),
        quantisation=st.booleans(),
    ),
    noise_scale=_span(0, 1000),
    offset_pa=_span(-1e5, 1e5),
    unit=st.sampled_from(["random", "typical", "ideal"]),
    normal=VECTORS,
    rate_error_percent=_span(-20, 20),
    faults=st.lists(
        st.builds(
            Fault,
            kind=st.sampled_from(["dropout", "stuck", "dead", "spike", "offset"]),
            **START_STOP,
            probability=_span(0, 1),
            size=_span(-1e6, 1e6),
        ),
        max_size=2,
    ).map(tuple),
)
HEADS = st.builds(
    AirDataSettings,
    total=SENSORS,
    static=SENSORS,
    rate=_span(20, 1000),
    total_port=TOTAL_PORTS,
    static_port=STATIC_PORTS,
    pipe=st.just(0.0) | _span(0, 10),
    acceleration_sensitivity=st.booleans(),
    port_faults=PORT_FAULTS,
    swapped_tubes=st.booleans(),
    cover_left_on=st.booleans(),
    batch=_span(0, 1),
    thermal=st.builds(
        ThermalSettings, self_heating=_span(0, 60), lag=_span(0, 3600, **ABOVE_0), powered_for=_span(0, 1e6)
    ),
)


@settings(max_examples=60, deadline=None)
@given(
    choice=HEADS,
    seed=st.integers(0, 2**31),
    impact=_span(0, 6e4),
    angles=st.tuples(_span(-np.pi, np.pi), _span(-np.pi / 2, np.pi / 2)),
    throttle=_span(0, 1),
    force=st.tuples(*[_span(-500, 500)] * 3),
    covered_until=_span(0, 0.1),
)
def test_finite_in_finite_out(choice, seed, impact, angles, throttle, force, covered_until):
    """Any head of the settings' domain: what is delivered is a number, in order of its clocks."""
    head = AirDataHead(choice, Streams(seed), covered_until=covered_until)
    flow = _flow(total=101_325.0 + impact, angles=angles, throttle=throttle, force=force)
    rows = _tell(head, flow, 0.1) if head.full else _fly(head, lambda t: flow[:3], 0.1)
    there = np.isfinite(rows[:, 4:])
    assert np.isfinite(rows[:, 1:3][there]).all()
    assert np.isfinite(rows[:, 3][there[:, 1]]).all()
    assert (np.diff(rows[:, 0]) > 0).all()
    for column in (4, 5):
        ends = rows[:, column]
        assert (np.diff(ends[np.isfinite(ends)]) >= 0).all()
        assert (ends[np.isfinite(ends)] <= rows[np.isfinite(ends), 0]).all()
