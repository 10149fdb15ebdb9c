"""What a launch detector does on logs of 50 to 200 Hz: alarms an hour in handling, delays, and what no rule can beat.

A log is slower than what shakes it. If what is above half its rate is not filtered off before it is sampled it comes
back as something slow (aliasing), and a shock of 3 ms is one reading, as large as a launch's. So the same disturbances,
made at 1 kHz, are read in two ways:

    filtered    a low-pass without phase, flat up to 0.32, and 60 dB down from 0.4 of the log's rate on, then every
                k-th sample
    plain       every k-th sample

Delays are those of launches of the measured catapult, from the true onset, at any phase of the samples. The bound is
Neyman and Pearson's (`uavsim.studies.neyman_pearson`), averaged over the phase of the samples: the earliest time at
which a rule that is told shape and onset recognises with P_D 0.5, at P_FA 1e-6 against a load of 4.1 g.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.launch import DetectorSettings, build
from uavsim.studies.detections import BatchDetector
from uavsim.studies.false_alarms import CLIP, DISTURBANCES, PIECE
from uavsim.studies.intervals import rate_interval
from uavsim.studies.neyman_pearson import earliest_deadline
from uavsim.studies.signals import MEASURED_CATAPULT, Stroke, record_launches
from uavsim.studies.signals.stroke import CATAPULT_PEAK, CATAPULT_TIME
from uavsim.truth import STANDARD_GRAVITY as G0

Array = NDArray[np.float64]

FAST = 1000.0  # Hz, at which disturbances are made
PASSED, STOPPED = 0.32, 0.40  # of the log's rate: up to where the low-pass is flat, and from where on nothing is left
DOWN = 60.0  # dB, of what is not passed
LOAD, RAIL = 4.1 * G0, 20.0  # m/s², the load that is no launch; degrees, of the rail
SLOW = 250.0  # Hz; of faster logs one reading is shorter than any shock, and no rule decides on it
REST = 2.0  # m/s², along the rail
SEED = 16
PHASES = 20  # of the samples, over which the bound is averaged


@dataclass(frozen=True, slots=True)
class Alarms:
    """Alarms of one detector in so many hours."""

    count: int
    hours: float

    @property
    def rate(self) -> float:
        """Alarms an hour."""
        return self.count / self.hours

    @property
    def most(self) -> float:
        """Upper 95 % bound of the rate, 1/h."""
        return rate_interval(self.count, self.hours)[1]


def lowpass(rate: float) -> Array:
    """Return the low-pass before a log of a rate, Hz: coefficients at 1 kHz, symmetric."""
    from scipy.signal import firwin, kaiserord

    taps, beta = kaiserord(DOWN, (STOPPED - PASSED) * rate / (0.5 * FAST))
    coefficients: Array = firwin(taps | 1, 0.5 * (PASSED + STOPPED) * rate, window=("kaiser", beta), fs=FAST)
    return coefficients


def slowed(force: NDArray[np.floating], rate: float, *, filtered: bool) -> Array:
    """Return what a log of a rate, Hz, has of a force at 1 kHz, shape (n, axes).

    Raises
    ------
    ValueError
        If the rate is no whole part of 1 kHz.
    """
    every = round(FAST / rate)
    if abs(every * rate - FAST) > 1e-9 * FAST or every < 1:
        raise ValueError(f"{rate:g} Hz is no whole part of {FAST:g} Hz")
    read = np.asarray(force, np.float64)
    if filtered and every > 1:
        from scipy.signal import oaconvolve

        read = oaconvolve(read, lowpass(rate)[:, np.newaxis], mode="same", axes=0)
    return np.ascontiguousarray(read[::every])


def alarms(
    detectors: Sequence[DetectorSettings], rate: float, hours: float, *, seed: int, filtered: bool, kind: str = "mix"
) -> list[Alarms]:
    """Count the alarms of detectors on a log of a rate, in pieces of ten minutes as `uavsim.studies.false_alarms`.

    Parameters
    ----------
    detectors
        Their settings.
    rate
        Of the log, Hz, a whole part of 1 kHz.
    hours
        Rounded up to whole pieces.
    seed
        Of the disturbances.
    filtered
        Whether what is above 0.4 of the rate is filtered off first.
    kind
        Class of disturbances, of `uavsim.studies.false_alarms.DISTURBANCES`.
    """
    batches = [BatchDetector(one, rate) for one in detectors]
    counts = [0] * len(batches)
    pieces = int(np.ceil(hours * 3600.0 / PIECE))
    for k in range(pieces):
        force = slowed(DISTURBANCES[kind].piece(seed, k, FAST, (0, 1, 2)), rate, filtered=filtered)
        for i, batch in enumerate(batches):
            batch.reset()
            counts[i] += int(batch.alarms(force).size)
    return [Alarms(count, pieces * PIECE / 3600.0) for count in counts]


def delays(detector: DetectorSettings, rate: float, n: int, *, seed: int, sigma_g: float) -> Array:
    """Return the delays of n launches of the measured catapult from the true onset on, s; NaN where there is no alarm.

    An alarm before the onset has a negative one.
    """
    drawn = record_launches(replace(MEASURED_CATAPULT, sigma_g=sigma_g), seed, n, rate)
    found = BatchDetector(detector, rate).first(drawn.f)
    onset = np.array([truth.onset for truth in drawn.truths])
    return np.where(found < 0, np.nan, found / rate - onset)


def bound(rate: float, sigma_g: float) -> float | None:
    """Return the mean over the phase of the earliest time after the onset, s; None if no rule reaches P_D."""
    stroke = Stroke("catapult", CATAPULT_PEAK, CATAPULT_TIME, 0.030)
    found = []
    for phase in (np.arange(PHASES) + 0.5) / PHASES / rate:
        t = phase + np.arange(round(CATAPULT_TIME * rate)) / rate
        felt = stroke.force(t) + G0 * np.sin(np.radians(RAIL))
        earliest = earliest_deadline(felt, level=LOAD, sigma=sigma_g * G0, probability=0.5, period=1.0 / rate)
        if earliest is None:
            return None
        found.append(phase + earliest)
    return float(np.mean(found))


def decides_alone(settings: DetectorSettings, rate: float) -> bool:
    """Whether one reading of the accelerometer's whole range, after two seconds of rest, is a launch to a detector."""
    detector = build(settings, rate)
    forces = [REST] * round(2.0 * rate) + [CLIP * G0] + [REST] * round(rate)
    seen = [detector.step(k / rate, f, 0.0, -G0) for k, f in enumerate(forces)]
    return True in seen


def remark(settings: DetectorSettings, rate: float) -> str | None:
    """Say how often a detector cries wolf that decides on one reading of a slow log; None if this one does not.

    It is tried for an hour of handling at the nearest rate that is a whole part of 1 kHz, the same hour at each call.
    """
    if rate > SLOW or not decides_alone(settings, rate):
        return None
    near = FAST / round(FAST / rate)
    (plain,), (quiet,) = (alarms((settings,), near, 1.0, seed=SEED, filtered=filtered) for filtered in (False, True))
    return (
        f"{settings.kind} decides on one reading at {rate:.4g} Hz, without confirmation: in handling {plain.rate:.3g} "
        f"alarms an hour at {near:.4g} Hz, {quiet.rate:.3g} if what is above {STOPPED * near:.3g} Hz was filtered off "
        "before it was sampled"
    )
