"""Kinds of launch detector: what each says of itself, so that nobody has to know it by its name.

A kind is registered where its rule stands. One of somebody else's has a class that is built by cls(rate, settings),
with its own `Settings` under [detector.options]; ours read keys of [detector] that several have in common, or a group.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar

from uavsim.onboard.interface import Detector
from uavsim.onboard.launch.detector import require
from uavsim.registry import Registry, made, own_settings

if TYPE_CHECKING:
    from uavsim.onboard.launch.settings import DetectorSettings

C = TypeVar("C", bound=type)

OPTIONS = "options"  # key of [detector] that holds the settings of a kind that is not ours
FORCE = "m/s²"  # unit of a level that the force is held against

# Levels at which a kind's operating curve has points, over the one that is set.
ROUND_IT = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.6)
WIDELY = (0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0)
UPWARDS = (0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0)  # autopilots' own are low

WINDOWS = (0.005, 0.008, 0.012, 0.018, 0.025, 0.035, 0.050)  # s
REFERENCES = (0.4, 0.55, 0.7, 0.8, 0.9)  # over the push


class NoDetectorError(ValueError):
    """A class that lacks what a detector has."""


@dataclass(frozen=True, slots=True)
class Level:
    """The setting that a kind is swept along: a lower one sees more and cries wolf more often.

    Attributes
    ----------
    key : str
        Of [detector], a group's joined by a dot.
    unit : str
        `FORCE` if the force itself is held against it.
    factors : tuple of float
        Levels of the operating curve over the one that is set.
    beside : tuple of str
        Keys that keep their ratio to it.
    """

    key: str
    unit: str = FORCE
    factors: tuple[float, ...] = ROUND_IT
    beside: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Second:
    """The setting that is tuned beside the level.

    Attributes
    ----------
    key : str
        Of [detector].
    values : tuple
        That are tried, beside the one that is set.
    over_push : bool
        Whether these are shares of the force of the push.
    whole : bool
        Whether it is a whole number.
    """

    key: str
    values: tuple[float, ...]
    over_push: bool = False
    whole: bool = False


@dataclass(frozen=True, slots=True)
class Need:
    """What a launch must show at least: a level that it exceeds, m/s², and for how long, s, with the keys that say so.

    Attributes
    ----------
    level_key, time_key : str
    level, time : float
    """

    level_key: str
    level: float
    time_key: str
    time: float


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel below the force in the figure of a launch.

    Attributes
    ----------
    label : str
        Of its ordinate, with the unit.
    curves : tuple of tuple
        Name of each curve and of the detector's attribute that it shows; the second is drawn as a limit.
    scale : float
        Value in SI that is 1 in the label's unit.
    height : float
        Over that of the others.
    """

    label: str
    curves: tuple[tuple[str, str], ...]
    scale: float = 1.0
    height: float = 1.3


@dataclass(frozen=True, slots=True)
class Window:
    """Of a rule that counts in windows: how many are nested, and the share that recognises."""

    levels: int
    ratio: float


@dataclass(frozen=True)
class Kind:
    """One kind of launch detector.

    Attributes
    ----------
    name : str
        By which a scenario names it.
    cls : callable
        The rule's class.
    build : callable
        Makes the detector from the settings and the rate, Hz.
    reads : tuple of str
        Keys of [detector] that it reads besides `kind` and `axes`; a group is read whole.
    options : type, optional
        Dataclass of [detector.options], if it reads those.
    watches, unit : str
        What its attribute `level` is, and the unit, if that is no count.
    level : Level, optional
        None: its operating curve is a point.
    second : Second or callable, optional
        Itself, or from the settings.
    need : callable, optional
        From the settings and the push, m/s².
    lines : callable, optional
        Levels of the settings that are drawn across the force, m/s², by their names.
    panels : tuple of Panel
        What is drawn below the force, of the detector's own attributes.
    window : callable, optional
        From the settings; of a rule that counts in windows.
    many_axes : bool
        Whether it takes several axes, or "any".
    autopilot : bool
        Whether an autopilot flies it: a rival that the default is compared with.
    short : str
        Name in narrow tables.
    ours : bool
        Whether it comes with uavsim, and returns whatever it reads.
    """

    name: str
    cls: Callable[..., Any]
    build: "Callable[[DetectorSettings, float], Detector]"
    reads: tuple[str, ...] = ()
    options: type | None = None
    watches: str = ""
    unit: str = ""
    level: Level | None = None
    second: "Second | Callable[[DetectorSettings], Second] | None" = None
    need: "Callable[[DetectorSettings, float], Need] | None" = None
    lines: "Callable[[DetectorSettings], Mapping[str, float]] | None" = None
    panels: tuple[Panel, ...] = field(default=())
    window: "Callable[[DetectorSettings], Window] | None" = None
    many_axes: bool = False
    autopilot: bool = False
    short: str = ""
    ours: bool = False

    def second_of(self, settings: "DetectorSettings") -> Second | None:
        """Return the setting that is tuned beside the level."""
        return self.second(settings) if callable(self.second) else self.second


KINDS: Registry[Kind] = Registry("detector")
"""Every kind that is registered."""


def one_axis(
    name: str,
    cls: "Callable[..., Detector]",
    *,
    reads: tuple[str, ...] = (),
    group: str = "",
    arguments: "Callable[[DetectorSettings], Mapping[str, Any]] | None" = None,
    **says: Any,
) -> None:
    """Register one of ours, of one signed body axis.

    Parameters
    ----------
    name, cls
        As of `Kind`; `cls` takes the rate, `axis`, and what follows by the names of the keys.
    reads : tuple of str
        Keys of [detector].
    group : str
        Of [detector], which is read whole.
    arguments : callable, optional
        Gives the arguments, where they are not just the keys or the group.
    **says
        What else `Kind` has.
    """

    def build(settings: "DetectorSettings", rate: float) -> Detector:
        require(settings.axes != "any" and len(settings.axes) == 1, f'axes must be one signed axis for "{name}"')
        if arguments is not None:
            values = arguments(settings)
        else:
            values = asdict(getattr(settings, group)) if group else {key: getattr(settings, key) for key in reads}
        return cls(rate, axis=settings.axes[0], **values)

    KINDS.add(Kind(name, cls, build, reads=(group, *reads) if group else reads, ours=True, **says))


def detector(name: str, *, level: str = "", unit: str = "") -> Callable[[C], C]:
    """Register a class as a kind of launch detector.

    The class is built by ``cls(rate, settings)`` with the rate in Hz and its own ``Settings``, a frozen dataclass, or
    by ``cls(rate)`` if it has none. A scenario gives them under ``[detector.options]``.

    Parameters
    ----------
    name : str
        By which a scenario names it.
    level : str
        What the detector's attribute `level` is, for the figure of a launch. If the settings have a number `level`,
        the operating curve is swept along it.
    unit : str
        Of both.

    Raises
    ------
    ValueError
        If the name is taken, or the class is no detector.
    """

    def register(cls: C) -> C:
        KINDS.add(kind_of(cls, name, level=level, unit=unit))
        return cls

    return register


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def kind_of(cls: type, name: str, *, level: str = "", unit: str = "") -> Kind:
    """Return the kind that a class is, without registering it.

    Raises
    ------
    ValueError
        If the class is no detector.
    """
    if not isinstance(cls, type):
        raise NoDetectorError(f"detector {name!r}: give the class, not {cls!r}")
    for method in ("step", "reset"):
        if not callable(getattr(cls, method, None)):
            raise NoDetectorError(f"detector {name!r}: {getattr(cls, '__name__', cls)} has no method {method!r}")
    options = own_settings(cls, f"detector {name!r}")
    swept = options is not None and any(f.name == "level" and _is_number(f.default) for f in fields(options))
    return Kind(
        name=name,
        cls=cls,
        build=lambda settings, rate: cls(rate) if options is None else cls(rate, made(options, settings.options)),
        reads=(OPTIONS,),
        options=options,
        watches=level,
        unit=unit,
        level=Level(f"{OPTIONS}.level", unit) if swept else None,
        panels=(Panel(unit or "level", ((level[:28], "level"),)),) if level else (),
    )
