"""Which detector is flown: settings in seconds and m/s², and the detector that they make at a rate in Hz."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Gt, Interval, MinLen

from uavsim.onboard.launch.detector import GAP_PERIODS, Axis, require
from uavsim.onboard.launch.nested import MultiLevelWindow


@dataclass(frozen=True, slots=True)
class DetectorSettings:
    """Which detector is flown, and its settings in seconds and m/s².

    Attributes
    ----------
    kind : str
        "multi-level-window", the published method.
    threshold : float
        G2, m/s². 45.11 is 4.6 g: above a centrifuge run at 4.1 g with its noise, below the weakest launch of 5 g.
    trigger : float, optional
        G1, m/s², not below the threshold. None: equal to it.
    window : float
        Length of the first window, s; n = round(window·rate), at least 1.
    levels : int
        Number of nested windows.
    ratio : float
        Share of samples above the threshold that recognises.
    axes : tuple of str, or "any"
        Signed body axes, or any of them by magnitude.
    rearm : bool
        Whether it triggers again after its last window failed.
    """

    kind: Literal["multi-level-window"] = "multi-level-window"
    threshold: Annotated[float, Interval(gt=0.0, le=2000.0)] = 45.11
    trigger: Annotated[float, Interval(gt=0.0, le=2000.0)] | None = None
    window: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.018
    levels: Annotated[int, Interval(ge=1, le=100)] = 4
    ratio: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.8
    axes: Annotated[tuple[Axis, ...], MinLen(1)] | Literal["any"] = ("+x",)
    rearm: bool = True


def build(settings: DetectorSettings, rate: Annotated[float, Gt(0.0)]) -> MultiLevelWindow:
    """Make the detector for an accelerometer of the given rate.

    Parameters
    ----------
    settings : DetectorSettings
        What to build.
    rate : float
        Samples a second, Hz.

    Returns
    -------
    MultiLevelWindow
        A detector whose windows are abandoned at gaps above three nominal periods.

    Raises
    ------
    ValueError
        Settings that do not fit together, or a rate that is not above 0.
    """
    require(rate > 0.0, "rate must be above 0 Hz")
    return MultiLevelWindow(
        trigger=settings.threshold if settings.trigger is None else settings.trigger,
        threshold=settings.threshold,
        samples=max(1, round(settings.window * rate)),
        levels=settings.levels,
        ratio=settings.ratio,
        axes=settings.axes,
        rearm=settings.rearm,
        max_gap=GAP_PERIODS / rate,
    )


def default(rate: float = 1000.0) -> MultiLevelWindow:
    """Make the detector that the packaged scenarios fly, on the body x axis.

    Parameters
    ----------
    rate : float
        Accelerometer samples a second, Hz.

    Examples
    --------
    >>> detector = default()
    >>> steps = [detector.step(0.001 * k, 60.0, 0.0, -9.8) for k in range(20)]
    >>> steps.index(True)  # the eighteenth sample ends the first window
    17
    """
    return build(DetectorSettings(), rate)
