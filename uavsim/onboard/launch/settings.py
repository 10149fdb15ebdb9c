"""Which detector is flown: settings in seconds and m/s², and the detector that they make at a rate in Hz."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from typing import Annotated, Any, Literal

from annotated_types import Gt, Interval, MinLen

from uavsim.onboard.launch.adaptive_cusum import AdaptiveCusum
from uavsim.onboard.launch.axis import GRAVITY
from uavsim.onboard.launch.cusum import Cusum
from uavsim.onboard.launch.detector import Axis, Detector, require
from uavsim.onboard.launch.field import LOOP, AltOs, ArduPilot, Inav, Paparazzi, Px4, Px4Norm
from uavsim.onboard.launch.glr import GlrBank
from uavsim.onboard.launch.hold import DoubleThreshold, SingleThreshold
from uavsim.onboard.launch.nested import MultiLevelWindow
from uavsim.onboard.launch.window import SequenceWindow, SlidingWindow, ThresholdWindow

Level = Annotated[float, Interval(gt=0.0, le=2000.0)]
Time = Annotated[float, Interval(gt=0.0, le=1.0)]
Frequency = Annotated[float, Interval(gt=0.0, le=100_000.0)]

BELOW = 0.1 * GRAVITY  # m/s², of a threshold that samples exceed: where a sum begins to grow instead


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
class AdaptiveCusumSettings:
    """Clipped cumulative sum whose limit follows the roughness, `kind = "adaptive-cusum"`.

    Attributes
    ----------
    reference : float, optional
        c, m/s². None: the detector's threshold less 0.1 g, by default 4.5 g.
    rise : float
        Most that a sample adds, m/s².
    fall : float
        Most that a sample takes off, m/s².
    limit : float
        Least limit, m/s; over the rise it is the time that a launch takes. 0.08826 is 9 g·ms.
    highest : float
        Highest limit, m/s, not below the least. 0.1569 is 16 g·ms.
    gain : float
        Limit over roughness, s.
    mean : float
        Time constant of the short mean, s.
    memory : float
        Time constant of the roughness, s; at least three periods of the accelerometer are taken.
    """

    reference: Level | None = None
    rise: Level = 9.80665
    fall: Level = 14.71
    limit: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.08826
    highest: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.1569
    gain: Time = 0.015
    mean: Time = 0.002
    memory: Annotated[float, Interval(gt=0.0, le=100.0)] = 0.2


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


@dataclass(frozen=True, slots=True)
class Px4Settings:
    """PX4's launch detector, `kind = "px4"` or `"px4-norm"`.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that is exceeded. FW_LAUN_AC_THLD.
    time : float
        Time for which, s; exceeded too, in runs of 20 ms. FW_LAUN_AC_T.
    """

    acceleration: Level = 30.0
    time: Time = 0.05


@dataclass(frozen=True, slots=True)
class ArduPilotSettings:
    """ArduPlane's check of the forward acceleration, `kind = "ardupilot"`.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that the mean of five values at 50 Hz reaches. TKOFF_THR_MINACC; 15 is what its manual
        gives for throws and bungees, the firmware's own default 0 is no test.
    delay : float
        Time from then to the launch, s. TKOFF_THR_DELAY, which is in tenths of a second.
    """

    acceleration: Level = 15.0
    delay: Annotated[float, Interval(ge=0.0, le=12.7)] = 0.2


@dataclass(frozen=True, slots=True)
class InavSettings:
    """iNav's launch by acceleration, `kind = "inav"`.

    Attributes
    ----------
    acceleration : float
        m/s², with gravity, that is exceeded. nav_fw_launch_accel, which is in cm/s².
    time : float
        Time for which, s. nav_fw_launch_detect_time, which is in ms.
    cutoff : float
        Of the second-order low-pass before it, Hz. acc_lpf_hz.
    """

    acceleration: Level = 18.63
    time: Time = 0.04
    cutoff: Frequency = 15.0


@dataclass(frozen=True, slots=True)
class PaparazziSettings:
    """Paparazzi's catapult module, `kind = "paparazzi"`.

    Attributes
    ----------
    acceleration : float
        m/s², with gravity, that is reached: 1.5 g. NAV_CATAPULT_ACCELERATION_THRESHOLD, which is in g.
    calls : int
        Calls in a row at which it is. NAV_CATAPULT_ACCELERATION_DETECTION.
    call_rate : float
        Calls a second, Hz: that of the airframe's main loop.
    """

    acceleration: Level = 1.5 * GRAVITY
    calls: Annotated[int, Interval(ge=1, le=10_000)] = 5
    call_rate: Frequency = 60.0


@dataclass(frozen=True, slots=True)
class AltOsSettings:
    """AltOS's lift-off by acceleration and speed, `kind = "altos"`; the firmware's values are fixed.

    Attributes
    ----------
    acceleration : float
        m/s², without gravity, that is exceeded.
    speed : float
        m/s, the integral of the acceleration, that is exceeded.
    """

    acceleration: Level = 20.0
    speed: Annotated[float, Interval(ge=0.0, le=1000.0)] = 5.0


Kind = Literal[
    "multi-level-window",
    "threshold-window",
    "sliding-window",
    "sequence-window",
    "single-threshold",
    "double-threshold",
    "cusum",
    "adaptive-cusum",
    "glr-bank",
    "px4",
    "px4-norm",
    "ardupilot",
    "inav",
    "paparazzi",
    "altos",
]

# Keys that a kind reads besides `kind` and `axes`; a group is read whole.
USES: dict[Kind, tuple[str, ...]] = {
    "multi-level-window": ("threshold", "trigger", "window", "levels", "ratio", "rearm"),
    "threshold-window": ("threshold", "trigger", "window", "ratio", "rearm"),
    "sliding-window": ("threshold", "window", "ratio"),
    "sequence-window": ("threshold", "trigger", "window", "ratio", "sequence"),
    "single-threshold": ("threshold", "window"),
    "double-threshold": ("threshold", "trigger", "window"),
    "cusum": ("cusum",),
    "adaptive-cusum": ("adaptive", "threshold"),
    "glr-bank": ("glr",),
    "px4": ("px4",),
    "px4-norm": ("px4",),
    "ardupilot": ("ardupilot",),
    "inav": ("inav",),
    "paparazzi": ("paparazzi",),
    "altos": ("altos",),
}

FIELD: tuple[Kind, ...] = ("px4", "px4-norm", "ardupilot", "inav", "paparazzi", "altos")  # what autopilots fly

# Detectors of one signed axis; their arguments have the names of the keys, or of those of the kind's group.
ONE_AXIS: dict[Kind, Callable[..., Detector]] = {
    "threshold-window": ThresholdWindow,
    "sliding-window": SlidingWindow,
    "sequence-window": SequenceWindow,
    "single-threshold": SingleThreshold,
    "double-threshold": DoubleThreshold,
    "cusum": Cusum,
    "adaptive-cusum": AdaptiveCusum,
    "glr-bank": GlrBank,
    "px4": Px4,
    "px4-norm": Px4Norm,
    "ardupilot": ArduPilot,
    "inav": Inav,
    "paparazzi": Paparazzi,
    "altos": AltOs,
}


@dataclass(frozen=True, slots=True)
class DetectorSettings:
    """Which detector is flown, and its settings in seconds and m/s².

    Attributes
    ----------
    kind : str
        "adaptive-cusum" is the best there is here, "multi-level-window" the published method; the windows and the
        thresholds to be held are its rivals; "px4" to "altos" fly the rules of those autopilots, whose defaults their
        groups have.
    threshold : float
        G2, m/s². 45.11 is 4.6 g: above a centrifuge run at 4.1 g with its noise, below the weakest launch of 5 g. The
        reference of "adaptive-cusum" lies 0.1 g below it.
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

    kind: Kind = "adaptive-cusum"
    threshold: Level = 45.11
    trigger: Level | None = None
    window: Time = 0.018
    levels: Annotated[int, Interval(ge=1, le=100)] = 4
    ratio: Annotated[float, Interval(gt=0.0, le=1.0)] = 0.8
    axes: Annotated[tuple[Axis, ...], MinLen(1)] | Literal["any"] = ("+x",)
    rearm: bool = True
    sequence: Time = 0.003
    cusum: CusumSettings = field(default_factory=CusumSettings)
    adaptive: AdaptiveCusumSettings = field(default_factory=AdaptiveCusumSettings)
    glr: GlrSettings = field(default_factory=GlrSettings)
    px4: Px4Settings = field(default_factory=Px4Settings)
    ardupilot: ArduPilotSettings = field(default_factory=ArduPilotSettings)
    inav: InavSettings = field(default_factory=InavSettings)
    paparazzi: PaparazziSettings = field(default_factory=PaparazziSettings)
    altos: AltOsSettings = field(default_factory=AltOsSettings)


def unread(settings: DetectorSettings) -> tuple[str, ...]:
    """Keys that differ from their defaults, though the kind that was chosen does not read them; `cusum.limit`."""
    passed = {"kind", "axes", *USES[settings.kind]}
    return tuple(
        key
        for (key, value), (_, plain) in zip(_leaves(settings), _leaves(DetectorSettings()), strict=True)
        if key.split(".")[0] not in passed and value != plain
    )


def _leaves(settings: DetectorSettings) -> Iterator[tuple[str, Any]]:
    """Keys and values, those of groups one by one."""
    for key, value in ((f.name, getattr(settings, f.name)) for f in fields(settings)):
        if is_dataclass(value):
            yield from ((f"{key}.{f.name}", getattr(value, f.name)) for f in fields(value))
        else:
            yield key, value


def need(settings: DetectorSettings, push: float) -> tuple[str, float, str, float]:
    """What a launch must show at least: key and level that it exceeds, m/s², key and time for which, s.

    The time is that of the shortest window, or of a sum that grows as fast as it can: as a force of `push`, m/s².
    """
    group = USES[settings.kind][0]
    found = _field_need(settings, push)
    if found is not None:
        level, long, time = found
        return f"{group}.acceleration", level, f"{group}.{long}", time
    if settings.kind == "cusum":
        return "cusum.reference", settings.cusum.reference, "cusum.limit", settings.cusum.limit / settings.cusum.rise
    if settings.kind == "adaptive-cusum":
        own, key = settings.adaptive, "threshold" if settings.adaptive.reference is None else "adaptive.reference"
        level = settings.threshold if own.reference is None else own.reference
        return key, level, "adaptive.limit", own.limit / own.rise
    if settings.kind == "glr-bank":
        return "glr.reference", settings.glr.reference, "glr.windows", min(settings.glr.windows)
    trigger = None if "trigger" not in USES[settings.kind] else settings.trigger
    if trigger is None:
        return "threshold", settings.threshold, "window", settings.window
    return "trigger", trigger, "window", settings.window


def _field_need(s: DetectorSettings, push: float) -> tuple[float, str, float] | None:
    """Level, key of the time and the time that an autopilot's rule needs. The delay of ArduPilot needs no force."""
    if s.kind in ("px4", "px4-norm"):
        return s.px4.acceleration, "time", s.px4.time
    if s.kind == "ardupilot":
        return s.ardupilot.acceleration, "acceleration", 1.0 / LOOP
    if s.kind == "inav":
        return s.inav.acceleration, "time", s.inav.time
    if s.kind == "paparazzi":
        return s.paparazzi.acceleration, "calls", (s.paparazzi.calls - 1) / s.paparazzi.call_rate
    if s.kind == "altos":
        return s.altos.acceleration, "speed", s.altos.speed / push
    return None


def reference(threshold: float, own: float | None) -> float:
    """Where the sum of "adaptive-cusum" begins to grow, m/s²: its own setting, else as far below the threshold."""
    return threshold - BELOW if own is None else own


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
            period=1.0 / rate,
        )
    require(s.axes != "any" and len(s.axes) == 1, f'axes must be one signed axis for "{s.kind}"')
    values = {key: getattr(s, key) for key in USES[s.kind]}
    group = values.get(USES[s.kind][0])
    if is_dataclass(group) and not isinstance(group, type):
        values = asdict(group)
    if s.kind == "adaptive-cusum":
        values["reference"] = reference(s.threshold, s.adaptive.reference)
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
    >>> rest, push = (3.0, 0.0, -9.8), (60.0, 0.0, -9.8)
    >>> steps = [detector.step(0.001 * k, *(rest if k < 500 else push)) for k in range(520)]
    >>> steps.index(True) - 500  # ms; nine samples only reach the limit
    9
    """
    return build(DetectorSettings(), rate)
