"""Which dispersion drives an output: Morris screening, and Sobol indices where there are flights enough.

The d dispersions of a scenario are d numbers of the unit cube, u_1 … u_d, each the probability that its distribution
gives to smaller values. One more factor, `rest`, stands for all else that a seed draws: noise, sensor units, clocks,
the wait on the rail. Its number chooses the index under which a flight draws all that, so that two flights with the
same `rest` share every draw but the dispersions. It is a factor like any other: its share of the variance says what no
tighter tolerance of a dispersion can take away. Correlated dispersions are varied by their independent normal values,
before they are mixed: what a factor means then depends on their order in the file.

With Y the output and V its variance, all factors independent and uniform:

    first order   S_i = V[E(Y | u_i)] / V          what V falls by, on average, if u_i becomes known
    total         T_i = E[V(Y | u_1 … u_d without u_i)] / V     what is left of V if all but u_i become known
    Σ S_i ≤ 1, and 1 - Σ S_i is the share of interactions; S_i ≤ T_i

Sobol: N(d + 3) flights, d + 1 factors with `rest`; Saltelli's design over a scrambled Sobol sequence, estimators of
Saltelli et al. (Computer Physics Communications 181, 2010, 259-270), all by SALib. Intervals are the quantiles of
SALib's bootstrap over the N base points.

Morris: r(d + 2) flights in r trajectories, each of which moves one factor after the other by half of its range
(Technometrics 33, 1991, 161-174; SALib's sampler). An elementary effect is the change of Y over that of u. `mu_star` is
the mean of its size (Campolongo et al., Environmental Modelling & Software 22, 2007, 1509-1518), `sigma` its standard
deviation: great beside `mu_star` where a factor interacts or bends. Intervals are quantiles of a bootstrap over
trajectories. The four levels stand in the middle of equal parts of the range, 1/8 … 7/8: at 0 and 1 a normal
distribution has no value. Each trajectory has indices of its own for `rest`, and a step of it is the difference of two
independent draws: with a standard deviation s of theirs `mu_star` is 2 · 1.13 s where they are normal, while a straight
line with the same variance has √12 s = 3.5 s. So beside lines `rest` is shown at two thirds of its size. Sobol indices
have no such flaw.

Both: `swing`, how much Y changes when a factor goes from its 10 % to its 90 % point, by least squares over the pairs of
flights that differ in that factor alone. It has a sign, and the output's unit. `rest` has none.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Method = Literal["sobol", "morris"]

REST = "rest"
AS_EXPECTED = "outcome"
OUTPUTS = ("launch.latency", "airspeed.rmse", "flight.rail_exit_speed", AS_EXPECTED)
LEVELS = 4  # of Morris
LEAST_BASES = 64  # of Sobol: below it intervals of indices are as wide as the indices
LEAST_TRAJECTORIES = 4
RESAMPLES = 1000
INDICES = 2**31  # that `rest` chooses from
LEFT_OUT = 0.05  # share of base points or trajectories with a missing output up to which the others are used
SWING = 0.8  # of a factor's range, from its 10 % to its 90 % point


class TooFewError(ValueError):
    """Fewer flights than the least method needs."""


@dataclass(frozen=True)
class Design:
    """Which flights are flown.

    Attributes
    ----------
    method
        "sobol" or "morris".
    names
        Keys of the dispersions, and `rest` at the end; d + 1 of them.
    unit
        Each flight's factors, 0 … 1, shape (n, d + 1).
    indices
        What each flight draws the rest from, shape (n,).
    bases
        N base points, or r trajectories: blocks of rows one after another.
    asked
        Flights that were asked for; `unit` has as many or a few less.
    """

    method: Method
    names: tuple[str, ...]
    unit: Array
    indices: NDArray[np.int64]
    bases: int
    asked: int

    @property
    def points(self) -> Array:
        """What the dispersions are drawn at, shape (n, d)."""
        return self.unit[:, :-1]

    @property
    def block(self) -> int:
        """Flights in a block."""
        return len(self.unit) // self.bases


def flights_for(dispersions: int, method: Method, bases: int | None = None) -> int:
    """Flights that a method needs for a number of dispersions; the least without `bases`."""
    if method == "sobol":
        return (bases or LEAST_BASES) * (dispersions + 3)
    return (bases or LEAST_TRAJECTORIES) * (dispersions + 2)


def design(names: Sequence[str], runs: int, seed: int, method: Method | None = None) -> Design:
    """Choose the flights.

    Parameters
    ----------
    names
        Keys of the dispersions.
    runs
        Flights in all.
    seed
        Of the design.
    method
        None: Sobol indices if `runs` suffices for 64 base points, else Morris screening.

    Raises
    ------
    TooFewError
        If they do not suffice for the method, with what it needs.
    ValueError
        Without dispersions.
    """
    if not names:
        raise ValueError("there is no dispersion, so that nothing but the seed differs between flights")
    chosen: Method = method or ("sobol" if runs >= flights_for(len(names), "sobol") else "morris")
    least = flights_for(len(names), chosen)
    if runs < least:
        what = "Morris screening" if chosen == "morris" else "Sobol indices"
        raise TooFewError(f"{what} of {len(names)} dispersions and the rest need {least} flights or more, not {runs}")
    factors = (*names, REST)
    make = _saltelli if chosen == "sobol" else _trajectories
    unit, indices, bases = make(factors, runs, seed)
    return Design(chosen, factors, unit, indices, bases, runs)


def _problem(names: Sequence[str]) -> dict[str, Any]:
    return {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}


def _saltelli(names: tuple[str, ...], runs: int, seed: int) -> tuple[Array, NDArray[np.int64], int]:
    from warnings import catch_warnings, simplefilter

    from SALib.sample import sobol

    bases = runs // (len(names) + 2)
    with catch_warnings():
        simplefilter("ignore", UserWarning)  # N need be no power of 2: it costs balance, not more than what is left out
        unit = sobol.sample(_problem(names), bases, calc_second_order=False, seed=_generator(seed))
    unit = np.clip(unit, 2.0**-32, 1.0 - 2.0**-32)  # the sequence may hold 0
    return unit, np.floor(unit[:, -1] * INDICES).astype(np.int64), bases


def _trajectories(names: tuple[str, ...], runs: int, seed: int) -> tuple[Array, NDArray[np.int64], int]:
    from SALib.sample import morris

    bases = runs // (len(names) + 1)
    unit = morris.sample(_problem(names), bases, num_levels=LEVELS, seed=_generator(seed))
    level = np.rint(unit[:, -1] * (LEVELS - 1)).astype(np.int64)
    block = np.repeat(np.arange(bases), len(names) + 1)
    return (unit * (LEVELS - 1) + 0.5) / LEVELS, block * LEVELS + level, bases


def _generator(seed: int, stream: int = 0) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(stream,)))


# -- outputs ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Effects:
    """What the factors do to one output.

    Attributes
    ----------
    output
        Key of the score, or `outcome`: 1 where it is as expected.
    rows
        A row a factor: `factor`; of Sobol `first`, `total`, of Morris `mu_star`, `mu`, `sigma`; `swing`; each with
        `_low` and `_high`, NaN where there is none.
    mean, sd
        Of the output over all flights that have it, each base point or trajectory counting alike.
    missing
        Flights without the output.
    left_out
        Base points or trajectories that are left out for it.
    why
        Why there is no number; empty if there is.
    """

    output: str
    rows: "pd.DataFrame"
    mean: float
    sd: float
    missing: int
    left_out: int
    why: str = ""


def output_of(runs: "pd.DataFrame", name: str) -> Array:
    """Return an output of each flight; of the outcome 1 where it is as expected, NaN for what does not exist."""
    if name == AS_EXPECTED:
        return (runs["outcome"] == runs["expected"]).to_numpy().astype(np.float64)
    return runs[name].to_numpy(np.float64)


def effects_of(runs: "pd.DataFrame", flown: Design, outputs: Sequence[str], seed: int) -> tuple[Effects, ...]:
    """Estimate what each factor does to each of several outputs.

    Parameters
    ----------
    runs
        A row a flight; `index` is its place in the design. A flight that has no row has no output.
    flown
        The design.
    outputs
        Keys of the score, or `outcome`.
    seed
        Of the bootstrap.
    """
    found = []
    for name in outputs:
        values = np.full(len(flown.unit), np.nan)
        if name == AS_EXPECTED or name in runs:
            values[runs["index"].to_numpy(int)] = output_of(runs, name)
        found.append(analyse(values, flown, name, seed=seed))
    return tuple(found)


def analyse(values: Array, flown: Design, output: str = "", *, confidence: float = 0.95, seed: int = 0) -> Effects:
    """Estimate what each factor does to an output, with intervals.

    Parameters
    ----------
    values
        The output of each flight of the design, in its order; NaN where it does not exist. Up to 5 % of base points or
        trajectories may hold one and are left out whole; with more there are no numbers.
    flown
        The design.
    output
        Its name.
    confidence, seed
        Of the intervals, and of the bootstrap.

    Raises
    ------
    ValueError
        If there is not a value for each flight.
    """
    if values.shape != (len(flown.unit),):
        raise ValueError(f"{len(flown.unit)} flights are in the design, and {values.size} values are given")
    blocks = values.reshape(flown.bases, flown.block)
    whole = np.isfinite(blocks).all(axis=1)
    missing, left_out = int(np.sum(~np.isfinite(values))), int(np.sum(~whole))
    there = values[np.isfinite(values)]
    mean, sd = (float(there.mean()), float(there.std())) if there.size else (np.nan, np.nan)
    why = ""
    if left_out > LEFT_OUT * flown.bases:
        what = "base points" if flown.method == "sobol" else "trajectories"
        why = f"{missing} flights lack it, in {left_out} of {flown.bases} {what}; {100 * LEFT_OUT:g} % are the most"
    elif there.size and np.ptp(there) <= 1e-12 * max(abs(mean), 1e-300):
        why = "it is the same in every flight"
    elif whole.sum() < 2:
        why = "there are too few flights"
    if why:
        return Effects(output, _empty(flown), mean, sd, missing, left_out, why)
    kept, unit = blocks[whole], flown.unit.reshape(flown.bases, flown.block, -1)[whole]
    found = (
        _indices(kept, flown, confidence, seed)
        if flown.method == "sobol"
        else _screened(kept, unit, flown, confidence, seed)
    )
    return Effects(output, _with_swing(found, kept, unit, flown, confidence, seed), mean, sd, missing, left_out)


COLUMNS: dict[str, tuple[str, ...]] = {
    "sobol": ("first", "total", "swing"),
    "morris": ("mu_star", "mu", "sigma", "swing"),
}


def _empty(flown: Design) -> "pd.DataFrame":
    import pandas as pd

    names = [name + end for name in COLUMNS[flown.method] for end in ("", "_low", "_high")]
    return pd.DataFrame({"factor": flown.names} | dict.fromkeys(names, np.nan))


def _interval(resampled: Array, confidence: float) -> tuple[Array, Array]:
    """Return quantiles of a bootstrap, shape (resamples, factors)."""
    tail = 0.5 * (1.0 - confidence)
    low, high = np.quantile(resampled, (tail, 1.0 - tail), axis=0)
    return low, high


def _indices(blocks: Array, flown: Design, confidence: float, seed: int) -> "pd.DataFrame":
    import pandas as pd
    from SALib.analyze import sobol

    found = sobol.analyze(
        _problem(flown.names),
        blocks.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=confidence,
        keep_resamples=True,
        seed=int(_generator(seed, 1).integers(1, 2**31)),
    )
    columns: dict[str, Any] = {"factor": flown.names}
    for ours, theirs in (("first", "S1"), ("total", "ST")):
        low, high = _interval(found[f"{theirs}_conf_all"], confidence)
        columns |= {ours: found[theirs], f"{ours}_low": low, f"{ours}_high": high}
    return pd.DataFrame(columns)


def _screened(blocks: Array, unit: Array, flown: Design, confidence: float, seed: int) -> "pd.DataFrame":
    import pandas as pd

    effects = _effects(blocks, unit)
    drawn = _generator(seed, 1).integers(len(effects), size=(RESAMPLES, len(effects)))
    columns: dict[str, Any] = {"factor": flown.names}
    values, resampled = _measures(effects), _measures(effects[drawn])
    for name, value in values.items():
        low, high = _interval(resampled[name], confidence)
        columns |= {name: value, f"{name}_low": low, f"{name}_high": high}
    return pd.DataFrame(columns)


def _measures(effects: Array) -> dict[str, Array]:
    """Return Morris' measures of elementary effects, shape (…, trajectories, factors)."""
    return {
        "mu_star": np.abs(effects).mean(axis=-2),
        "mu": effects.mean(axis=-2),
        "sigma": effects.std(axis=-2, ddof=1),
    }


def _effects(blocks: Array, unit: Array) -> Array:
    """Elementary effects of trajectories, shape (trajectories, factors), over the whole range of a factor."""
    steps, change = np.diff(unit, axis=1), np.diff(blocks, axis=1)
    moved = np.argmax(np.abs(steps), axis=2)
    found = np.full((len(blocks), unit.shape[2]), np.nan)
    rows = np.arange(len(blocks))[:, None]
    found[rows, moved] = change / np.take_along_axis(steps, moved[:, :, None], axis=2)[:, :, 0]
    return found


def _with_swing(
    rows: "pd.DataFrame", blocks: Array, unit: Array, flown: Design, confidence: float, seed: int
) -> "pd.DataFrame":
    """Add how far the output goes with each factor: Σ ΔY Δu / Σ Δu² over pairs that differ in it alone."""
    if flown.method == "sobol":
        du = np.stack([unit[:, 1 + i, i] - unit[:, 0, i] for i in range(unit.shape[2])], axis=1)
        product, square = du * (blocks[:, 1:-1] - blocks[:, :1]), du * du
    else:
        du = np.abs(np.diff(unit, axis=1)).max(axis=2)[:, :1]
        product, square = _effects(blocks, unit) * du * du, np.broadcast_to(du * du, (len(blocks), unit.shape[2]))
    drawn = _generator(seed, 2).integers(len(blocks), size=(RESAMPLES, len(blocks)))
    low, high = _interval(SWING * product[drawn].sum(axis=1) / square[drawn].sum(axis=1), confidence)
    found = rows.assign(swing=SWING * product.sum(axis=0) / square.sum(axis=0), swing_low=low, swing_high=high)
    found.loc[found["factor"] == REST, ["swing", "swing_low", "swing_high"]] = np.nan
    return found
