"""Whether the head's sensors are alive while the aircraft waits on its rail, by their descriptions.

Each is `silent`, `invalid`, out of `range` or `stuck` as `uavsim.onboard.life` has it, and

    offset   in the tare the pair differs by more than `FAR` standard deviations of what the parts allow, and than a
             storm makes where it is open

What a sensor has read itself is never taken for normal. That a port is shut or covered no pressure at rest can tell: a
live one does not move either. That is for the stroke (`stroke`).
"""

from math import hypot, inf, sqrt

from uavsim.onboard.airspeed.difference import ZERO
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.measured import limits
from uavsim.onboard.life import WORDS, SensorLife
from uavsim.onboard.repeats import alike, longest_row, warmth_row
from uavsim.onboard.stamps import JUMP

# s without a reading, after which a sensor is silent. Readings that are lost by chance, up to 7 in 10 at 100 Hz, make
# such a pause once in 10⁸; more is a fault. By hand
SILENT = 0.5
PERIODS = 10.0  # the same of a slow head, periods
SETTLED = 1.0  # s of readings before anything is said. By hand
FAR = 4.0  # standard deviations: one healthy pair in 16 000
STORM = 800.0  # Pa: ½ρw² of 36 m/s, which an open head may see at rest
LEAST_OFFSET = 30.0  # Pa, below which no difference is told: 7 m/s at rest, which the tare takes off. By hand


def rows_allowed(noise: NoiseModel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return, for the total and the static sensor, how long a row of one number may be, and its p (`repeats`)."""
    total = alike(noise.total_sd, noise.total_step, noise.total_lag, noise.head_rate)
    static = alike(noise.static_sd, noise.static_step, noise.static_lag, noise.head_rate)
    return (longest_row(total), total), (longest_row(static), static)


def pause(noise: NoiseModel) -> float:
    """Return how long a sensor of the head may be silent, s."""
    return max(SILENT, PERIODS / noise.head_rate)


class RailCheck:
    """The head's three sensors and the pair's difference.

    Parameters
    ----------
    noise : NoiseModel
        What is believed of them.
    tare_end : float
        Until when the head is under its cover, s; −inf without one.
    """

    __slots__ = ("_count", "_first", "_noise", "_static_end", "_sum", "_tare_end", "_total_end", "sensors")

    def __init__(self, noise: NoiseModel, tare_end: float) -> None:
        self._noise, self._tare_end = noise, tare_end
        total, static, warmth = limits(noise)
        (total_row, _), (static_row, _) = rows_allowed(noise)
        silent = pause(noise)
        self.sensors = {
            "total": SensorLife(total, silent, total_row),
            "static": SensorLife(static, silent, static_row),
            "thermometer": SensorLife(warmth, silent, warmth_row(noise)),
        }
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        for sensor in self.sensors.values():
            sensor.forget()
        self._first = inf
        self._total_end = self._static_end = -inf
        self._sum, self._count = 0.0, 0

    def add(
        self, t: float, p_total: float, p_static: float, temperature: float, t_total: float, t_static: float
    ) -> None:
        """Take a row of the head, its total channel (`difference`) in the place of the total pressure."""
        if self._first == inf:
            self._first = t
        total, static, warmth = self.sensors.values()
        t_total, t_static = min(t_total, t), min(t_static, t)  # no conversion ends later than its reading
        new_total = not self._total_end - JUMP < t_total <= self._total_end
        new_static = not self._static_end - JUMP < t_static <= self._static_end
        total.add(t, p_total, new_total)
        static.add(t, p_static, new_static)
        warmth.add(t, temperature, temperature == temperature or new_static, counts=new_static)
        self._total_end = t_total if new_total else self._total_end
        self._static_end = t_static if new_static else self._static_end
        difference = p_total - (ZERO if self._noise.differential else p_static)
        if t <= self._tare_end and -inf < difference < inf:
            self._sum += difference
            self._count += 1

    def decided(self, t: float) -> bool:
        """Whether enough has been read by `t`, s, and the tare is over."""
        return t > self._tare_end and t - self._first >= SETTLED

    def broken(self, t: float) -> dict[str, str]:
        """Return what is wrong with which sensor at `t`, s."""
        return {name: wrong for name, sensor in self.sensors.items() if (wrong := sensor.wrong(t))}

    def doubts(self, t: float) -> tuple[str, ...]:
        """Return the reasons why the head is not ready at `t`, s; see `Estimator.doubts`."""
        broken = self.broken(t)
        reasons = [f"{_named(name)}: {WORDS[wrong]}" for name, wrong in broken.items()]
        if not broken and (off := self._apart()):
            reasons.append(f"both ports: at rest they differ by {off:.0f} Pa, beyond what the parts allow")
        return tuple(reasons)

    def _apart(self) -> float:
        """By how much the pair differs under the cover, Pa, if its descriptions do not allow that; else 0."""
        noise, n = self._noise, self._count
        if not n or not noise.difference_sd > 0.0:
            return 0.0
        mean = self._sum / n
        sd = hypot(noise.difference_sd, hypot(noise.total_sd, 0.0 if noise.differential else noise.static_sd) / sqrt(n))
        most = max(FAR * sd, LEAST_OFFSET)
        return mean if mean < -most or mean > most + (0.0 if noise.covered else STORM) else 0.0


def _named(channel: str) -> str:
    return channel if channel == "thermometer" else f"{channel} port"
