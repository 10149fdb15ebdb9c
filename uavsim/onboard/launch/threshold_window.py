"""One window of n samples, opened by a sample above a trigger G1 and tested at its end: N / n ≥ k₁.

N counts the samples above the threshold G2, the first one included. It is the published method with a single level.
Source: "threshold + time window", to which the published method compares itself.
"""

from math import isfinite

from uavsim.onboard.launch.axis import whole
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.kinds import WINDOWS, Level, Second, Window, one_axis
from uavsim.onboard.launch.levels import above_trigger, lines_of
from uavsim.onboard.launch.nested import MultiLevelWindow


class ThresholdWindow(MultiLevelWindow):
    """One window, opened by a sample above a trigger and tested at its end.

    Parameters
    ----------
    rate : float
        Samples a second, Hz.
    threshold : float
        G2, m/s². A sample counts if it is strictly above.
    window : float
        Its length, s; n = round(window·rate), at least 1.
    ratio : float
        k₁, the share of samples above the threshold at which the launch is recognised, 0 < k₁ ≤ 1.
    trigger : float, optional
        G1 ≥ G2, m/s². None: equal to it.
    axis : str
        Signed body axis that points along the launch.
    rearm : bool
        Whether it opens again after it failed; if not it is dead until `reset`.

    Raises
    ------
    ValueError
        Settings outside their bounds.
    """

    __slots__ = ()

    def __init__(
        self,
        rate: float,
        *,
        threshold: float,
        window: float,
        ratio: float,
        trigger: float | None = None,
        axis: Axis = "+x",
        rearm: bool = True,
    ) -> None:
        require(isfinite(rate) and rate > 0.0, "rate must be above 0 Hz")
        super().__init__(
            trigger=threshold if trigger is None else trigger,
            threshold=threshold,
            samples=whole(window, rate, "window"),
            levels=1,
            ratio=ratio,
            axes=(axis,),
            rearm=rearm,
            period=1.0 / rate,
        )


one_axis(
    "threshold-window",
    ThresholdWindow,
    reads=("threshold", "trigger", "window", "ratio", "rearm"),
    level=Level("threshold", beside=("trigger",)),
    second=Second("window", WINDOWS),
    need=above_trigger,
    lines=lines_of,
    window=lambda settings: Window(1, settings.ratio),
)
