"""Which flights of a campaign are kept whole.

    none            none
    all             all
    failures        those that did not end as expected, or missed a requirement
    failures:20     the first 20 of them
    every:100       every 100th
    worst:20:KEY    the 20 with the greatest value of a column (a null counts as worst)
    least:20:KEY    the 20 with the least

The first flight is always kept but with `none`: the bound is computed for its schedule of readings. What only all
flights together tell (`failures:20`, `worst`, `least`) is flown once more when they are there: a flight is a function
of its index, so nothing is lost by that.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

Rule = Literal["none", "all", "failures", "every", "worst", "least"]
DEFAULT = "failures:20"
ALLOWED = "none, all, failures, failures:N, every:N, worst:N:KEY or least:N:KEY"
MOST = 1_000_000


@dataclass(frozen=True, slots=True)
class Keep:
    """A rule.

    Attributes
    ----------
    rule : str
    number : int or None
        How many, or every how many.
    key : str
        Of the column that is compared.
    """

    rule: Rule
    number: int | None = None
    key: str = ""

    def wants(self, position: int, row: dict[str, Any]) -> bool:
        """Whether a flight is kept as it comes."""
        if self.rule == "none":
            return False
        if position == 0 or self.rule == "all":
            return True
        if self.rule == "failures" and self.number is None:
            return bool(row["outcome"] != row["expected"] or not row["requirements.met"])
        return self.rule == "every" and position % (self.number or 1) == 0

    @property
    def later(self) -> bool:
        """Whether it takes all flights to tell which are kept."""
        return self.rule in ("worst", "least") or (self.rule == "failures" and self.number is not None)

    @property
    def columns(self) -> list[str]:
        """What `among` has to see."""
        return ["index", "outcome", "expected", "requirements.met", *filter(None, [self.key])]

    def among(self, runs: "pd.DataFrame") -> list[int]:
        """Return the indices of those to keep of all flights; only of a rule that is told `later`."""
        if self.rule == "failures":
            failed = (runs["outcome"] != runs["expected"]) | ~runs["requirements.met"].astype(bool)
            return [int(index) for index in runs["index"][failed].iloc[: self.number]]
        values = runs[self.key].to_numpy(float)
        badness = np.where(np.isnan(values), np.inf, values if self.rule == "worst" else -values)
        order = np.argsort(-badness, kind="stable")[: self.number]
        return [int(index) for index in runs["index"].to_numpy()[np.sort(order)]]

    def expected(self, size: int) -> int | None:
        """About how many are kept of so many flights; None where that is not known before."""
        if self.rule == "none":
            return 0
        if self.rule == "all":
            return size
        if self.rule == "every":
            return -(-size // (self.number or 1))
        return None if self.number is None else min(self.number + 1, size)

    def __str__(self) -> str:
        """As it is written."""
        return ":".join(str(part) for part in (self.rule, self.number, self.key) if part not in (None, ""))


FIRST_AND_FAILURES = Keep("failures")
NOTHING = Keep("none")


def keep_of(text: str, columns: Iterable[str]) -> Keep:
    """Read a rule.

    Parameters
    ----------
    text
        As above.
    columns
        That can be compared.

    Raises
    ------
    ValueError
        One line: what is allowed.
    """
    rule, number, key = (*text.split(":", 2), "", "")[:3]
    wanted = {"none": (0, 0), "all": (0, 0), "failures": (0, 1), "every": (1, 1), "worst": (2, 2), "least": (2, 2)}
    given = 2 if key else 1 if number else 0
    least, most = wanted.get(rule, (1, 0))
    if not least <= given <= most or (number and not re.fullmatch(r"[1-9][0-9]{0,6}", number)):
        raise ValueError(f"--keep {text[:60]!r}: must be {ALLOWED}")
    known = list(columns)
    if key and key not in known:
        from sensors.choice import nearest

        near = nearest(key, known)
        raise ValueError(
            f"--keep {text[:60]!r}: {key!r} is no number of the score" + (f"; did you mean {near!r}?" if near else "")
        )
    return Keep(rule, int(number) if number else None, key)  # type: ignore[arg-type]
