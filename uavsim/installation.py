"""Position error of the air-data installation as an error of calibrated airspeed, in trimmed flight.

    V_c(p_t + Δp_t, p_s + Δp_s) - V_c(p_t, p_s)                       m/s, error of calibrated airspeed

Δp_t and Δp_s are what the ports feel less the free stream's total and static pressure (`sensors.probe`), at the mean
angles, Mach number, pressures and throttle of the last 5 s. It is the error of the ports alone: no noise, no offset, no
lag, and nothing that an onboard calibration takes off again. It is held against a limit,

    limit = max(0.03 V_c, 5 kt)

that of 14 CFR 25.1323(c) for the installation of transport aeroplanes, as a number to compare with. The rule asks for a
calibration in flight over a range of speeds in two flap settings; nothing of that is claimed here.

A segment is trimmed if its airspeed stays within 1 m/s of its mean, the bank below 30°, and the wing is out; a rig
holds its airspeed by itself. Else there is no value.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.probe import Port, static_port, total_port
from sensors.settings import AirDataSettings
from uavsim import airdata
from uavsim.score_keys import INSTALLATION

Array = NDArray[np.float64]

LAST = 5.0  # s at the end that are the segment, those over which cruise is judged
STEADY = 1.0  # m/s, most that a trimmed airspeed is from its mean
BANK = np.pi / 6.0  # rad
WING_OUT = 0.99
FLOW = ("p_total", "p_static", "mach", "alpha", "beta", "throttle")
COLUMNS = ("t", "airspeed", "wing", "roll", *FLOW)
SHARE, KNOTS = 0.03, 5.0 * 1852.0 / 3600.0  # of calibrated airspeed; m/s. 14 CFR 25.1323(c)


def installation(truth: Mapping[str, Any], settings: AirDataSettings, *, flies: bool) -> dict[str, float | None]:
    """Return the error of calibrated airspeed that the ports have in the last, trimmed segment of a flight.

    Parameters
    ----------
    truth
        Columns of the truth's table by name.
    settings
        Of the head.
    flies
        Whether it is an aircraft in flight; of a rig wing and bank are not asked.

    Returns
    -------
    dict
        `calibrated_airspeed` and `error`, m/s, and `over_limit`, the error's size over the limit; None where the
        segment is not trimmed or the truth does not have what it takes.
    """
    flow = _segment(truth, flies=flies)
    nothing: dict[str, float | None] = dict.fromkeys(INSTALLATION)
    if flow is None:
        return nothing
    total, static, *_ = flow

    def felt(port: Port | None, true: float) -> float:
        return true if port is None else port(*flow)

    ports = felt(total_port(settings.total_port), total), felt(static_port(settings.static_port), static)
    try:
        shown = float(airdata.calibrated_airspeed(total=ports[0], static=ports[1]))
        true = float(airdata.calibrated_airspeed(total=total, static=static))
    except ValueError:  # beyond what the law of pressures is for
        return nothing
    error = shown - true
    return {"calibrated_airspeed": true, "error": error, "over_limit": abs(error) / max(SHARE * true, KNOTS)}


def _segment(truth: Mapping[str, Any], *, flies: bool) -> tuple[float, float, float, float, float, float] | None:
    """Means of the flow over the last seconds, as `FLOW` names them; None if they are not trimmed, or not told."""
    time = np.asarray(truth["t"], float)
    if any(name not in truth for name in COLUMNS) or not time.size or time[-1] - time[0] < LAST:
        return None
    last = {name: np.asarray(truth[name], float)[time >= time[-1] - LAST] for name in COLUMNS}
    speed = last["airspeed"]
    steady = np.isfinite(speed).all() and np.abs(speed - speed.mean()).max() <= STEADY
    level = not flies or (last["wing"].min() >= WING_OUT and np.abs(last["roll"]).max() < BANK)
    total, static, mach, alpha, beta, throttle = (float(last[name].mean()) for name in FLOW)
    return (total, static, mach, alpha, beta, throttle) if steady and level and total > static > 0.0 else None
