"""The airspeed of a log: by which beliefs, from when on, and how well, on flights made by equations."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from references.logged_flight import FIELD, LAUNCH, WARM, Made, made

from uavsim import airdata, load
from uavsim.logs import Recording, Series, replay_log
from uavsim.logs.aired import with_airspeed
from uavsim.logs.airspeed import Aired, air_of, air_settings
from uavsim.logs.beliefs import parse_noise
from uavsim.logs.clocks import delay_of
from uavsim.logs.gusts import gust_of
from uavsim.logs.head import Channel, head_of, lacking
from uavsim.logs.over_ground import over_ground
from uavsim.logs.quiet import Stretch, noise_at_rest, noise_throughout, rests_of, step_of
from uavsim.onboard.airspeed import NoiseModel

LAUNCHED = [LAUNCH + 0.02]


def aired(flight: Made, launches: list[float], *keys: str, noise: str | None = None) -> Aired:
    """Estimate the airspeed of a recording; a launch is told as the nearest reading."""
    t = flight.recording.readings[:, 0]
    found = air_of(
        flight.recording, air_settings(keys, noise), [float(t[np.argmin(np.abs(t - at))]) for at in launches]
    )
    assert isinstance(found, Aired)
    return found


def errors(found: Aired, flight: Made, since: float, shift: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Errors and standard deviations of what is valid from a time on."""
    rows = np.array(found.estimates, dtype=float)
    rows = rows[(rows[:, 0] > since) & (rows[:, 6] == 1.0)]
    return rows[:, 1] - flight.at(rows[:, 0] - shift), rows[:, 2]


def series(name: str, t: np.ndarray, values: np.ndarray) -> Series:
    return Series(name, t, values, f"log.csv: {name}")


# -- the head --------------------------------------------------------------------------------------------------------


def test_an_equivalent_airspeed_becomes_the_pressure_that_has_it() -> None:
    t, speed = np.arange(0.0, 3.0, 0.1), np.linspace(0.0, 60.0, 30)
    head = head_of({"equivalent_airspeed": series("", t, speed), "baro_height": series("", t, np.full(30, 1500.0))})
    assert head is not None
    assert head.differential
    assert head.made == ("baro_height", "equivalent_airspeed")
    pressure = airdata.standard_pressure(1500.0)
    assert head.static.values == pytest.approx(pressure, rel=1e-12)
    told = airdata.equivalent_airspeed(total=pressure + head.total.values, static=np.full(30, pressure))
    assert told == pytest.approx(speed, abs=1e-9)
    assert "sea level" in head.remarks[0]
    assert "proves no accuracy" in head.remarks[1]
    assert head.assumed_temperature == pytest.approx(airdata.standard_temperature(1500.0))
    assert "is assumed" in head.remarks[2]


def test_what_a_faster_table_repeats_counts_once() -> None:
    t = np.arange(0.0, 2.0, 0.01)
    held = np.repeat(np.arange(40.0) % 7.0, 5)
    still = np.round(np.random.default_rng(2).normal(0.0, 0.4, t.size))  # coarse, and of readings of its own
    head = head_of({"p_difference": series("", t, held), "p_static": series("", t, FIELD + still)})
    assert head is not None
    assert head.total.t == pytest.approx(t[::5])
    assert head.static.t.size == t.size


def test_a_row_has_the_last_static_pressure_with_its_own_time() -> None:
    t, u = np.arange(0.0, 4.0, 0.02), np.arange(-0.003, 4.0, 0.05)
    total = np.concatenate([t[t < 1.0], t[t > 2.0]])  # silent for a second
    head = head_of({"p_difference": series("", total, total * 10.0), "p_static": series("", u, FIELD + u)})
    assert head is not None
    rows = head.rows()
    t_static = rows[:, 5]
    at = np.union1d(total, u[(u > 1.17) & (u < 1.83)])
    assert rows[:, 0] == pytest.approx(np.maximum(at, t_static))
    assert (rows[:, 0] - at <= 0.01).all()  # half a period of the total channel
    assert (rows[:, 0] - t_static < 0.0501).all()
    assert rows[:, 2] == pytest.approx(FIELD + t_static)
    assert rows[:, 1] - rows[:, 2] == pytest.approx(10.0 * rows[:, 4])


def test_a_log_that_lacks_a_pressure_says_which() -> None:
    t = np.arange(0.0, 3.0, 0.1)
    one = {"p_difference": series("", t, t)}
    assert head_of(one) is None
    assert "map p_static=… or baro_height=…" in str(lacking(one))
    assert "makes no airspeed" in str(lacking({"p_static": series("", t, t + FIELD)}))
    assert lacking({}) is None
    hecto = {**one, "p_static": series("", t, 1013.0 + t)}
    assert head_of(hecto) is None
    assert "looks like hPa: map p_static=…*100" in str(lacking(hecto))
    assert "fewer than 20" in str(lacking({**one, "p_static": series("", t[:5], t[:5] + FIELD)}))


# -- noise, rest, gusts ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [0.0, 2.0])
def test_white_noise_is_what_it_is_at_rest_and_in_flight(step: float) -> None:
    t = np.arange(0.0, 60.0, 0.01)
    values = np.random.default_rng(3).normal(0.0, 3.0, t.size)
    values = np.round(values / step) * step if step else values
    channel = Channel("", t, values, "")
    true = float(np.hypot(3.0, step / 12**0.5))
    assert noise_at_rest(channel, [Stretch(0.0, 60.0)]) == pytest.approx(true, rel=0.12)
    climbing = Channel("", t, values + 40.0 * t + 200.0 * (t > 30.0), "")
    assert noise_throughout(climbing, 0.25) == pytest.approx(true, rel=0.08)
    assert step_of(channel) == pytest.approx(step)


def test_coloured_noise_counts_as_what_averages_leave_of_it() -> None:
    """A filter y += k (x − y) leaves means of many readings as they were: the white noise that went in."""
    random, k = np.random.default_rng(4), 0.2
    x = random.normal(0.0, 3.0, 6000)
    y = np.zeros(x.size)
    for i in range(1, x.size):
        y[i] = y[i - 1] + k * (x[i] - y[i - 1])
    channel = Channel("", np.arange(x.size) * 0.01, y, "")
    assert y.std() < 1.2
    assert noise_at_rest(channel, [Stretch(0.0, 60.0)]) == pytest.approx(2.6, rel=0.15)  # of means of 16


def test_a_flight_is_no_rest_however_smooth() -> None:
    """At a constant speed the force is as still as on a bench; the pressure is not near 0."""
    flight = made(begin=7.0)
    head = head_of(flight.recording.series)
    assert head is not None
    assert rests_of(flight.recording.readings, head).still == []
    whole = made()
    (rest,) = rests_of(whole.recording.readings, head_of(whole.recording.series)).still  # type: ignore[arg-type]
    assert rest.start == 0.0
    assert LAUNCH - 0.6 < rest.end <= LAUNCH


@pytest.mark.parametrize(("sd", "low", "high"), [(0.0, 0.0, 0.25), (1.5, 1.1, 2.0)])
def test_turbulence_is_found_by_pressure_and_force(sd: float, low: float, high: float) -> None:
    random, dt, length, speed = np.random.default_rng(5), 0.01, 200.0, 25.0
    t = np.arange(0.0, 60.0, dt)
    gust = np.zeros(t.size)
    for i in range(1, t.size):
        gust[i] = gust[i - 1] * (1.0 - speed / length * dt) + sd * np.sqrt(2.0 * speed / length * dt) * random.normal()
    rho = 1.225
    difference = 0.5 * rho * (speed + gust) ** 2 + random.normal(0.0, 2.0, t.size)
    head = head_of({"p_difference": series("", t, difference), "p_static": series("", t, FIELD + 0.0 * t + t % 0.02)})
    assert head is not None
    readings = np.column_stack([t, random.normal(0.0, 0.5, t.size), 0.0 * t, 0.0 * t - 9.8])
    found = gust_of(
        head,
        readings,
        NoiseModel(2.0, 2.0, 1.0, accelerometer_sd=0.5, accelerometer_rate=100.0),
        zero=0.0,
        length=length,
    )
    assert found is not None
    assert low <= found <= high


# -- clocks ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shift", [0.0, 0.31, -0.12, 1.7e9])
def test_two_clocks_are_told_by_the_launch(shift: float) -> None:
    flight = made(shift=shift)
    head = head_of(flight.recording.series)
    assert head is not None
    found = delay_of(head, flight.recording.readings, LAUNCHED)
    assert found is not None
    assert abs(found.delay - shift) < max(4.0 * found.sd, 0.002)
    assert found.sd < 0.01
    assert found.beyond(0.0, 0.01) == (0.0 if shift == 0.0 else found.delay)


def test_without_a_launch_no_clock_is_set() -> None:
    flight = made(begin=7.0, shift=0.3)
    head = head_of(flight.recording.series)
    assert head is not None
    assert delay_of(head, flight.recording.readings, []) is None


# -- over ground -----------------------------------------------------------------------------------------------------


def circles(off: float, turns: float, *, scalar: bool) -> tuple[dict[str, np.ndarray], dict[str, Series]]:
    """An airspeed that is told too low by `off`, flown in circles in a wind of (4, −3) m/s."""
    random = np.random.default_rng(6)
    t = np.arange(0.0, 30.0 * turns, 0.1)
    heading = 2.0 * np.pi * t / 30.0
    speed = 18.0 + np.sin(0.3 * t)
    north, east = speed * np.cos(heading) + 4.0, speed * np.sin(heading) - 3.0
    noise = random.normal(0.0, 0.2, t.size)
    found = {"heading": heading, "ground_speed": np.hypot(north, east) + noise}
    if not scalar:
        found = {"north_speed": north + noise, "east_speed": east + random.normal(0.0, 0.2, t.size)}
    estimate = {"t": t, "airspeed": speed - off, "airspeed_sd": np.full(t.size, 0.3), "valid": np.ones(t.size)}
    return estimate, {name: series(name, t, values) for name, values in found.items()}


@pytest.mark.parametrize("scalar", [False, True])
def test_circles_tell_the_wind_and_what_an_airspeed_is_off_by(scalar: bool) -> None:
    found = over_ground(*circles(0.7, 4.0, scalar=scalar))
    assert found is not None
    assert found.difference == pytest.approx(0.7, abs=0.1)
    assert (found.wind_north, found.wind_east) == pytest.approx((4.0, -3.0), abs=0.15)
    assert found.turns == pytest.approx(4.0, abs=0.15)
    assert not found.within
    small = over_ground(*circles(0.2, 4.0, scalar=scalar))
    assert small is not None
    assert small.within


def test_less_than_two_turns_tell_nothing() -> None:
    assert over_ground(*circles(0.7, 1.5, scalar=False)) is None


# -- the whole -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("differential", [True, False])
def test_a_launch_is_flown_as_on_board(differential: bool) -> None:
    """Tared at rest, handed over in the push, valid at once and within its error bar; authority: the equations."""
    flight = made(differential=differential)
    found = aired(flight, LAUNCHED)
    (span,) = found.spans
    assert span.tare is not None
    assert span.tare.still
    assert span.tare.window[1] <= LAUNCH
    off, sd = errors(found, flight, LAUNCH + 0.2)
    assert np.mean(np.abs(off) < 1.96 * sd) > 0.95
    assert np.sqrt(np.mean(off**2)) < 0.3
    valid = [row[6] for row in found.estimates if row[0] > LAUNCH + 0.3]
    assert np.mean(valid) > 0.98
    assert not [event for event in found.events if event["event"] == "airspeed_fault"]
    assert [event["event"] for event in found.events if event["t"] > LAUNCH][:2] == ["stroke_end", "wings_commanded"]
    (believed, air, tared) = found.said[-3:]
    assert "by its quiet stretch" in believed
    assert "turbulence" in air
    assert "tared in still air" in tared


def test_a_log_that_begins_in_the_air_is_flown_from_there() -> None:
    flight = made(begin=8.0, offset=0.0)
    found = aired(flight, [])
    (told,) = [event["t"] for event in found.events if event["event"] == "in_flight"]
    assert 11.0 < told < 11.2  # three seconds of a valid airspeed
    assert found.spans[0].tare is None
    off, sd = errors(found, flight, 8.0)
    assert np.mean(np.abs(off) < 1.96 * sd) > 0.95
    assert np.abs(off).max() < 3.0
    assert "not tared" in found.said[-1]
    assert not [event for event in found.events if event["event"] == "airspeed_fault"]


def test_a_breath_into_the_pitot_is_no_flight() -> None:
    flight = made(end=4.9)
    t = flight.recording.series["p_difference"].t
    blown = flight.recording.series["p_difference"].values + 1200.0 * ((t > 2.0) & (t < 3.5))
    log = Recording(("a",), "", flight.recording.readings, (), {
        **flight.recording.series, "p_difference": series("p_difference", t, blown),
    })  # fmt: skip
    found = air_of(log, air_settings([]), [])
    assert isinstance(found, Aired)
    assert "in_flight" not in [event["event"] for event in found.events]


def test_clocks_apart_give_the_same_airspeed() -> None:
    flight, apart = made(), made(shift=123.4)
    one, other = aired(flight, LAUNCHED), aired(apart, LAUNCHED)
    assert re.search(r"the head.s clock is set by -123\.(39|40)", " ".join(other.said))
    a, b = (np.array(found.estimates, dtype=float) for found in (one, other))
    late = a[:, 0] > LAUNCH + 0.5
    assert np.interp(a[late, 0], b[:, 0], b[:, 1]) == pytest.approx(a[late, 1], abs=0.15)


def test_two_flights_are_cut_where_the_aircraft_stands_between() -> None:
    first, second = made(end=15.0), made(end=15.0, seed=2)
    readings = np.concatenate([first.recording.readings, second.recording.readings + np.array([15.0, 0.0, 0.0, 0.0])])
    both = {
        name: series(name, np.concatenate([one.t, second.recording.series[name].t + 15.0]),
                     np.concatenate([one.values, second.recording.series[name].values]))
        for name, one in first.recording.series.items()
    }  # fmt: skip
    t = readings[:, 0]
    launches = [float(t[np.argmin(np.abs(t - at))]) for at in (LAUNCHED[0], LAUNCHED[0] + 15.0)]
    log = Recording(("a",), "", readings, (), both)
    found = air_of(log, air_settings([]), launches)
    assert isinstance(found, Aired)
    assert [span.launch for span in found.spans] == launches
    assert 14.9 < found.spans[1].start < 15.5
    assert [round(event["t"]) for event in found.events if event["event"] == "stroke_end"] == [5, 20]  # type: ignore[call-overload]


def test_beliefs_are_of_a_named_part_or_of_the_user_or_of_the_log() -> None:
    flight = made(differential=False)
    named = aired(flight, LAUNCHED, "air_data.total.preset=bmp390", "air_data.static.preset=ms5611")
    from sensors import preset  # noqa: F401  (both are shipped)

    assert "total by the description of bmp390; static by the description of ms5611" in named.said[-3]
    assert named.told.noise.head.error_alpha2 != 0.0  # with the ports as the scenario's head has been calibrated
    said = aired(flight, LAUNCHED, noise="p_total=7,p_static=5,temperature=2,fx=3")
    noise = said.told.noise
    assert (noise.total_sd, noise.static_sd, noise.temperature_sd, noise.accelerometer_sd) == (7.0, 5.0, 2.0, 3.0)
    assert "--noise" in said.said[-3]
    own = aired(flight, LAUNCHED).told.noise
    assert own.total_sd == pytest.approx(2.0, rel=0.2)
    assert own.accelerometer_rate == pytest.approx(250.0)
    assert own.rail_elevation is None


@pytest.mark.parametrize(
    "text", ["p_total", "p_total=", "p_total=0", "p_total=nan", "p_total=1e9", "speed=3", "p_total=1,,"]
)
def test_a_noise_that_is_none_is_refused_in_a_line(text: str) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*give it as NAME=SD[^\n]*$"):
        parse_noise(text)


def test_a_key_that_means_nothing_for_a_log_is_refused() -> None:
    for key in ("launcher.stroke=3", "seed=3", "plant.kind=held", "air_data=3"):
        with pytest.raises(ValueError, match=r"of a log only air_data\.…"):
            air_settings([key])


# -- the folder ------------------------------------------------------------------------------------------------------


def test_a_replay_has_the_tables_and_figures_of_a_flight(tmp_path: Path) -> None:
    flight = made(reference=True)
    replayed = with_airspeed(replay_log(flight.recording), flight.recording, air_settings([]))
    figures = replayed.score["airspeed"]
    assert figures["estimator"] == "aided"
    assert figures["rmse"] < 0.3 < 1.0
    assert figures["coverage_95"] > 0.9
    assert figures["flags"] == 0
    assert figures["valid_fraction"] > 0.95
    assert 0.3 < figures["nis_mean"] < 1.5
    assert replayed.score["flight"]["ready"] is True
    times = [event["t"] for event in replayed.events]
    assert times == sorted(times)
    assert [event["event"] for event in replayed.events].count("launch_detected") == 1
    replayed.save(tmp_path / "made")
    again = load(tmp_path / "made")
    assert again.estimate.equals(replayed.estimate)
    assert list(again.air_data) == ["t", "p_total", "p_static", "temperature", "t_total", "t_static"]
    assert again.air_data["temperature"].iloc[-1] == WARM
    told = json.loads((tmp_path / "made" / "score.json").read_text())
    assert told["recording"]["airspeed"]["reference"] == "made.csv: truth"


def test_a_reference_that_is_off_is_told_so() -> None:
    """What is scored is the difference to the reference, and not to anything else."""
    flight = made(reference=True)
    one = flight.recording.series["airspeed_reference"]
    wrong = {**flight.recording.series, "airspeed_reference": series(one.name, one.t, one.values + 2.0)}
    log = Recording(("a",), "", flight.recording.readings, (), wrong)
    right, off = (
        with_airspeed(replay_log(of), of, air_settings([])).score["airspeed"] for of in (flight.recording, log)
    )
    assert off["bias"] == pytest.approx(right["bias"] - 2.0, abs=0.02)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", ["huge", "negative", "constant", "gaps"])
def test_absurd_pressures_cost_the_airspeed_and_not_the_launch(kind: str) -> None:
    flight = made(end=8.0)
    total, static = (flight.recording.series[name].values.copy() for name in ("p_difference", "p_static"))
    if kind == "huge":
        total[::7], static[::9] = 1e12, -1e12
    elif kind == "negative":
        total, static = -np.abs(total), static - 50_000.0 * (np.arange(static.size) % 5 == 0)
    elif kind == "constant":
        total[:], static[:] = 3.0, FIELD
    else:
        total[200:], static[:200] = np.nan, np.nan
    of = flight.recording.series
    absurd = {
        **of,
        "p_difference": series("", of["p_difference"].t, total),
        "p_static": series("", of["p_static"].t, static),
    }
    log = Recording(("a",), "", flight.recording.readings, (), absurd)
    plain = replay_log(log)
    told = with_airspeed(plain, log, air_settings([]))
    assert told.score["launch"]["detected_time"] == plain.score["launch"]["detected_time"] is not None
    json.dumps(told.score, allow_nan=False)


def test_a_log_without_pressures_stays_as_it_was() -> None:
    flight = made()
    log = Recording(("a",), "", flight.recording.readings, ())
    plain = replay_log(log)
    assert with_airspeed(plain, log, air_settings([])) is plain
    half = Recording(
        ("a",), "", flight.recording.readings, (), {"p_difference": flight.recording.series["p_difference"]}
    )
    told = with_airspeed(replay_log(half), half, air_settings([]))
    assert "no static pressure" in told.score["recording"]["remarks"][-1]
    assert "estimate" not in told.tables
