"""The posterior Cramér-Rao bound of many courses and, in the same pass, of courses drawn from them with replacement.

The expectations of `studies.cramer_rao` are means over courses, so they have a sampling error of their own. A resample
is a set of weights w of the courses: E[FᵀQ⁻¹F] becomes Σ w FᵀQ⁻¹F, and so on. Q, which the settings decide and the mean
course only scales, is that of all courses in every resample. The deviation over the resamples is the standard error
(Efron & Tibshirani, An Introduction to the Bootstrap, 1993, ch. 6).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from uavsim.studies.cramer_rao import SIZE, AirspeedBound

Array = NDArray[np.float64]

RESAMPLES = 40  # the relative error of the standard error that they give is 1/√80, 11 %
EVERY = 10  # readings between those at which resamples are looked at: a bin of the campaign's traces at 100 Hz


class ResampledBound(AirspeedBound):
    """A bound whose `sd` writes down that of resamples, too.

    Attributes
    ----------
    at : list of int
        Readings at which resamples are looked at.
    resampled : list of ndarray
        Shape (`RESAMPLES`,) each: least standard deviations there, m/s.
    """

    def _sd(self) -> Array:
        m = len(self._courses.airspeed)
        self._weights = np.random.default_rng(0).multinomial(m, np.full(m, 1.0 / m), size=RESAMPLES) / m
        self._stack = np.tile(np.linalg.inv(self._initial), (RESAMPLES, 1, 1))
        self._reading = 0
        self.at: list[int] = []
        self.resampled: list[Array] = []
        return super()._sd()

    def _predict(self, f: Array, noise: Array) -> None:
        super()._predict(f, noise)
        self._stack = self._predicted(f, noise)

    def _turn(self, turn: Array) -> None:
        super()._turn(turn)
        self._stack = turn @ self._stack @ turn.T

    def _predicted(self, f: Array, noise: Array) -> Array:
        inverse = np.linalg.inv(noise)
        mean = self._mean(f)
        d11 = self._mean(f.transpose(0, 2, 1) @ inverse @ f)
        d12 = -mean.transpose(0, 2, 1) @ inverse
        j = inverse - d12.transpose(0, 2, 1) @ np.linalg.solve(self._stack + d11, d12)
        return np.asarray(0.5 * (j + j.transpose(0, 2, 1)), dtype=np.float64)

    def _mean(self, matrices: Array) -> Array:
        """Weighted means of matrices of the courses, shape (m, n, n); one a resample."""
        flat = self._weights @ matrices.reshape(len(matrices), -1)
        return np.asarray(flat.reshape(-1, SIZE, SIZE), dtype=np.float64)

    def _take(self, slopes: Mapping[int, float | Array], sd: float) -> None:
        super()._take(slopes, sd)
        row = np.zeros((len(self._courses.airspeed), SIZE))
        for state, slope in slopes.items():
            row[:, state] = slope
        self._stack = self._stack + self._mean(row[:, :, None] * row[:, None, :]) / sd**2

    def _told(self, t: float) -> float:
        if self._reading % EVERY == 0:
            stack = self._predicted(*self._model(self.time, t)) if t > self.time else self._stack
            self.at.append(self._reading)
            self.resampled.append(np.sqrt(self._of_speed(np.asarray(np.linalg.inv(stack)), t)))
        self._reading += 1
        return super()._told(t)
