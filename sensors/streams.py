"""Independent named random streams, all grown from one seed.

Each source of randomness asks for its own stream by name ("accelerometer.white", "air_data.total.clock", …):

    SeedSequence(seed, spawn_key=(index, crc32(name)))

so that adding a source, or drawing more from one, leaves every other draw as it was. `index` is the number of the
flight in a campaign: the same seed and index give the same flight, in one process or in many.

Source: NumPy reference, "Parallel random number generation" (SeedSequence and its spawn keys).
"""

from zlib import crc32

import numpy as np


class Streams:
    """The random streams of one flight.

    Parameters
    ----------
    seed : int
        Root seed, at least 0.
    index : int
        Number of the flight under this seed, at least 0.

    Examples
    --------
    >>> streams = Streams(7)
    >>> bool(streams("accelerometer.white").normal() == Streams(7)("accelerometer.white").normal())
    True
    """

    __slots__ = ("index", "seed")

    def __init__(self, seed: int, index: int = 0) -> None:
        if seed < 0 or index < 0:
            raise ValueError(f"seed and index must be at least 0, not {seed} and {index}")
        self.seed = seed
        self.index = index

    def __call__(self, name: str) -> np.random.Generator:
        """Return a fresh generator of the stream `name`; asked again, it starts again."""
        return np.random.default_rng(self._sequence(name))

    def integer(self, name: str) -> int:
        """Return a 31-bit integer of the stream `name`, a seed for somebody else's generator."""
        return int(self._sequence(name).generate_state(1, np.uint32)[0]) >> 1

    def _sequence(self, name: str) -> np.random.SeedSequence:
        return np.random.SeedSequence(self.seed, spawn_key=(self.index, crc32(name.encode())))
