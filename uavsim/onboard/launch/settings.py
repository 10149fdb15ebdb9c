"""Which detector is flown: settings in seconds and m/s², and the detector that they make at a rate in Hz."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, fields
from typing import Annotated, Literal

from annotated_types import Gt, Interval, MinLen

from uavsim.onboard.launch.cusum import Cusum
from uavsim.onboard.launch.detector import GAP_PERIODS, Axis, Detector, require
from uavsim.onboard.launch.field import AltOs, ArduPilot, Inav, Paparazzi, Px4, Px4Norm
from uavsim.onboard.launch.glr import GlrBank
from uavsim.onboard.launch.hold import DoubleThreshold, SingleThreshold
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.launch.window import SequenceWindow, SlidingWindow, ThresholdWindow

Level = Annotated[float, Interval(gt=0.0, le=2000.0)]
Time = Annotated[float, Interval(gt=0.0, le=1.0)]


@dataclass(frozen=True, slots=True)
class CusumSettings:
    """Clipped cumulative sum, `kind = "cusum"`.

    Attributes
    ----------
    reference : float
        c, m/s². 44.13 is 4.5 g.
    limit : float
        h, m/s. 0.1373 is 14 g·ms.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    """

    reference: Level = 44.13
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.1373
    rise: Level = 9.80665
    fall: Level = 19.6133


@dataclass(frozen=True, slots=True)
class GlrSettings:
    """Bank of clipped likelihood ratios, `kind = "glr-bank"`.

    Attributes
    ----------
    reference : float
        c, m/s². 44.13 is 4.5 g.
    limit : float
        h, m/s² √s. 1.0854 is 3.5 g √ms.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    windows : tuple of float
        Lengths of the windows, s.
    """

    reference: Level = 44.13
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 1.0854
    rise: Level = 9.80665
    fall: Level = 9.80665
    windows: Annotated[tuple[Time, ...], MinLen(1)] = (0.006, 0.012, 0.024, 0.048, 0.096)


Kind = Literal[
    "multi-level-window",
    "threshold-window",
    "sliding-window",
    "sequence-window",
    "single-threshold",
    "double-threshold",
    "cusum",
    "glr-bank",
    "px4",
    "px4-norm",
    "ardupilot",
    "inav",
    "paparazzi",
    "altos",
]

# Keys that a kind reads besides `kind` and `axes`.
USES: dict[Kind, tuple[str, ...]] = {
    "multi-level-window": ("threshold", "trigger", "window", "levels", "ratio", "rearm"),
    "threshold-window": ("threshold", "trigger", "window", "ratio", "rearm"),
    "sliding-window": ("threshold", "window", "ratio"),
    "sequence-window": ("threshold", "trigger", "window", "ratio", "sequence"),
    "single-threshold": ("threshold", "window"),
    "double-threshold": ("threshold", "trigger", "window"),
    "cusum": ("cusum",),
    "glr-bank": ("glr",),
    "px4": (),
    "px4-norm": (),
    "ardupilot": (),
    "inav": (),
    "paparazzi": (),
    "altos": (),
}

# Detectors of one signed axis; their arguments have the names of the keys, or of those of the kind's group.
ONE_AXIS: dict[Kind, Callable[..., Detector]] = {
    "threshold-window": ThresholdWindow,
    "sliding-window": SlidingWindow,
    "sequence-window": SequenceWindow,
    "single-threshold": SingleThreshold,
    "double-threshold": DoubleThreshold,
    "cusum": Cusum,
    "glr-bank": GlrBank,
    "px4": Px4,
    "px4-norm": Px4Norm,
    "ardupilot": ArduPilot,
    "inav": Inav,
    "paparazzi": Paparazzi,
    "altos": AltOs,
}
GROUPED: tuple[Kind, ...] = ("cusum", "glr-bank")

# What a launch must show to the rules of the field: m/s² beyond gravity and for how long, s.
FIELD: dict[Kind, tuple[float, float]] = {
    "px4": (30.0, 0.050),
    "px4-norm": (30.0, 0.050),
    "ardupilot": (15.0, 0.020),
    "inav": (18.63, 0.040),
    "paparazzi": (14.71, 0.067),
    "altos": (20.0, 0.020),
}


@dataclass(frozen=True, slots=True)
class DetectorSettings:
    """Which detector is flown, and its settings in seconds and m/s².

    Attributes
    ----------
    kind : str
        "multi-level-window" is the published method; the windows, the thresholds to be held and "cusum" are its rivals;
        "px4" to "altos" fly the rules of those autopilots with their own defaults.
    threshold : float
        G2, m/s². 45.11 is 4.6 g: above a centrifuge run at 4.1 g with its noise, below the weakest launch of 5 g.
    trigger : float, optional
        G1, m/s², not below the threshold. None: equal to it.
    window : float
        Length of the first window, s; n = round(window·rate), at least 1. Of a threshold to be held: for how long.
    levels : int
        Number of nested windows.
    ratio : float
        Share of samples above the threshold that recognises.
    axes : tuple of str, or "any"
        Signed body axes, or any of them by magnitude. All but "multi-level-window" take one signed axis.
    rearm : bool
        Whether it triggers again after its last window failed.
    sequence : float
        Time for which samples in a row must be above G1 to open a "sequence-window", s.
    """

    kind: Kind = "multi-level-window"
    threshold: Level = 45.11
    trigger: Level | None = None
    window: Time = 0.018
    levels: Annotated[int, Interval(ge=1, le=100)] = 4
    ratio: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.8
    axes: Annotated[tuple[Axis, ...], MinLen(1)] | Literal["any"] = ("+x",)
    rearm: bool = True
    sequence: Time = 0.003
    cusum: CusumSettings = field(default_factory=CusumSettings)
    glr: GlrSettings = field(default_factory=GlrSettings)


def unread(settings: DetectorSettings) -> tuple[str, ...]:
    """Keys that differ from their defaults, though the kind that was chosen does not read them.

    A group's name tells its kind; it may be set and not chosen.
    """
    plain, passed = DetectorSettings(), {"kind", "axes", *USES[settings.kind], *(USES[kind][0] for kind in GROUPED)}
    return tuple(
        f.name for f in fields(settings) if f.name not in passed and getattr(settings, f.name) != getattr(plain, f.name)
    )


def need(settings: DetectorSettings) -> tuple[str, float, str, float]:
    """What a launch must show at least: key and level that it exceeds, m/s², key and time for which, s.

    The time is that of the shortest window, or of a sum that grows as fast as it can.
    """
    if settings.kind == "cusum":
        return "cusum.reference", settings.cusum.reference, "cusum.limit", settings.cusum.limit / settings.cusum.rise
    if settings.kind == "glr-bank":
        return "glr.reference", settings.glr.reference, "glr.windows", min(settings.glr.windows)
    if settings.kind in FIELD:
        level, time = FIELD[settings.kind]
        return "kind", level, "kind", time
    trigger = None if "trigger" not in USES[settings.kind] else settings.trigger
    if trigger is None:
        return "threshold", settings.threshold, "window", settings.window
    return "trigger", trigger, "window", settings.window


def build(settings: DetectorSettings, rate: Annotated[float, Gt(0.0)]) -> Detector:
    """Make the detector for an accelerometer of the given rate.

    Parameters
    ----------
    settings : DetectorSettings
        What to build.
    rate : float
        Samples a second, Hz.

    Returns
    -------
    Detector
        One whose windows are abandoned at gaps above three nominal periods.

    Raises
    ------
    ValueError
        Settings that do not fit together, or a rate that is not above 0.
    """
    require(rate > 0.0, "rate must be above 0 Hz")
    s = settings
    if s.kind == "multi-level-window":
        return MultiLevelWindow(
            trigger=s.threshold if s.trigger is None else s.trigger,
            threshold=s.threshold,
            samples=max(1, round(s.window * rate)),
            levels=s.levels,
            ratio=s.ratio,
            axes=s.axes,
            rearm=s.rearm,
            max_gap=GAP_PERIODS / rate,
        )
    require(s.axes != "any" and len(s.axes) == 1, f'axes must be one signed axis for "{s.kind}"')
    values = {key: getattr(s, key) for key in USES[s.kind]}
    if s.kind in GROUPED:
        (group,) = values.values()
        values = asdict(group)
    return ONE_AXIS[s.kind](rate, axis=s.axes[0], **values)


def default(rate: float = 1000.0) -> Detector:
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
