"""The air-data head: a total and a static pressure sensor, polled by one bus.

        cover            port               sensor, own clock           bus, every 1/rate
    p_t ──╂── p_t or p_s ───── total  ──── conversion, last finished ──┐
    p_s ─────────────────┬──── static ──── conversion, last finished ──┴── (t, p_total, p_static, T, t_total, t_static)
                         └ thermometer

The sensors run freely, so the two values of a row are of different instants and as old as their clocks make them:
t_total and t_static are the ends of the conversions carried, and a value that is polled again has the same. Under the
cover both ports feel the static pressure, wind or not.
"""

from collections.abc import Callable
from math import inf

from sensors.clock import Clock
from sensors.pressure import PressureSensor
from sensors.settings import AirDataSettings
from sensors.streams import Streams
from sensors.unit import Unit

Air = tuple[float, float, float]  # true total and static pressure, Pa, and temperature, K
Row = tuple[float, float, float, float, float, float]


class AirDataHead:
    """Two drawn units and the bus, stepped with the plant when something is due.

    Parameters
    ----------
    settings : AirDataSettings
    streams : Streams
        Streams "{name}.total. …", "{name}.static. …" and "{name}.poll" are used.
    covered_until : float
        When the cover is taken off, s; -inf if it never was on.
    unit : {"random", "typical", "ideal"}
        Turn-on errors of both sensors, as of `PressureSensor`.
    name : str
        Prefix of its streams, for a second one.

    Attributes
    ----------
    due : float
        Time of the next poll, s.
    total, static : PressureSensor
    covered_until : float
        May be set during a flight.
    """

    __slots__ = ("_air", "_poll", "covered_until", "due", "static", "total")

    _air: Callable[[float], Air]

    def __init__(
        self,
        settings: AirDataSettings,
        streams: Streams,
        *,
        covered_until: float = -inf,
        unit: Unit = "random",
        name: str = "air_data",
    ) -> None:
        self.total = PressureSensor(
            settings.total.description(), streams, name=f"{name}.total", offset_pa=settings.total.offset_pa, unit=unit
        )
        self.static = PressureSensor(
            settings.static.description(),
            streams,
            name=f"{name}.static",
            offset_pa=settings.static.offset_pa,
            unit=unit,
        )
        self.covered_until = covered_until
        self._poll = Clock.drawn(settings.rate, streams(f"{name}.poll"))
        self.due = self._poll.due

    def step(self, until: float, air: Callable[[float], Air]) -> list[Row]:
        """Return the rows polled up to plant time `until`.

        Parameters
        ----------
        until : float
            The present plant time, s.
        air : callable
            Gives the true (total pressure Pa, static pressure Pa, temperature K) at any time since the last poll; asked
            only at the middle of a conversion that is read.

        Returns
        -------
        list of tuple
            (t, p_total, p_static, temperature, t_total, t_static): s, Pa, Pa, K, s, s. NaN before a sensor's first
            finished conversion. The temperature is the static sensor's.
        """
        self._air = air
        rows: list[Row] = []
        while self.due <= until:
            t = self.due
            p_total, _, t_total = self.total.read(t, self._total_port)
            p_static, temperature, t_static = self.static.read(t, self._static_port)
            rows.append((t, p_total, p_static, temperature, t_total, t_static))
            self._poll.tick()
            self.due = self._poll.due
        return rows

    def _total_port(self, t: float) -> tuple[float, float]:
        p_total, p_static, temperature = self._air(t)
        return (p_static if t < self.covered_until else p_total), temperature

    def _static_port(self, t: float) -> tuple[float, float]:
        _, p_static, temperature = self._air(t)
        return p_static, temperature


def head_noise(settings: AirDataSettings) -> tuple[float, float, float]:
    """Return what a filter may know of the head: standard deviations (total Pa, static Pa, temperature K) a reading.

    From the same description that the units are drawn from, `noise_scale` and digital filter included.
    """
    total, static = settings.total.description(), settings.static.description()
    return total.noise_sd, static.noise_sd, static.temperature_noise_sd
