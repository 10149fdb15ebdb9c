"""Figures and rules of faults from the start, on flights made by hand: 10 s at 30 m/s, launched at 2 s."""

from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pandas as pd
import pytest

from uavsim.flight import Flight
from uavsim.studies.certify import from_start
from uavsim.studies.certify.figures import Errors, figures

LAUNCH, OUT = 2.0, 3.0


def flight(
    *, error: Any = 0.0, sd: float = 0.1, valid: Any = True, events: list[dict[str, Any]] | None = None
) -> Flight:
    t = np.arange(0.0, 10.0, 0.01)
    fast = np.where(t < LAUNCH, 0.0, 30.0)
    phase = np.select([t < LAUNCH + 0.05, t < 2.4, t < 5.0], ["rail", "stroke", "transition"], "cruise")
    height = np.maximum(t - LAUNCH, 0.0) * 2.5  # 10 m at 6 s
    truth = pd.DataFrame({"t": t, "airspeed": fast, "phase": phase, "altitude": 100.0 + height})
    told = error(t) if callable(error) else np.full(t.size, error)
    good = valid(t) if callable(valid) else np.full(t.size, valid)
    estimate = pd.DataFrame({"t": t, "airspeed": fast + told, "airspeed_sd": np.full(t.size, sd), "valid": good})
    score = {
        "outcome": "cruise",
        "launch": {"true_time": LAUNCH, "release_time": LAUNCH - 0.01, "latency": 0.01, "latency_from_crossing": 0.01,
                   "detections": 1, "false_detections": 0, "detected_time": 2.01},
        "flight": {"wing_out_time": OUT, "rail_exit_time": 2.4, "duration": 10.0},
    }  # fmt: skip
    return cast("Flight", SimpleNamespace(truth=truth, estimate=estimate, events=events or [], score=score))


def event(t: float, name: str = "airspeed_fault", channel: str = "total", **more: Any) -> dict[str, Any]:
    return {"t": t, "event": name, "channel": channel, "kind": "blocked", **more}


# -- figures -----------------------------------------------------------------------------------------------------------


def test_the_sums_of_a_phase() -> None:
    """Cruise is from 5 s on: 500 rows, of which 100 are off by 2.5 bars and 50 of those are not valid."""
    row = figures(flight(error=lambda t: np.where(t >= 8.995, 0.25, 0.1), valid=lambda t: t < 9.495))
    assert (row["cruise.rows"], row["cruise.valid"]) == (500, 450)
    assert (row["cruise.within"], row["cruise.within_valid"]) == (400, 400)
    assert row["cruise.square"] == pytest.approx(400 * 0.01 + 100 * 0.0625)
    assert row["worst_ratio"] == pytest.approx(2.5)
    assert row["worst_ratio_t"] == pytest.approx(9.0)
    assert row["worst_error"] == pytest.approx(0.25)
    assert row["hours"] == pytest.approx(7.99 / 3600.0)


def test_a_valid_number_that_is_none_is_as_far_off_as_can_be() -> None:
    row = figures(flight(error=lambda t: np.where(t > 8.995, np.nan, 0.0)))
    assert row["worst_ratio"] == 1e9
    assert row["cruise.within"] == 400
    assert row["cruise.counted"] == 400


def test_how_long_a_valid_airspeed_misleads() -> None:
    """Twice: for 0.5 s and for 0.8 s, of which 0.3 s in the middle are not valid."""
    errors = Errors(
        flight(
            error=lambda t: np.where(((t > 3.995) & (t < 4.505)) | ((t > 5.995) & (t < 6.805)), 4.0, 0.0),
            valid=lambda t: ~((t > 6.195) & (t < 6.495)),
        )
    )
    assert errors.wrong_for() == pytest.approx(0.5)
    assert errors.wrong_for(after=5.0) == pytest.approx(0.3)


def test_flags_and_returns_are_counted() -> None:
    row = figures(flight(events=[
        event(4.0, channel="static"), event(5.0, "airspeed_recovered", "static"), event(6.0), event(1.0, "not_ready"),
    ]))  # fmt: skip
    assert (row["flags"], row["flag_t"], row["flag_channel"], row["taken_back"]) == (2, 4.0, "static", 1)


# -- rules -------------------------------------------------------------------------------------------------------------

cover = partial(from_start.hold, from_start.cover_on)
dead = partial(from_start.hold, from_start.dead)
shut = partial(from_start.hold, from_start.static_shut)
accelerometer = partial(from_start.hold, partial(from_start.not_ready, channel="accelerometer"))
thermometer = partial(from_start.hold, partial(from_start.named, channel="thermometer"))


def not_valid_from(t0: float) -> Any:
    return lambda t: t < t0


@pytest.mark.parametrize(("flown", "wrong"), [
    (flight(events=[event(2.25)]), ""),
    (flight(valid=not_valid_from(2.3), events=[event(3.9)]), ""),
    (flight(valid=not_valid_from(2.3), events=[event(3.9, channel="both")]), ""),
    (flight(valid=not_valid_from(2.5), events=[event(3.9)]), "valid and not flagged"),
    (flight(valid=not_valid_from(2.3), events=[event(4.1)]), "too late"),
    (flight(valid=not_valid_from(2.3)), "never flagged"),
    (flight(events=[event(2.2, channel="static")]), "blames the static"),
    (flight(events=[event(2.2), event(6.0, "airspeed_recovered")]), "valid and not flagged"),
    (flight(valid=not_valid_from(2.3), events=[event(2.2), event(6.0, "airspeed_recovered")]), "taken back"),
])  # fmt: skip
def test_a_cover_left_on(flown: Flight, wrong: str) -> None:
    row = cover(flown)
    assert row["right"] == (wrong == "")
    assert wrong in row["wrong"]


def test_a_dead_pressure_sensor() -> None:
    def off(t: Any) -> Any:
        return np.where(t >= 2.2, -25.0, 0.0)

    assert dead(flight(error=off, valid=not_valid_from(2.3)))["right"]
    assert "25.0 m/s off" in dead(flight(error=off, valid=not_valid_from(2.4)))["wrong"]


@pytest.mark.parametrize(("flown", "wrong"), [
    (flight(events=[event(5.9, channel="static")]), ""),
    (flight(events=[event(6.1, channel="static")]), "after 10 m"),
    (flight(events=[event(4.0), event(5.0, channel="static")]), "blames the total"),
    (flight(), "never named"),
    (flight(error=0.36, events=[event(5.9, channel="static")]), "not honest"),
    (flight(error=0.36, valid=False, events=[event(5.9, channel="static")]), ""),
])  # fmt: skip
def test_a_static_port_that_is_shut(flown: Flight, wrong: str) -> None:
    row = shut(flown)
    assert row["right"] == (wrong == "")
    assert wrong in row["wrong"]


def test_parts_that_must_not_be_ready() -> None:
    said = event(1.2, "not_ready", "", reasons=["accelerometer: repeats one number"])
    assert accelerometer(flight(events=[said]))["right"]
    assert accelerometer(flight(events=[said, event(1.5, "ready", "")]))["wrong"] == "ready"
    assert accelerometer(flight())["wrong"] == "readiness is not told"
    assert not thermometer(flight(events=[said]))["right"]
    assert thermometer(flight(events=[event(1.0, channel="thermometer")]))["right"]
    told = [event(1.2, "ready", ""), event(6.0, channel="thermometer")]
    assert thermometer(flight(events=told))["right"]
    assert thermometer(flight(events=[told[0], event(7.0, channel="thermometer")]))["wrong"] == "blamed at 7.00 s"
