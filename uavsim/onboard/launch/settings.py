"""Which detector is flown: settings in seconds and m/s², and the detector that they make at a rate in Hz."""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Annotated, Any, Literal

from annotated_types import Gt, Interval, MinLen

from uavsim.failure import built
from uavsim.onboard.interface import Detector
from uavsim.onboard.launch.adaptive_cusum import AdaptiveCusumSettings
from uavsim.onboard.launch.altos import AltOsSettings
from uavsim.onboard.launch.ardupilot import ArduPilotSettings
from uavsim.onboard.launch.bounds import Force, Time
from uavsim.onboard.launch.cusum import CusumSettings
from uavsim.onboard.launch.detector import Axis, require
from uavsim.onboard.launch.glr import GlrSettings
from uavsim.onboard.launch.guarded import GuardedDetector
from uavsim.onboard.launch.inav import InavSettings
from uavsim.onboard.launch.kinds import KINDS, OPTIONS, Kind
from uavsim.onboard.launch.paparazzi import PaparazziSettings
from uavsim.onboard.launch.px4 import Px4Settings
from uavsim.registry import made


@dataclass(frozen=True, slots=True)
class DetectorSettings:
    """Which detector is flown, and its settings in seconds and m/s².

    Attributes
    ----------
    kind : str
        "adaptive-cusum" is the best there is here, "multi-level-window" the published method; the windows and the
        thresholds to be held are its rivals; "px4" to "altos" fly the rules of those autopilots, whose defaults their
        groups have. Others come from packages, from `--plugin` or from Python.
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
    options : group
        Settings of a detector that is not one of ours, as that has them.
    """

    kind: str = "adaptive-cusum"
    threshold: Force = 45.11
    trigger: Force | None = None
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
    options: dict[str, Any] | None = field(default=None, hash=False)


def kind_of(settings: DetectorSettings) -> Kind:
    """Return the kind that settings name.

    Raises
    ------
    ValueError
        If nobody has registered it.
    """
    require(settings.kind in KINDS, f"detector {settings.kind!r} is not registered; there are {', '.join(KINDS)}")
    return KINDS[settings.kind]


def if_known(settings: DetectorSettings) -> Kind:
    """Return the kind that settings name; one that says nothing of itself if it is not registered here."""
    return KINDS[settings.kind] if settings.kind in KINDS else Kind(settings.kind, object, _nobody)


def _nobody(settings: DetectorSettings, _: float) -> Detector:
    raise ValueError(f"detector {settings.kind!r} is not registered")


def unread(settings: DetectorSettings) -> tuple[str, ...]:
    """Keys that differ from their defaults, though the kind that was chosen does not read them; `cusum.limit`."""
    passed = {"kind", "axes", *kind_of(settings).reads}
    return tuple(
        key
        for (key, value), (_, plain) in zip(_leaves(settings), _leaves(DetectorSettings()), strict=True)
        if key.split(".")[0] not in passed and value != plain
    )


def _leaves(settings: DetectorSettings) -> Iterator[tuple[str, Any]]:
    """Keys and values, those of groups one by one; options are one."""
    for key, value in ((f.name, getattr(settings, f.name)) for f in fields(settings)):
        if is_dataclass(value) and key != OPTIONS:
            yield from ((f"{key}.{f.name}", getattr(value, f.name)) for f in fields(value))
        else:
            yield key, value


def get(settings: DetectorSettings, key: str) -> Any:
    """Value of a key, a group's joined by a dot; that of an option that is not given is its default."""
    first, _, inner = key.partition(".")
    group = getattr(settings, first)
    if first == OPTIONS:
        options = kind_of(settings).options
        group = None if options is None else made(options, group)
    return getattr(group, inner) if inner else group


def with_key(settings: DetectorSettings, key: str, value: Any) -> DetectorSettings:
    """The same detector with another value of one key, a group's joined by a dot; bounds are not looked at."""
    first, _, inner = key.partition(".")
    if not inner:
        return replace(settings, **{first: value})
    group = getattr(settings, first)
    if first == OPTIONS and not is_dataclass(group):
        return replace(settings, options={**(group or {}), inner: value})
    return replace(settings, **{first: replace(group, **{inner: value})})


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
        Ours abandon windows at gaps above three nominal periods; others are guarded (`guarded`).

    Raises
    ------
    ValueError
        Settings that do not fit together, a kind that is not registered, or a rate that is not above 0.
    """
    require(rate > 0.0, "rate must be above 0 Hz")
    kind = kind_of(settings)
    if kind.ours:
        return kind.build(settings, rate)
    with built(f"detector {kind.name!r}"):
        return GuardedDetector(kind.name, kind.build(settings, rate))


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
