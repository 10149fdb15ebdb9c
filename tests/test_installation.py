"""The installation's error of calibrated airspeed: by hand, from the ports alone, in trimmed segments alone."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sensors.settings import AirDataSettings, StaticPortSettings, TotalPortSettings
from uavsim import airdata, requirements
from uavsim.installation import KNOTS, SHARE, installation
from uavsim.score_keys import INSTALLATION

PS, RHO = 101_325.0, 1.225


def steady(airspeed: float = 30.0, **columns: float) -> dict[str, Any]:
    """Ten seconds at 100 Hz at sea level."""
    t = np.arange(1001) / 100.0
    total = float(airdata.total_pressure(static=PS, mach=airspeed / 340.294))
    values = {
        **dict.fromkeys(("alpha", "beta", "throttle", "roll"), 0.0),
        **{"airspeed": airspeed, "p_total": total, "p_static": PS, "mach": airspeed / 340.294, "wing": 1.0},
        **columns,
    }
    return {"t": t, **{name: np.full(t.shape, value) for name, value in values.items()}}


def head(*, total: dict[str, Any] | None = None, **static: float) -> AirDataSettings:
    ideal = TotalPortSettings(probe="ideal")
    return replace(
        AirDataSettings(),
        total_port=replace(ideal, **(total or {})),
        static_port=replace(StaticPortSettings(), **{**dict.fromkeys(ERRORS, 0.0), **static}),
    )


ERRORS = ("error", "error_alpha", "error_alpha2", "error_beta2", "error_mach2", "slipstream")


def test_an_ideal_head_has_no_error() -> None:
    found = installation(steady(), head(), flies=True)
    assert found["calibrated_airspeed"] == pytest.approx(30.0, abs=1e-3)
    assert found["error"] == found["over_limit"] == 0.0


@pytest.mark.parametrize(("airspeed", "limit"), [(30.0, KNOTS), (120.0, SHARE * 120.0)])
def test_a_static_port_that_reads_two_hundredths_high_by_hand(airspeed: float, limit: float) -> None:
    """q_c (1 - 0.02) is left, so the airspeed is √0.98 of what it was, 1 % low, but for compressibility."""
    found = installation(steady(airspeed), head(error=0.02), flies=True)
    assert found["error"] == pytest.approx(airspeed * (np.sqrt(0.98) - 1.0), rel=0.03)
    assert found["over_limit"] == pytest.approx(abs(found["error"] or 0.0) / limit, rel=1e-3)


def test_the_angles_of_the_segment_count() -> None:
    """c_α α of the static port, and what a plain tube loses at 20°, a hundredth of q_c."""
    found = installation(steady(alpha=0.1), head(error_alpha=0.2), flies=True)
    assert found["error"] == pytest.approx(30.0 * (np.sqrt(0.98) - 1.0), rel=0.01)
    tube = installation(steady(alpha=np.radians(20.0)), head(total={"probe": "plain"}), flies=True)
    assert tube["error"] == pytest.approx(30.0 * (np.sqrt(0.99) - 1.0), rel=0.01)


@pytest.mark.parametrize(
    ("column", "value"), [("roll", 0.6), ("wing", 0.5), ("airspeed", np.nan), ("p_static", np.nan)]
)
def test_what_is_not_trimmed_has_no_value(column: str, value: float) -> None:
    truth = steady()
    truth[column][-50] = value
    assert installation(truth, head(error=0.02), flies=True) == dict.fromkeys(INSTALLATION)


def test_an_airspeed_that_changes_is_not_trimmed_and_what_was_before_does_not_matter() -> None:
    truth = steady()
    truth["airspeed"] = truth["airspeed"] + np.where(truth["t"] < 4.0, 20.0, 0.0)
    truth["roll"][:100] = 1.0
    assert installation(truth, head(error=0.02), flies=True)["error"] is not None
    truth["airspeed"][-10:] += 2.0
    assert installation(truth, head(error=0.02), flies=True)["error"] is None


def test_a_rig_needs_no_wing() -> None:
    assert installation(steady(wing=0.0), head(error=0.02), flies=False)["error"] is not None


def test_a_short_record_has_no_segment() -> None:
    truth = {name: values[:200] for name, values in steady().items()}
    assert installation(truth, head(), flies=True) == dict.fromkeys(INSTALLATION)


def test_the_pack_asks_for_the_limit() -> None:
    (one,) = requirements.read("airspeed-installation")
    assert str(one) == "installation.over_limit ≤ 1, every flight"
