"""Kinds of airspeed estimator: what each says of itself. A kind is registered where its class stands."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from uavsim.onboard.interface import Estimator, TareWindow
from uavsim.registry import Registry, made, own_settings

if TYPE_CHECKING:
    from uavsim.onboard.airspeed.interface import NoiseModel
    from uavsim.onboard.airspeed.settings import EstimatorSettings

C = TypeVar("C", bound=type)


class NoEstimatorError(ValueError):
    """A class that lacks what an estimator has."""


@dataclass(frozen=True)
class Kind:
    """One kind of airspeed estimator.

    Attributes
    ----------
    name : str
        By which a scenario names it.
    cls : type
        Its class.
    build : callable
        Makes it from the settings, what is believed of the sensors, and the tare's window.
    options : type, optional
        Dataclass of [estimator.options], if it reads those.
    ours : bool
        Whether it reads the keys of [estimator], and answers with whole estimates.
    """

    name: str
    cls: type
    build: "Callable[[EstimatorSettings, NoiseModel, TareWindow | None], Any]"
    options: type | None = None
    ours: bool = False

    @property
    def aided(self) -> bool:
        """Whether it takes readings of specific force."""
        taken = getattr(self.cls, "accelerometer", None)
        return taken is not None and taken is not Estimator.accelerometer


KINDS: Registry[Kind] = Registry("estimator")
"""Every kind that is registered."""


def is_aided(name: str) -> bool:
    """Whether a kind takes readings of specific force; of one that is not registered here nobody knows it."""
    return name in KINDS and KINDS[name].aided


def one_of_ours(name: str) -> Callable[[C], C]:
    """Register a class that is built by ``cls(settings, noise, tare_window)`` with the keys of [estimator]."""

    def register(cls: C) -> C:
        KINDS.add(Kind(name, cls, cls, ours=True))
        return cls

    return register


def estimator(name: str) -> Callable[[C], C]:
    """Register a class as a kind of airspeed estimator.

    The class is built by ``cls(settings, knowledge, tare_window)``: its own ``Settings``, a frozen dataclass, or None
    if it has none; what may be believed of the sensors, a `NoiseModel`; and when the head is covered, s, or None. A
    scenario gives the settings under ``[estimator.options]``.

    Parameters
    ----------
    name : str
        By which a scenario names it.

    Raises
    ------
    ValueError
        If the name is taken, or the class is no estimator.
    """

    def register(cls: C) -> C:
        KINDS.add(kind_of(cls, name))
        return cls

    return register


def kind_of(cls: type, name: str) -> Kind:
    """Return the kind that a class is, without registering it.

    Raises
    ------
    ValueError
        If the class is no estimator.
    """
    if not isinstance(cls, type):
        raise NoEstimatorError(f"estimator {name!r}: give the class, not {cls!r}")
    step = getattr(cls, "step", None)
    if not callable(step) or step is Estimator.step:
        raise NoEstimatorError(f"estimator {name!r}: {getattr(cls, '__name__', cls)} has no method 'step'")
    options = own_settings(cls, f"estimator {name!r}")

    def build(settings: "EstimatorSettings", noise: "NoiseModel", tare_window: TareWindow | None) -> Any:
        return cls(None if options is None else made(options, settings.options), noise, tare_window)

    return Kind(name, cls, build, options)
