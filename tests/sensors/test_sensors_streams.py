"""Named random streams: the same seed gives the same bits, and no stream knows of another."""

from zlib import crc32

import numpy as np
import pytest

from sensors import Accelerometer, AirDataHead, AirDataSettings, Streams, preset


def test_stream_is_the_documented_seed_sequence():
    """Authority: NumPy's SeedSequence, spawn key (index, crc32 of the name)."""
    expected = np.random.default_rng(np.random.SeedSequence(5, spawn_key=(3, crc32(b"a.b"))))
    assert np.array_equal(Streams(5, 3)("a.b").normal(size=9), expected.normal(size=9))


def test_streams_differ_by_name_index_and_seed():
    first = [Streams(1, 0)("a"), Streams(1, 0)("b"), Streams(1, 1)("a"), Streams(2, 0)("a")]
    assert len({generator.random() for generator in first}) == 4


def test_drawing_from_one_stream_leaves_another():
    streams = Streams(9)
    untouched = streams("b").normal(size=5)
    streams("a").normal(size=1000)
    assert np.array_equal(streams("b").normal(size=5), untouched)


def test_streams_are_uncorrelated():
    """n = 100 000 pairs: |r| < 4/√n by chance but for 6 in 100 000."""
    n = 100_000
    a, b = Streams(3)("accelerometer.white").normal(size=n), Streams(3)("accelerometer.walk").normal(size=n)
    assert abs(np.corrcoef(a, b)[0, 1]) < 4 / np.sqrt(n)


def test_integers_are_31_bit_and_spread():
    values = [Streams(seed).integer("jsbsim") for seed in range(2000)]
    assert all(0 <= value < 2**31 for value in values)
    assert len(set(values)) == 2000
    assert max(values) > 0.99 * 2**31  # fails by chance with 2000 draws: 0.99^2000 = 2e-9
    assert values[4] == Streams(4).integer("jsbsim")


@pytest.mark.parametrize(("seed", "index"), [(-1, 0), (0, -1)])
def test_negative_seed_or_index_is_an_error(seed, index):
    with pytest.raises(ValueError, match="at least 0"):
        Streams(seed, index)


class Calm:
    """Surroundings that stay as they are."""

    def flow(self):
        return (*self.air(0.0), 0.0, 0.0, 0.0, 0.0)

    def air(self, _time):
        return 101500.0, 101325.0, 288.15


def _readings(streams: Streams, with_others: bool):
    """A few readings of an accelerometer and a head, with or without more devices drawn from the same tree."""
    names = ["accelerometer", "second", "third"] if with_others else ["accelerometer"]
    devices = [Accelerometer(preset("lsm6dso32"), streams, name=name) for name in names]
    count = 2 if with_others else 1
    heads = [AirDataHead(AirDataSettings(), streams, Calm(), name=f"air_data{n}") for n in range(count)]
    rows = []
    for k in range(1, 300):
        t = k * 1e-3
        for device in devices:
            readings = device.step((t, (1.0, 2.0, 3.0)))
            if device is devices[0]:
                rows += readings
        for head in heads:
            polled = head.step(t) if head.due <= t else []
            if head is heads[0]:
                rows += polled
    return np.array([row[:4] for row in rows])


def test_same_seed_same_bits_and_more_devices_change_nothing():
    alone = _readings(Streams(11), with_others=False)
    assert alone.tobytes() == _readings(Streams(11), with_others=False).tobytes()
    assert alone.tobytes() == _readings(Streams(11), with_others=True).tobytes()
    assert alone.tobytes() != _readings(Streams(12), with_others=False).tobytes()
