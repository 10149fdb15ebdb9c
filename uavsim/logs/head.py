"""What a log holds of an air-data head, as the rows that onboard code takes.

The total channel is an absolute total pressure, or the difference Δp that a differential sensor has read, and then
p_t = p_s + Δp. Two things are converted where no pressure is there, and it is said:

    M = V_e / (a₀ √(p_s/p₀)),   Δp = p_s ((1 + 0.2 M²)^3.5 − 1)        from an equivalent airspeed V_e
    p_s = p of the standard atmosphere at h                            from a pressure height h

What is made of an airspeed that somebody's estimator has told has that one's zero, its smoothing and its clipping at 0.

A row is of each reading of the total channel. It carries the static pressure that was read last, or within half a
period after it, with the time stamp of that one, as a head that is polled does. While no total pressure comes, there
are rows at the readings of the static one. A reading that a faster table repeats until the next one comes
(sample-and-hold) counts once.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uavsim import airdata
from uavsim.logs.recording import Array, Series

HELD = 2  # readings; where nine runs of equal readings in ten are as long, a faster table repeats them
SILENT = 10.0  # periods of the total channel without a reading, from which on rows come with the static pressures
FEWEST = 20  # readings of a channel; fewer make no airspeed. By hand
LOWEST_HEIGHT, HIGHEST_HEIGHT = -2000.0, 20_000.0  # m, of pressure heights that are converted
FASTEST = 300.0  # m/s, of equivalent airspeeds that are
THINNEST, THICKEST = 5_000.0, 120_000.0  # Pa, of a log's median static pressure: 20 km, and a high below the sea
UNITS = (("hPa", 100.0), ("kPa", 1000.0), ("psi", 6894.757), ("bar", 1e5), ("inHg", 3386.389))
COLD, HOT = airdata.MIN_TEMPERATURE, airdata.MAX_TEMPERATURE  # K


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """Readings of one sensor: times, s, and values, SI; all are numbers."""

    name: str
    t: Array
    values: Array
    source: str

    @property
    def period(self) -> float:
        """Median interval, s."""
        return float(np.median(np.diff(self.t)))

    def at(self, t: Array) -> Array:
        """Return the last reading at each time; NaN before the first."""
        before = np.searchsorted(self.t, t, side="right") - 1
        return np.where(before >= 0, self.values[np.maximum(before, 0)], np.nan)

    def ends(self, t: Array) -> Array:
        """Return the time stamp of the last reading at each time, s; NaN before the first."""
        return Channel(self.name, self.t, self.t, self.source).at(t)

    def later(self, shift: float) -> "Channel":
        """The same with its clock set on by a shift, s."""
        return Channel(self.name, self.t + shift, self.values, self.source)


@dataclass(frozen=True, slots=True, eq=False)
class Head:
    """The head of a log.

    Attributes
    ----------
    total : Channel
        Total pressures, or differences, Pa.
    static : Channel
        Pa.
    temperature : Channel or None
        K; None: the log has none.
    differential : bool
        Whether the total channel is a difference.
    made : tuple of str
        Which of the log's columns were converted.
    remarks : tuple of str
        What was converted or assumed, a sentence each.
    """

    total: Channel
    static: Channel
    temperature: Channel | None
    differential: bool
    made: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def differences(self) -> Array:
        """p_t − p_s at the readings of the total channel, Pa."""
        return self.total.values if self.differential else self.total.values - self.static.at(self.total.t)

    @property
    def assumed_temperature(self) -> float:
        """Of the standard atmosphere at the log's pressure, K."""
        pressure = float(np.median(self.static.values))
        height = airdata.standard_height(min(max(pressure, 6000.0), 115_000.0))
        return float(airdata.standard_temperature(height))

    def rows(self) -> Array:
        """Return what the head says, shape (n, 6): t, p_total, p_static, temperature, t_total, t_static."""
        total, static = self.total, self.static
        t = np.union1d(total.t, static.t[_apart(static.t, total.t) > SILENT * total.period])
        channel, below = total.at(t), static.at(t + 0.5 * total.period)
        t_total, t_static = total.ends(t), static.ends(t + 0.5 * total.period)
        t = np.fmax(t, t_static)
        warm = np.full(t.size, self.assumed_temperature) if self.temperature is None else self.temperature.at(t)
        if self.differential:
            channel = channel + below
        return np.column_stack([t, channel, below, warm, t_total, t_static])


def _apart(t: Array, of: Array) -> Array:
    """How far each time is from the nearest of others, s."""
    right = np.clip(np.searchsorted(of, t), 0, of.size - 1)
    left = np.maximum(right - 1, 0)
    return np.asarray(np.minimum(np.abs(of[right] - t), np.abs(of[left] - t)))


def head_of(series: Mapping[str, Series]) -> Head | None:
    """Find the head in what a log holds; None if it holds no pressures that make an airspeed."""
    found = {name: channel for name, one in series.items() if (channel := _channel(one)) is not None}
    said: list[str] = []
    made: list[str] = []
    static = found.get("p_static")
    if static is None and "baro_height" in found:
        static = _of_height(found["baro_height"])
        made.append("baro_height")
        said.append(
            f"p_static is made of the pressure height {static.source} by the standard atmosphere: its zero counts as "
            "sea level, or map baro_height=…+height of the field"
        )
    if static is None or _wrong_unit(static):
        return None
    total = found.get("p_difference") or found.get("p_total")
    if total is None and "equivalent_airspeed" in found:
        total = _of_equivalent(found["equivalent_airspeed"], static)
        made.append("equivalent_airspeed")
        said.append(
            f"p_difference is made of the equivalent airspeed {total.source}: what follows has that one's zero and its "
            "smoothing, and proves no accuracy"
        )
    if total is None:
        return None
    warm = found.get("temperature")
    head = Head(total, static, _sane(warm), total.name != "p_total", tuple(made), tuple(said))
    if head.temperature is None:
        why = (
            "no temperature"
            if warm is None
            else "the temperature is not one of air in K (°C: map temperature=…+273.15)"
        )
        assumed = f"{why}: that of the standard atmosphere is assumed, {head.assumed_temperature - 273.15:.1f} °C ± 10"
        head = Head(head.total, head.static, None, head.differential, head.made, (*head.remarks, assumed))
    return head


def lacking(series: Mapping[str, Series]) -> str | None:
    """Say what a log with some pressures lacks for an airspeed; None if it has none at all, or enough."""
    total = [name for name in ("p_total", "p_difference", "equivalent_airspeed") if name in series]
    if not total and "p_static" in series:
        return "a static pressure alone makes no airspeed: map p_total=… or p_difference=… if the log has one"
    if not total or head_of(series) is not None:
        return None
    if "p_static" in series and (static := _channel(series["p_static"])) is not None and (wrong := _wrong_unit(static)):
        return f"no airspeed is estimated: {wrong}"
    few = [name for name in (*total, "p_static", "baro_height") if name in series and _channel(series[name]) is None]
    if few:
        return f"no airspeed is estimated: {few[0]} has fewer than {FEWEST} readings"
    return f"no airspeed is estimated: there is {total[0]} and no static pressure; map p_static=… or baro_height=…"


def _wrong_unit(static: Channel) -> str:
    """Say that a static pressure is none of air in Pa; empty if it is one."""
    middle = float(np.median(static.values))
    if THINNEST <= middle <= THICKEST:
        return ""
    unit = next(
        (f"{name}: map p_static=…*{factor:g}" for name, factor in UNITS if THINNEST <= middle * factor <= THICKEST), ""
    )
    looks = f", which looks like {unit}" if unit else ": map p_static=… to the pressure of the air, Pa"
    return f"the median of p_static is {middle:.4g}{looks}"


def _channel(series: Series) -> Channel | None:
    """Readings that are numbers, each once."""
    good = np.isfinite(series.values) & np.isfinite(series.t)
    t, values = series.t[good], series.values[good]
    rising = np.concatenate(([True], np.diff(t) > 0.0)) if t.size else np.zeros(0, bool)
    t, values = t[rising], values[rising]
    if t.size < FEWEST:
        return None
    new = np.concatenate(([True], np.diff(values) != 0.0))
    runs = np.diff(np.flatnonzero(new))
    if runs.size >= FEWEST and np.percentile(runs, 10.0) >= HELD:
        t, values = t[new], values[new]
    return Channel(series.name, t, values, series.source)


def _sane(temperature: Channel | None) -> Channel | None:
    """A temperature, if it is one of air in K."""
    if temperature is None or not COLD <= float(np.median(temperature.values)) <= HOT:
        return None
    return temperature


def _of_height(height: Channel) -> Channel:
    h = np.clip(height.values, LOWEST_HEIGHT, HIGHEST_HEIGHT)
    return Channel("p_static", height.t, np.asarray(airdata.standard_pressure(h)), height.source)


def _of_equivalent(speed: Channel, static: Channel) -> Channel:
    p = static.at(speed.t)
    p = np.clip(np.where(np.isfinite(p), p, static.values[0]), THINNEST, THICKEST)
    mach = np.clip(speed.values, 0.0, FASTEST) / (
        airdata.STANDARD_SPEED_OF_SOUND * np.sqrt(p / airdata.STANDARD_PRESSURE)
    )
    return Channel("p_difference", speed.t, p * np.expm1(3.5 * np.log1p(0.2 * mach**2)), speed.source)
