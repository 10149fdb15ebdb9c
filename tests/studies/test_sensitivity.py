"""Sensitivity on functions whose answers are known: Ishigami, a linear chain, and Campolongo's g."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from uavsim.studies.campaign.sensitivity import (
    REST,
    TooFewError,
    analyse,
    design,
    effects_of,
    flights_for,
    output_of,
)

A, B = 7.0, 0.1  # Ishigami and Homma 1990
FIRST = np.array([0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2, A**2 / 8.0, 0.0, 0.0])
THIRD = B**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
VARIANCE = A**2 / 8.0 + B * np.pi**4 / 5.0 + B**2 * np.pi**8 / 18.0 + 0.5
TOTAL = FIRST + np.array([THIRD, 0.0, THIRD, 0.0])


def ishigami(u: np.ndarray) -> np.ndarray:
    x = np.pi * (2.0 * u - 1.0)
    return np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])


def test_ishigami() -> None:
    """N = 1024: over 100 seeds the rms error is 0.012 or less, so 0.05 is four times that."""
    flown = design(("a", "b", "c"), 6 * 1024, seed=3)
    found = analyse(ishigami(flown.points), flown).rows
    assert found["first"].to_numpy() == pytest.approx(FIRST / VARIANCE, abs=0.05)
    assert found["total"].to_numpy() == pytest.approx(TOTAL / VARIANCE, abs=0.05)
    for name in ("first", "total"):
        assert (found[f"{name}_low"] <= found[name] + 1e-12).all()
        assert (found[name] <= found[f"{name}_high"] + 1e-12).all()


@pytest.mark.slow
@pytest.mark.parametrize("bases", [64, 128, 512])
def test_intervals_hold_ishigamis_indices(bases: int) -> None:
    """200 repetitions, 0.90 wanted of each; an interval that held 0.83 would pass with a chance of 1 %.

    Not the first-order index of c at N = 64, which is 0 and held in 0.85 of 100: so the least N is as it is, and
    `docs/sensitivity.md` says what it is worth.
    """
    inside = np.zeros((2, 4))
    for seed in range(200):
        flown = design(("a", "b", "c"), 6 * bases, seed)
        found = analyse(ishigami(flown.points), flown, seed=seed).rows
        for i, (name, truth) in enumerate((("first", FIRST / VARIANCE), ("total", TOTAL / VARIANCE))):
            low, high = (found[f"{name}{end}"].to_numpy() for end in ("_low", "_high"))
            inside[i] += (low <= truth + 1e-12) & (truth <= high + 1e-12)
    worst = inside / 200
    if bases == 64:
        assert worst[0, 2] >= 0.78
        worst[0, 2] = 1.0
    assert (worst >= 0.90).all(), worst


def chain(unit: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """y = 3 z_1 + 2 z_2 + z_3 + 2 e of normal inputs; e is drawn by the index alone."""
    noise = np.array([np.random.default_rng(int(i)).normal() for i in indices])
    return norm.ppf(unit[:, :3]) @ np.array([3.0, 2.0, 1.0]) + 2.0 * noise


def test_a_linear_chain_and_the_rest() -> None:
    """S_i = T_i = c_i²/Σc²: 9, 4, 1, and 4 for the rest, of 18; N = 1024, within 0.06 (four times the rms error)."""
    flown = design(("a", "b", "c"), 6 * 1024, seed=1)
    found = analyse(chain(flown.points, flown.indices), flown).rows
    truth = np.array([9.0, 4.0, 1.0, 4.0]) / 18.0
    assert found["first"].to_numpy() == pytest.approx(truth, abs=0.06)
    assert found["total"].to_numpy() == pytest.approx(truth, abs=0.06)
    assert list(found["factor"]) == ["a", "b", "c", REST]


def test_the_swing_has_a_sign_and_a_unit() -> None:
    """y = 5 u_1 - 2 u_2: from 10 % to 90 % it goes by 4 and by -1.6, by both methods, to rounding."""
    for runs in (6 * 64, 40):
        flown = design(("a", "b", "c"), runs, seed=1)
        found = analyse(flown.points @ np.array([5.0, -2.0, 0.0]), flown).rows
        assert found["swing"].to_numpy() == pytest.approx([4.0, -1.6, 0.0, np.nan], abs=1e-9, nan_ok=True)


def test_morris_ranks_campolongos_g() -> None:
    """g = Π (|4u - 2| + a)/(1 + a), a = 78, 12, 0.5, 2, 97, 33: the order is 3, 4, 2, 6, 1, 5 (Campolongo 2007)."""
    a = np.array([78.0, 12.0, 0.5, 2.0, 97.0, 33.0])
    flown = design(tuple("123456"), 8 * 20, seed=1, method="morris")
    found = analyse(np.prod((np.abs(4.0 * flown.points - 2.0) + a) / (1.0 + a), axis=1), flown).rows
    assert list(found.sort_values("mu_star", ascending=False)["factor"][:6]) == ["3", "4", "2", "6", "1", "5"]
    assert found["mu_star"].iloc[6] == 0.0  # the rest does nothing here


def test_morris_of_a_line_is_exact() -> None:
    """y = 5 u_1 - 2 u_2: the mean size is 5 and 2, with no spread."""
    flown = design(("a", "b"), 20, seed=1)
    found = analyse(flown.points @ np.array([5.0, -2.0]), flown).rows
    assert found["mu_star"].to_numpy() == pytest.approx([5.0, 2.0, 0.0], abs=1e-12)
    assert found["mu"].to_numpy() == pytest.approx([5.0, -2.0, 0.0], abs=1e-12)
    assert found["sigma"].to_numpy() == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_rest_beside_a_line_in_morris() -> None:
    """Two independent normal draws over half the range: mu* is 2 · 2/√π · s; r = 400, within 10 %."""
    flown = design(("a",), 1200, seed=2, method="morris")
    found = analyse(np.array([np.random.default_rng(int(i)).normal() for i in flown.indices]), flown).rows
    assert found["mu_star"].iloc[1] == pytest.approx(4.0 / np.pi**0.5, rel=0.1)


def test_one_factor_changes_at_a_time_and_none_is_at_the_edge() -> None:
    for runs, method in ((100, "morris"), (512, "sobol")):
        flown = design(("a", "b", "c"), runs, seed=4)
        assert flown.method == method
        assert flown.unit.min() > 0.0
        assert flown.unit.max() < 1.0
        blocks = flown.unit.reshape(flown.bases, flown.block, -1)
        if method == "morris":
            assert ((np.diff(blocks, axis=1) != 0.0).sum(axis=2) == 1).all()
            assert np.abs(np.diff(blocks, axis=1)).max() == pytest.approx(0.5)
        else:
            assert ((blocks[:, 1:-1] != blocks[:, :1]).sum(axis=2) == 1).all()
        rest = [len(set(block)) for block in flown.indices.reshape(flown.bases, -1)]
        assert set(rest) == {2}
        again = design(("a", "b", "c"), runs, seed=4)
        assert np.array_equal(flown.unit, again.unit)
        assert np.array_equal(flown.indices, again.indices)
        assert not np.array_equal(flown.unit, design(("a", "b", "c"), runs, seed=5).unit)


def test_how_many_flights_are_needed() -> None:
    assert (flights_for(3, "sobol"), flights_for(3, "morris")) == (64 * 6, 4 * 5)
    assert design(("a", "b", "c"), 64 * 6, 1).method == "sobol"
    assert design(("a", "b", "c"), 64 * 6 - 1, 1).method == "morris"
    assert len(design(("a", "b", "c"), 23, 1).unit) == 20
    with pytest.raises(TooFewError, match="need 20 flights or more, not 19"):
        design(("a", "b", "c"), 19, 1)
    with pytest.raises(TooFewError, match="need 384 flights or more, not 100"):
        design(("a", "b", "c"), 100, 1, "sobol")
    with pytest.raises(ValueError, match="there is no dispersion"):
        design((), 100, 1)


def test_what_has_no_number_says_so() -> None:
    flown = design(("a", "b"), 5 * 100, seed=1)
    values = flown.points[:, 0].copy()
    same = analyse(np.ones_like(values), flown)
    assert same.why == "it is the same in every flight"
    assert same.rows["first"].isna().all()
    values[:5] = np.nan
    few = analyse(values, flown)
    assert (few.missing, few.left_out, few.why) == (5, 1, "")
    assert few.rows["first"].iloc[0] == pytest.approx(1.0, abs=0.1)
    values[::50] = np.nan
    many = analyse(values, flown)
    assert many.rows["total"].isna().all()
    assert many.why == "14 flights lack it, in 10 of 100 base points; 5 % are the most"
    nothing = analyse(np.full_like(values, np.nan), flown)
    assert nothing.why
    with pytest.raises(ValueError, match="500 flights are in the design"):
        analyse(values[:-1], flown)


def test_outputs_of_rows() -> None:
    flown = design(("a", "b"), 16, seed=1)
    rows = pd.DataFrame({"index": range(16), "outcome": "cruise", "expected": "cruise", "y": flown.points[:, 0]})
    rows.loc[3, "outcome"] = "crashed"
    assert output_of(rows, "outcome").tolist() == [1.0] * 3 + [0.0] + [1.0] * 12
    found = {one.output: one for one in effects_of(rows.drop(index=7), flown, ("outcome", "y", "z"), seed=1)}
    assert found["y"].missing == 1
    assert found["z"].missing == 16
    assert found["outcome"].left_out == 1
