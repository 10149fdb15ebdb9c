"""Disturbances without end: shocks at random times on a rail that is transported, hour after hour."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import ceil, cos, pi, radians, sin
from typing import Annotated
from zlib import crc32

import numpy as np
from annotated_types import Gt, Interval

from uavsim.studies.signals.noise import band_noise
from uavsim.studies.signals.ranges import NonNegative, Range, Single, check
from uavsim.studies.signals.shock import SOFT_DROP, Shock, ShockSettings, draw_shock
from uavsim.truth import STANDARD_GRAVITY as G0

SPELL = 30.0  # s, of one level of vibration and one rail in the mix; also what is generated at once
FADE = 0.05  # s, over which a spell's vibration grows and dies away, so that there is no step between spells


@dataclass(frozen=True, slots=True)
class MixSettings:
    """A stream of disturbances without end; the defaults are "the mix".

    Attributes
    ----------
    shock
        Distribution of the shocks.
    shock_rate
        Of their Poisson process, 1/s.
    vibration_g
        Levels of the vibration, g rms on each axis; each spell of 30 s has one of them, equally probable.
    band_hz
        Its band, Hz; below half the rate.
    elevation_deg
        Of the rail in each spell, degrees, uniform.
    sigma_g, clip_g
        White noise and range, standard g.
    """

    shock: ShockSettings = field(default_factory=ShockSettings)
    shock_rate: Annotated[float, Interval(ge=0, le=100)] = 0.5
    vibration_g: tuple[NonNegative, ...] = (0.0, 1.0, 2.0, 3.0)
    band_hz: Range = (5.0, 200.0)
    elevation_deg: Range = (5.0, 35.0)
    sigma_g: NonNegative = 0.3
    clip_g: Annotated[float, Gt(0)] = 16.0

    def __post_init__(self) -> None:
        check("elevation_deg", self.elevation_deg)
        if not self.vibration_g or min(self.vibration_g) < 0.0 or self.shock_rate < 0.0:
            raise ValueError("vibration_g must hold at least one level, and no level or rate may be negative")


SOFT_DROPS = MixSettings(shock=SOFT_DROP, vibration_g=(0.0,))


class Mix:
    """The disturbances of `MixSettings`, as many hours as are read, in constant memory.

    Spell k is drawn from streams of (seed, index, name, k) alone, so any part can be had without what is before it.

    Parameters
    ----------
    settings
    seed, index
        Each pair is a stream of its own.
    rate
        Hz; sample k is at k / rate.
    axes
        Which columns, of 0, 1, 2 = x, y, z; a column is the same alone as beside others.

    Raises
    ------
    ValueError
        If there are no axes, or the band of the vibration reaches half the rate.
    """

    __slots__ = ("axes", "index", "rate", "seed", "settings", "spell")

    def __init__(
        self, settings: MixSettings, seed: int, index: int = 0, rate: float = 1000.0, axes: tuple[int, ...] = (0, 1, 2)
    ) -> None:
        if not axes or not set(axes) <= {0, 1, 2}:
            raise ValueError(f"axes must be some of 0, 1, 2, not {axes}")
        if any(settings.vibration_g) and not 0.0 < settings.band_hz[0] < settings.band_hz[1] < rate / 2:
            raise ValueError(f"a rate of {rate:g} Hz cannot hold vibration of {settings.band_hz} Hz")
        if seed < 0 or index < 0:
            raise ValueError(f"seed and index must be at least 0, not {seed} and {index}")
        self.settings, self.rate, self.axes = settings, rate, axes
        self.seed = seed
        self.spell = round(SPELL * rate)  # samples
        self.index = index

    def _generator(self, name: str, k: int) -> np.random.Generator:
        # As in sensors.streams, with the number of the spell behind the name: CRCs of so many names would meet.
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(self.index, crc32(name.encode()), k)))

    def shocks(self, k: int) -> tuple[Shock, ...]:
        """Return the shocks that begin in spell `k`, in time order, in seconds of the stream."""
        length = self.spell / self.rate
        generator = self._generator("mix.shock", k)
        starts = np.sort(generator.random(generator.poisson(self.settings.shock_rate * length)))
        return tuple(draw_shock(self.settings.shock, (k + u) * length, generator) for u in starts.tolist())

    def level(self, k: int) -> float:
        """Return the vibration of spell `k`, g rms."""
        levels = self.settings.vibration_g
        return levels[int(self._generator("mix.level", k).integers(len(levels)))]

    def read_spell(self, k: int) -> Single:
        """Return spell `k`, shape (spell, axes), m/s²; columns are contiguous."""
        n, settings = self.spell, self.settings
        elevation = radians(self._generator("mix.elevation", k).uniform(*settings.elevation_deg))
        rest = (G0 * sin(elevation), 0.0, -G0 * cos(elevation))
        level = self.level(k)
        columns = np.empty((len(self.axes), n), np.float32)
        for column, axis in zip(columns, self.axes, strict=True):
            self._generator(f"mix.noise.{axis}", k).standard_normal(dtype=np.float32, out=column)
            np.multiply(column, np.float32(settings.sigma_g * G0), out=column)
            np.add(column, np.float32(rest[axis]), out=column)
            if level > 0.0:
                np.add(column, self._vibration(level, axis, k), out=column)
        self._strike(columns, k)
        limit = np.float32(settings.clip_g * G0)
        np.clip(columns, -limit, limit, out=columns)
        return columns.T

    def _vibration(self, level: float, axis: int, k: int) -> Single:
        noise = band_noise(self.spell, self.rate, self.settings.band_hz, self._generator(f"mix.vibration.{axis}", k))
        noise *= np.float32(level * G0)
        m = max(1, round(FADE * self.rate))
        fade = (np.sin(pi / 2 * np.arange(m) / m) ** 2).astype(np.float32)
        noise[:m] *= fade
        noise[-m:] *= fade[::-1]
        return noise

    def _strike(self, columns: Single, k: int) -> None:
        """Add the shocks where they fall, also those that began in the spell before and ring on."""
        begin, end = k * self.spell, (k + 1) * self.spell
        for shock in (self.shocks(k - 1) if k > 0 else ()) + self.shocks(k):
            first, last = max(begin, ceil(shock.start * self.rate)), min(end, ceil(shock.end * self.rate))
            if shock.axis in self.axes and first < last:
                force = shock.force(np.arange(first, last) / self.rate)
                columns[self.axes.index(shock.axis), first - begin : last - begin] += force.astype(np.float32)

    def blocks(self, size: int, samples: int, start: int = 0) -> Iterator[Single]:
        """Read `samples` samples from sample `start` on, in blocks of `size`; the last may be shorter.

        Yields
        ------
        ndarray
            Shape (size, axes), m/s², float32, columns contiguous; the numbers do not depend on `size` and `start`.
            A block is the reader's own.
        """
        if size < 1 or samples < 0 or start < 0:
            raise ValueError("size must be at least 1, samples and start at least 0")
        held, spell = -1, np.empty((0, len(self.axes)), np.float32)
        for begin in range(start, start + samples, size):
            block = np.empty((len(self.axes), min(size, start + samples - begin)), np.float32).T
            done = 0
            while done < len(block):
                k, offset = divmod(begin + done, self.spell)
                if k != held:
                    held, spell = k, self.read_spell(k)
                part = spell[offset : offset + len(block) - done]
                block[done : done + len(part)] = part
                done += len(part)
            yield block
