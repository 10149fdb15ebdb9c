"""Flights of ours written as logs: the airspeed that a replay gives is that of the flight.

With the beliefs of the flight (parts, ports, wind and tare named) the error is within ±1.96 standard deviations as
often as in flight. With those that the log itself gives it is so at least as often.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import uavsim
from uavsim.flight import Flight
from uavsim.logs import Recording, Series, read_log, replay_log
from uavsim.logs.aired import with_airspeed
from uavsim.logs.airspeed import Aired, AirSettings, air_of, air_settings

COVERED = 1.96
FLIGHTS = 6  # of each scenario; `--whole` flies them all
WHOLE = 100


def as_log(flight: Flight) -> Recording:
    """What a logger that stamps each conversion makes of a flight."""
    air = flight.air_data
    differential = flight.scenario["air_data"]["kind"] == "differential"
    channels = {
        "p_static": ("t_static", air["p_static"]),
        "temperature": ("t", air["temperature"]),
        "p_difference" if differential else "p_total": (
            "t_total",
            air["p_total"] - (air["p_static"] if differential else 0.0),
        ),
    }
    series = {}
    for name, (stamp, values) in channels.items():
        t, value = air[stamp].to_numpy(dtype=float), values.to_numpy(dtype=float)
        good = np.isfinite(t) & np.isfinite(value)
        t, value = t[good], value[good]
        new = np.concatenate(([True], np.diff(t) > 0.0))
        series[name] = Series(name, t[new], value[new], f"flight.csv: {name}")
    return Recording(("flight.csv",), "", flight.accelerometer.to_numpy(), (), series)


def keys_of(flight: Flight) -> list[str]:
    """The beliefs of the flight, as a user would name them; the tare ends before the launch as the crew's did."""
    of = flight.scenario
    air, environment = of["air_data"], of["environment"]
    total = "differential" if air["kind"] == "differential" else "total"
    return [
        f"air_data.{total}.preset={air[total]['preset']}",
        f"air_data.static.preset={air['static']['preset']}",
        f"accelerometer.preset={of['accelerometer']['preset']}",
        f"air_data.tare={air['tare']}",
        f"air_data.tare_duration={air['tare_duration']}",
        f"air_data.cover_off={air['cover_off'] + 0.03}",
        f"flight_computer.rail_elevation_deg={of['launcher']['elevation_deg']}",
        *(f"environment.{key}={environment[key]}" for key in ("turbulence_wind_20ft", "wind_speed", "wind_from_deg")),
    ]


def as_believed(flight: Flight, *more: str) -> AirSettings:
    """Settings of a replay with the beliefs of the flight."""
    return air_settings([*keys_of(flight), *more])


def covered(flight: Flight, settings: AirSettings) -> tuple[float, int]:
    """Share of errors within the error bar, over the scored time, and how many flags."""
    recording = as_log(flight)
    found = air_of(recording, settings, replay_log(recording).score["recording"]["detections"])
    assert isinstance(found, Aired)
    rows = np.array(found.estimates, dtype=float)
    rows = rows[rows[:, 0] > flight.score["launch"]["true_time"] + 0.05]
    error = rows[:, 1] - np.interp(rows[:, 0], flight.truth["t"], flight.truth["airspeed"])
    flags = sum(event["event"] == "airspeed_fault" for event in found.events)
    return float(np.mean(np.abs(error) <= COVERED * rows[:, 2])), flags


@pytest.mark.slow
@pytest.mark.parametrize(
    "overrides", [("catapult",), ("gusty",), ("crosswind",), ("catapult", "air_data.kind=differential")]
)
def test_a_replay_covers_its_errors_as_the_flight_does(
    overrides: tuple[str, ...], request: pytest.FixtureRequest
) -> None:
    whole = request.config.getoption("--whole", default=False)
    in_flight, replayed, by_log, flags = [], [], [], 0
    for seed in range(1601, 1601 + (WHOLE if whole else FLIGHTS)):
        flight = uavsim.fly(overrides[0], seed=seed, overrides=overrides[1:])
        in_flight.append(flight.score["airspeed"]["coverage_95"])
        share, flagged = covered(flight, as_believed(flight))
        replayed.append(share)
        flags += flagged
        by_log.append(covered(flight, air_settings([]))[0])
    assert np.mean(replayed) > np.mean(in_flight) - 0.02
    assert flags == 0
    assert np.mean(by_log) > 0.90


IDEAL = [f"air_data.static_port.{name}=0" for name in ("error", "error_alpha2", "error_beta2")]
"""No calibration, whose errors a log does not know."""


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "alike"), [(104, 0.06), (416, 0.02), (833, 0.02)])
def test_a_flight_replays_alike_whatever_it_is_written_as(rate: int, alike: float, tmp_path: Path) -> None:
    """The same detection, and of the same conversions the same airspeed, from 1 s after the rail on.

    Between a conversion and the poll that read it there are up to 10 ms, in the stroke 0.7 m/s, which a log of
    conversions does not know; at 104 Hz the force of those is not known any better.
    """
    flight = uavsim.fly("catapult", seed=1699, overrides=[f"accelerometer.rate={rate}", *IDEAL])
    log, settings = as_log(flight), as_believed(flight, *IDEAL)
    tables = {"imu": dict(zip(("t", "fx", "fy", "fz"), log.readings.T, strict=True))}
    tables |= {name: {"t": one.t, name: one.values} for name, one in log.series.items()}  # noqa: PD011
    found = []
    for suffix, write in (
        (".parquet", lambda table, path: table.to_parquet(path)),
        (".csv", lambda table, path: table.to_csv(path, index=False)),
        (".feather", lambda table, path: table.to_feather(path)),
        (".csv.gz", lambda table, path: table.to_csv(path, index=False)),
    ):
        paths = [tmp_path / f"{name}{suffix}" for name in tables]
        for path, columns in zip(paths, tables.values(), strict=True):
            write(pd.DataFrame(columns), path)
        recording = read_log(paths)
        found.append(with_airspeed(replay_log(recording, settings.scenario.detector), recording, settings))
    first = found[0]
    assert abs(first.score["launch"]["detected_time"] - flight.score["launch"]["detected_time"]) <= 1.0 / rate
    for other in found[1:]:
        assert other.score["launch"]["detected_time"] == pytest.approx(first.score["launch"]["detected_time"], abs=1e-9)
        assert other.estimate["airspeed"].to_numpy() == pytest.approx(first.estimate["airspeed"].to_numpy(), abs=1e-6)
    told, own = (
        one.estimate.merge(one.air_data[["t", "t_total"]], on="t").drop_duplicates("t_total") for one in (first, flight)
    )
    both = told.merge(own, on="t_total", suffixes=("", "_own"))
    late = both["t"] > flight.score["flight"]["rail_exit_time"] + 1.0
    assert late.sum() > 2000
    assert (both["airspeed"] - both["airspeed_own"])[late].abs().max() < alike
