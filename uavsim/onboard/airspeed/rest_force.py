"""What f_x reads at rest on the rail: g·sin(elevation) and the bias together.

It is the mean over a block of half a second. The last block may hold the beginning of a stroke, so the one before
counts.
"""

from math import inf, sqrt

from uavsim.onboard.plausible import MOST_FORCE

# standard deviations of a reading up to which it is plausible at rest, where heavy shaking makes more than the bound of
# a force of flight. By hand
NOISY = 10.0
BLOCK = 0.5  # s of a mean: white noise of 1 m/s² at 1 kHz leaves 0.045 m/s². By hand
WANDER = 0.02  # m/s², what a mean is off by beside its noise: the bias has changed since. By hand
UNKNOWN = 5.0  # m/s², standard deviation while nothing has been read: g sin 30° is 4.9


class RestForce:
    """Block means of f_x before a launch.

    Parameters
    ----------
    sd : float
        Noise of one reading, m/s².
    most : float
        Greatest force that is plausible at rest, m/s².

    Attributes
    ----------
    mean : float
        The last answer, m/s².
    """

    __slots__ = ("_count", "_done", "_last", "_most", "_sd", "_start", "_sum", "mean")

    def __init__(self, sd: float, most: float = MOST_FORCE) -> None:
        self._sd, self._most = sd, max(most, NOISY * sd)
        self.mean = 0.0
        self.forget()

    def forget(self) -> None:
        """Begin again."""
        self._start, self._sum, self._count = -inf, 0.0, 0
        self._last = self._done = (0.0, 0)  # mean, readings

    def add(self, t: float, f: float) -> None:
        """Take a reading whose time stamp is believed; one that is NaN or implausible is passed over."""
        if not -self._most < f < self._most:
            return
        if not 0.0 <= t - self._start < BLOCK:  # a step of the clock ends it, too
            if self._count:
                self._done, self._last = self._last, (self._sum / self._count, self._count)
            self._start, self._sum, self._count = t, 0.0, 0
        self._sum += f
        self._count += 1

    def result(self, start: float) -> tuple[float, float]:
        """Return mean and standard deviation, m/s², of a block that was over by `start`, s, or of what there is."""
        mean, count = self._last if self._start <= start else self._done
        if not count:
            mean, count = self._last
        if not count:
            self.mean = 0.0
            return 0.0, UNKNOWN
        self.mean = mean
        return mean, sqrt(self._sd * self._sd / count + WANDER * WANDER)
