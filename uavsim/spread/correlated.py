"""Correlated normal values: x = L z, with the lower triangular factor L Lᵀ = R of the correlation matrix.

Row i of L has no column beyond i, so a value is made of its own standard normal one and of those before it in the file:
what comes after it changes nothing of it. Values that nothing correlates, however many links away, share no row.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import sqrt

from uavsim.spread.settings import Correlation

SINGULAR = 1e-10  # of a pivot or an eigenvalue of a matrix with ones on its diagonal, which rounding leaves of 0

Matrix = list[list[float]]


def groups(keys: Sequence[str], correlations: Iterable[Correlation]) -> list[list[str]]:
    """Keys that hang together by correlations, each group in the order of the file."""
    label = {key: key for key in keys}
    for correlation in correlations:
        a, b = (label[key] for key in correlation.between)
        label = {key: a if found == b else found for key, found in label.items()}
    linked: dict[str, list[str]] = {}
    for key in keys:
        linked.setdefault(label[key], []).append(key)
    return [group for group in linked.values() if len(group) > 1]


def matrix(keys: Sequence[str], correlations: Iterable[Correlation]) -> Matrix:
    """The correlation matrix of some keys."""
    rows = [[1.0 if i == j else 0.0 for j in range(len(keys))] for i in range(len(keys))]
    place = {key: i for i, key in enumerate(keys)}
    for correlation in correlations:
        a, b = correlation.between
        if a in place:
            rows[place[a]][place[b]] = rows[place[b]][place[a]] = correlation.coefficient
    return rows


def factor(rows: Matrix) -> Matrix:
    """Cholesky's factor of a positive semidefinite matrix; columns of a pivot of 0 are 0."""
    size = len(rows)
    lower = [[0.0] * size for _ in range(size)]
    for j in range(size):
        pivot = rows[j][j] - sum(value * value for value in lower[j][:j])
        if pivot <= SINGULAR:
            continue
        lower[j][j] = sqrt(pivot)
        for i in range(j + 1, size):
            lower[i][j] = (rows[i][j] - sum(lower[i][k] * lower[j][k] for k in range(j))) / lower[j][j]
    return lower


def correlated(normals: Mapping[str, float], correlations: Sequence[Correlation]) -> dict[str, float]:
    """Standard normal values that go together as is said, from independent ones; the others as they are."""
    found = dict(normals)
    for group in groups(list(normals), correlations):
        rows = factor(matrix(group, correlations))
        for key, row in zip(group, rows, strict=True):
            found[key] = sum(share * normals[other] for share, other in zip(row, group, strict=True) if share)
    return found
