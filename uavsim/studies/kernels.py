"""The launch detectors' arithmetic as loops over arrays, compiled: what `step` decides at the times k / rate.

A kernel reads forces along the launch axis, m/s², at t_k = k / rate, k₀ ≤ k < k₀ + n, and takes for every sample

    dt_k = t_k - t_{k-1},   a detector's first sample: 1 / rate

in the order in which `uavsim.onboard.launch` adds and multiplies, so sums agree to the last bit: no fused or reordered
arithmetic. Regular sampling has no gaps; forces that are NaN or
implausible have the effect that `step` gives them. At an alarm the detector
begins anew with the next sample. Most samples of most signals say nothing while nothing is begun; that way is short.

All kernels are called alike: (f, k₀, rate, p, q, x, y, out) → number of alarms.

    f      forces, (n,), or (axes, n) where a rule needs several, float32 or float64, contiguous
    p, q   the detector's numbers, real and whole
    x, y   its state, real and whole, kept from block to block
    out    the k of the alarms; the kernel ends when it is full

y[0] is the k of the first sample since the detector began. To add a detector: a kernel here, its numbers in
`uavsim.studies.detections`.
"""

import numpy as np
from numpy.typing import NDArray

from uavsim.onboard.plausible import MOST_FORCE
from uavsim.studies.compiled import compiled, wide

Forces = NDArray[np.float64] | NDArray[np.float32]
Numbers = tuple[float, ...]
Counts = tuple[int, ...]
Reals = NDArray[np.float64]
Wholes = NDArray[np.int64]


@compiled
def hold(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SingleThreshold`, `DoubleThreshold`: p trigger, threshold, window, period; x held; y[1] whether held."""
    trigger, threshold, window, period = p
    held, holding, alarms = x[0], y[1] != 0, 0
    for i in range(f.size):
        v = wide(f[i])
        if not holding:
            if not trigger < v < MOST_FORCE:
                continue
            holding, held = True, period
        elif threshold < v < MOST_FORCE:
            held += (k0 + i) / rate - (k0 + i - 1) / rate
        else:
            holding, held = False, 0.0
            continue
        if held >= window:
            holding, held = False, 0.0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[1] = held, holding
    return alarms


@compiled
def nested(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`MultiLevelWindow` on one axis: p trigger, threshold; q n, i, k₁ as a fraction, rearm; y open, level, N, total.

    Counts samples and knows no time. y[1] is 2 where the axis is dead.
    """
    trigger, threshold = p
    samples, levels, needed, of, rearm = q
    opened, level, count, total, alarms = y[1], y[2], y[3], y[4], 0
    for i in range(f.size):
        v = wide(f[i])
        if opened != 1:
            if opened == 2 or not trigger < v < MOST_FORCE:
                continue
            opened, level, count, total = 1, 1, 1, 1
        else:
            if total == level * samples:
                level += 1
            total += 1
            count += threshold < v < MOST_FORCE
        if total < level * samples:
            continue
        if count * of >= needed * total:
            opened = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
        elif level == levels:
            opened = 0 if rearm else 2
    y[1], y[2], y[3], y[4] = opened, level, count, total
    return alarms


@compiled
def nested_axes(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`MultiLevelWindow` on several axes, f (axes, n): as `nested`, with four numbers of state an axis."""
    trigger, threshold = p
    samples, levels, needed, of, rearm = q
    axes, alarms = f.shape[0], 0
    for i in range(f.shape[1]):
        recognised = False
        for axis in range(axes):
            v = wide(f[axis, i])
            at = 1 + 4 * axis
            if y[at] != 1:
                if y[at] == 2 or not trigger < v < MOST_FORCE:
                    continue
                y[at : at + 4] = 1
            else:
                if y[at + 3] == y[at + 1] * samples:
                    y[at + 1] += 1
                y[at + 3] += 1
                y[at + 2] += threshold < v < MOST_FORCE
            if y[at + 3] < y[at + 1] * samples:
                continue
            if y[at + 2] * of >= needed * y[at + 3]:
                recognised = True
            elif y[at + 1] == levels:
                y[at] = 0 if rearm else 2
        if recognised:
            y[1:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    return alarms


@compiled
def sliding(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SlidingWindow`: p threshold; q samples, needed; y[1] count, y[2] place in the ring, y[3:] the ring."""
    threshold = p[0]
    samples, needed = q
    count, place, alarms = y[1], y[2], 0
    ring = y[3:]
    for i in range(f.size):
        above = 1 if threshold < wide(f[i]) < MOST_FORCE else 0
        if count + above == 0:
            continue
        count += above - ring[place]
        ring[place] = above
        place += 1
        if place == samples:
            place = 0
        if count >= needed:
            count = place = 0
            ring[:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2] = count, place
    return alarms


@compiled
def sequence(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`SequenceWindow`: p trigger, threshold; q samples, sequence, needed; y row, count, total (0: none is open)."""
    trigger, threshold = p
    samples, least, needed = q
    row, count, total, alarms = y[1], y[2], y[3], 0
    for i in range(f.size):
        v = wide(f[i])
        if total == 0:
            if not trigger < v < MOST_FORCE:
                row = 0
                continue
            row += 1
            if row < least:
                continue
            count = total = row
        else:
            total += 1
            count += threshold < v < MOST_FORCE
        if total < samples:
            continue
        recognised = count >= needed
        row = count = total = 0
        if recognised:
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2], y[3] = row, count, total
    return alarms


@compiled
def cusum(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Cusum`: p reference, rise, -fall, limit, period; x the sum, never below 0."""
    reference, rise, fall, limit, period = p
    total, first, alarms = x[0], y[0], 0
    for i in range(f.size):
        v = wide(f[i])
        excess: float = v - reference
        if total == 0.0 and not excess > 0.0:
            continue
        if excess > rise:
            excess = rise if v < MOST_FORCE else fall
        elif not excess > fall:  # NaN too
            excess = fall
        k = k0 + i
        total += excess * (k / rate - (k - 1) / rate if k != first else period)
        if not total > 0.0:
            total = 0.0
        elif total > limit:
            total, first = 0.0, k + 1
            out[alarms] = k
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[0] = total, first
    return alarms


@compiled
def adaptive_cusum(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`AdaptiveCusum`: p as it is built, and the period; x sum, roughness, mean."""
    reference, rise, fall, least, highest, gain, most, follow, forget, period = p
    total, rough, mean = x[0], x[1], x[2]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        away, weight, size = v - mean, dt * follow, most
        if abs(away) <= most:
            mean += away * weight if weight < 1.0 else away
            size = abs(away)  # without a branch that noise would make unpredictable
        elif -MOST_FORCE < v < MOST_FORCE:
            mean += (most if away > 0.0 else -most) * min(1.0, weight)
        rough += (size - rough) * (dt * forget)
        excess: float = v - reference
        if total == 0.0 and not excess > 0.0:
            continue
        if excess > rise:
            excess = rise if v < MOST_FORCE else fall
        elif not excess > fall:  # NaN too
            excess = fall
        total += excess * dt
        if not total > 0.0:
            total = 0.0
        elif total > least and total > min(max(gain * rough, least), highest):
            total, rough, mean, first = 0.0, 0.5 * most, 0.0, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], y[0] = total, rough, mean, first
    return alarms


@compiled
def glr(f: Forces, k0: int, rate: float, p: Numbers, q: Wholes, x: Reals, y: Wholes, out: Wholes) -> int:
    """`GlrBank`: p reference, fall, rise + fall, steps in 1 m/s²; q the number, lengths and limits of the windows.

    y[1] place in the ring, y[2] samples since the last that spoke, then the windows' sums, then the ring.
    """
    reference, fall, span, scale = p
    windows = q[0]
    lengths, limits = q[1 : 1 + windows], q[1 + windows :]
    longest = lengths[windows - 1]
    place, quiet, alarms = y[1], y[2], 0
    sums, ring = y[3 : 3 + windows], y[3 + windows :]
    for i in range(f.size):
        v = wide(f[i])
        above = v - reference + fall
        added = 0
        if not (above > 0.0 and v < MOST_FORCE):  # NaN too
            if quiet >= longest:
                continue
            quiet += 1
        else:
            added = int(scale * (above if above < span else span))
            quiet = 0
        reached = False
        for j in range(windows):
            old = place - lengths[j]
            sums[j] += added - ring[old if old >= 0 else old + longest]
            reached |= sums[j] > limits[j]
        ring[place] = added
        place += 1
        if place == longest:
            place = 0
        if reached:
            place, quiet = 0, longest
            y[3:] = 0
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    y[1], y[2] = place, quiet
    return alarms
