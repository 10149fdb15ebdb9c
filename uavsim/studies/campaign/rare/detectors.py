"""Rare events of a launch detector on the readings of one accelerometer: alarms at rest, and strokes that are missed.

    at rest      reading_k = g sin θ + σ ξ_k along the launch axis, θ the rail's elevation: a `Watch`, which is split
    in a stroke  reading_k = f_k + b + σ ξ_k, f the truth of a flight in which nothing is commanded, b the offset of the
                 unit, normal with the deviation of its description: `Inputs` of subset simulation

σ is the description's noise of a reading with its rounding, or what is given: noise and vibration at the detector,
taken for white. Left out are coloured noise, the part's lag, clock, scale and misalignment; whole flights have them.

The margin of a sequence is the force s, m/s², by which all of its readings along the axis have to be raised so that the
detector recognises in time. A sequence at rest has an alarm at s ≤ 0, a stroke is missed at s ≥ 0. s is found by
halving, 13 times, between -150 and 150 m/s²; whether the event comes true is decided by the sequence as it is.
"""

from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from uavsim.scenario import Scenario
from uavsim.studies.campaign.rare.estimate import Inputs
from uavsim.studies.campaign.rare.splitting import Splitter, Watch
from uavsim.studies.detections import BatchDetector
from uavsim.studies.trials import GRACE, uncommanded
from uavsim.truth import STANDARD_GRAVITY as G0

Floats = NDArray[np.float64]

REST = 5.0  # s, of a sequence at rest
MOST_RAISED = 150.0  # m/s²
HALVINGS = 13  # to 0.02 m/s²


def _sigma(scenario: Scenario, sigma: float | None) -> Floats:
    """Deviation of a reading on each axis, m/s²."""
    if sigma is None:
        return np.array(scenario.accelerometer.description().reading_sd)
    if not 0.0 < sigma < np.inf:
        raise ValueError(f"sigma must be above 0 and finite, not {sigma:g} m/s²")
    return np.full(3, sigma)


def _at_rest(scenario: Scenario) -> Floats:
    """True force on the rail, shape (3,), m/s²."""
    elevation = radians(scenario.launcher.elevation_deg)
    return np.array([G0 * sin(elevation), 0.0, -G0 * cos(elevation)])


def at_rest(scenario: Scenario, *, sigma: float | None = None, seconds: float = REST) -> Watch | Inputs:
    """False launches at rest: the scenario's detector on the noise of its accelerometer.

    Parameters
    ----------
    scenario : Scenario
    sigma : float, optional
        Of the noise at the detector, m/s², vibration included; None: that of the accelerometer's readings.
    seconds : float
        Length of the sequence, s.

    Returns
    -------
    Watch or Inputs
        A `Watch` where the detector can be split; else inputs of subset simulation.

    Raises
    ------
    ValueError
        Settings that do not fit together, or a length without a sample.
    """
    rate = scenario.accelerometer.description().rate
    n = round(seconds * rate)
    if n < 1:
        raise ValueError(f"{seconds:g} s hold no sample at {rate:g} Hz")
    force = np.tile(_at_rest(scenario), (n, 1))
    deviation = _sigma(scenario, sigma)
    axes = scenario.detector.axes
    if isinstance(axes, tuple) and len(axes) == 1:
        axis, sign = "xyz".index(axes[0][1]), -1.0 if axes[0][0] == "-" else 1.0
        watch = Watch(scenario.detector, sign * force[:, axis], float(deviation[axis]), rate)
        if Splitter.takes(watch):
            return watch
    return Inputs(_Raised(scenario, force, deviation, rate, deadline=n, missed=False), _dimension(scenario, n, rate))


def in_stroke(scenario: Scenario, *, sigma: float | None = None, index: int = 0) -> Inputs:
    """Misses: the stroke of one flight in which nothing is commanded, read by any number of units.

    Parameters
    ----------
    scenario : Scenario
        With the seed of the flight.
    sigma : float, optional
        As of `at_rest`.
    index : int
        Of the flight under the seed.

    Raises
    ------
    ValueError
        If the catapult does not move the aircraft.
    """
    rate = scenario.accelerometer.description().rate
    force, step_rate, end = uncommanded(scenario, index)
    at = np.arange(int(len(force) / step_rate * rate)) / rate
    read = force[np.minimum(np.round(at * step_rate).astype(int), len(force) - 1)]
    deadline = int((end + GRACE) * rate) + 1
    margins = _Raised(scenario, read, _sigma(scenario, sigma), rate, deadline=deadline, missed=True)
    return Inputs(margins, _dimension(scenario, len(read), rate))


def _dimension(scenario: Scenario, n: int, rate: float) -> int:
    return (n + 1) * len(BatchDetector(scenario.detector, rate).columns)


class _Raised:
    """Margins of sequences; inputs are the offset of each axis that the detector reads, then the noise of samples."""

    def __init__(
        self, scenario: Scenario, force: Floats, sigma: Floats, rate: float, *, deadline: int, missed: bool
    ) -> None:
        self._detector = BatchDetector(scenario.detector, rate)
        self._force, self._sigma = force, sigma
        self._deadline, self._missed = deadline, missed
        description = scenario.accelerometer.description()
        self._offset = np.array([description.offset_sd(i, warmer=0.0, shaking=0.0, down=0.0) for i in range(3)])
        name = scenario.launch_axis
        self._raise = np.zeros(3)
        self._raise["xyz".index(name[1])] = -1.0 if name[0] == "-" else 1.0

    def __call__(self, u: Floats) -> Floats:
        """Margins of inputs, shape (n,), m/s²."""
        columns = list(self._detector.columns)
        m, samples, width = len(u), len(self._force), len(columns)
        read = np.tile(self._force, (m, 1, 1))
        read[:, :, columns] += (u[:, :width] * self._offset[columns])[:, np.newaxis, :]
        read[:, :, columns] += u[:, width:].reshape(m, samples, width) * self._sigma[columns]
        now = self._recognised(read, np.zeros(m))
        low, high = np.where(now, -MOST_RAISED, 0.0), np.where(now, 0.0, MOST_RAISED)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            seen = self._recognised(read, middle)
            low, high = np.where(seen, low, middle), np.where(seen, middle, high)
        return -low if self._missed else high

    def _recognised(self, read: Floats, raised: Floats) -> NDArray[np.bool_]:
        first = self._detector.first(one + s * self._raise for one, s in zip(read, raised, strict=True))
        return (first >= 0) & (first <= self._deadline)
