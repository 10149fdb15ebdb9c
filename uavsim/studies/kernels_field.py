"""The autopilots' rules as loops over arrays, compiled; how kernels are called is in `uavsim.studies.kernels`.

The mean on the rail is four numbers of the state x: the block before the last full one, the last full one, and sum and
time of the running one.
"""

from math import sqrt

import numpy as np

from uavsim.onboard.plausible import MOST_FORCE
from uavsim.studies.compiled import compiled, wide
from uavsim.studies.kernels import Counts, Forces, Numbers, Reals, Wholes


@compiled
def on_rail(
    v: float, dt: float, before: float, last: float, summed: float, time: float, block: float, rounding: float
) -> tuple[float, float, float, float]:
    """Mean on the rail after one more force, as `RailMean.add`."""
    if -MOST_FORCE < v < MOST_FORCE:
        summed += v * dt
        time += dt
        if time * rounding >= block:
            return last, summed / time, 0.0, 0.0
    return before, last, summed, time


@compiled
def px4(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Px4`: p threshold, hold, interval, period, block, rounding; x mean on the rail, elapsed, held."""
    threshold, hold, interval, period, block, rounding = p
    before, last, summed, time, elapsed, held = x[0], x[1], x[2], x[3], x[4], x[5]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        before, last, summed, time = on_rail(v, dt, before, last, summed, time, block, rounding)
        elapsed += dt
        if elapsed < interval:
            continue
        worth, elapsed = min(max(elapsed, 0.010), 0.050), 0.0
        held = held + worth if v - before > threshold and v < MOST_FORCE else 0.0
        if held > hold:
            before = last = np.nan
            summed = time = elapsed = held = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5], y[0] = before, last, summed, time, elapsed, held, first
    return alarms


@compiled
def px4_norm(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Px4Norm`, f (3, n): as `px4`; x means before, last means, sums, time, elapsed, held."""
    threshold, hold, interval, period, block, rounding = p
    bx, by, bz, lx, ly, lz = x[0], x[1], x[2], x[3], x[4], x[5]
    sx, sy, sz, time, elapsed, held = x[6], x[7], x[8], x[9], x[10], x[11]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.shape[1]):
        t = (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        fx, fy, fz = wide(f[0, i]), wide(f[1, i]), wide(f[2, i])
        sound = abs(fx) < MOST_FORCE and abs(fy) < MOST_FORCE and abs(fz) < MOST_FORCE
        if sound:
            time += dt
            sx, sy, sz = sx + fx * dt, sy + fy * dt, sz + fz * dt
            if time * rounding >= block:
                bx, by, bz, lx, ly, lz = lx, ly, lz, sx / time, sy / time, sz / time
                sx = sy = sz = time = 0.0
        elapsed += dt
        if elapsed < interval:
            continue
        worth, elapsed = min(max(elapsed, 0.010), 0.050), 0.0
        a, b, c = fx - bx, fy - by, fz - bz
        held = held + worth if sound and sqrt(a * a + b * b + c * c) > threshold else 0.0
        if held > hold:
            bx = by = bz = lx = ly = lz = np.nan
            sx = sy = sz = time = elapsed = held = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5] = bx, by, bz, lx, ly, lz
    x[6], x[7], x[8], x[9], x[10], x[11] = sx, sy, sz, time, elapsed, held
    y[0] = first
    return alarms


@compiled
def ardupilot(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`ArduPilot`: p threshold, delay, interval, period, block, rounding; x mean, elapsed, waited, five values.

    y[1] tells whether the delay runs.
    """
    threshold, delay, interval, period, block, rounding = p
    before, last, summed, time, elapsed, waited = x[0], x[1], x[2], x[3], x[4], x[5]
    v0, v1, v2, v3, v4 = x[6], x[7], x[8], x[9], x[10]
    first, waiting, alarms, then = y[0], y[1] != 0, 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        before, last, summed, time = on_rail(v, dt, before, last, summed, time, block, rounding)
        if waiting:
            waited += dt
            launched = waited >= delay
        else:
            elapsed += dt
            if elapsed < interval:
                continue
            elapsed, a = 0.0, v - before
            v0, v1, v2, v3, v4 = v1, v2, v3, v4, a if a == a and abs(v) < MOST_FORCE else 0.0
            waiting = v0 + v1 + v2 + v3 + v4 >= 5.0 * threshold
            launched = waiting and delay <= 0.0
        if launched:
            before = last = np.nan
            summed = time = elapsed = waited = v0 = v1 = v2 = v3 = v4 = 0.0
            waiting, first = False, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4], x[5] = before, last, summed, time, elapsed, waited
    x[6], x[7], x[8], x[9], x[10] = v0, v1, v2, v3, v4
    y[0], y[1] = first, waiting
    return alarms


@compiled
def inav(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Inav`: p threshold, hold, period, b0, a1, a2; q whether there is a low-pass; x held, z1, z2; y[1] started."""
    threshold, hold, period, b0, a1, a2 = p
    held, z1, z2 = x[0], x[1], x[2]
    first, started, alarms = y[0], y[1] != 0, 0
    for i in range(f.size):
        v = wide(f[i])
        level = v
        if not abs(v) < MOST_FORCE:
            held = 0.0
            continue
        if q[0]:
            if not started:
                started, z1, z2 = True, v * (1.0 - b0), v * (b0 - a2)
            level = b0 * v + z1
            z1 = 2.0 * b0 * v - a1 * level + z2
            z2 = b0 * v - a2 * level
        if not level > threshold:
            held = 0.0
            continue
        k = k0 + i
        held += k / rate - (k - 1) / rate if k != first else period
        if held >= hold:
            held, started, first = 0.0, False, k + 1
            out[alarms] = k
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2] = held, z1, z2
    y[0], y[1] = first, started
    return alarms


@compiled
def paparazzi(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`Paparazzi`: p threshold, interval, period; q calls; x elapsed; y[1] calls in a row."""
    threshold, interval, period = p
    calls, elapsed, row = q[0], x[0], y[1]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        t = (k0 + i) / rate
        elapsed += t - then if k0 + i != first else period
        then = t
        if elapsed < interval:
            continue
        elapsed = 0.0
        row = row + 1 if threshold <= wide(f[i]) < MOST_FORCE else 0
        if row >= calls:
            row, first = 0, k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], y[0], y[1] = elapsed, first, row
    return alarms


@compiled
def altos(f: Forces, k0: int, rate: float, p: Numbers, q: Counts, x: Reals, y: Wholes, out: Wholes) -> int:
    """`AltOs`: p threshold, speed, period, block, rounding; x mean on the rail, gained."""
    threshold, speed, period, block, rounding = p
    before, last, summed, time, gained = x[0], x[1], x[2], x[3], x[4]
    first, alarms, then = y[0], 0, (k0 - 1) / rate
    for i in range(f.size):
        v, t = wide(f[i]), (k0 + i) / rate
        dt = t - then if k0 + i != first else period
        then = t
        before, last, summed, time = on_rail(v, dt, before, last, summed, time, block, rounding)
        a = v - before
        if not (a == a and abs(v) < MOST_FORCE):
            continue
        gained += a * dt
        if not gained > 0.0:
            gained = 0.0
        if a > threshold and gained > speed:
            before = last = np.nan
            summed = time = gained = 0.0
            first = k0 + i + 1
            out[alarms] = k0 + i
            alarms += 1
            if alarms == out.size:
                break
    x[0], x[1], x[2], x[3], x[4] = before, last, summed, time, gained
    y[0] = first
    return alarms
