"""Batches of flights that the longer checks share, and the figures that they measure, printed at the end of a run."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from uavsim.scenario import load_scenario
from uavsim.studies.batch import Batch, fly_seeds

Figure = Callable[..., None]
WORKERS = 2


@pytest.fixture
def figure(request: pytest.FixtureRequest) -> Figure:
    """Hold every value of a figure against its bounds; least, median and greatest go into the summary."""

    def check(label: str, values: Sequence[float], unit: str = "", low: float = -np.inf, high: float = np.inf) -> None:
        sample = np.asarray(values, dtype=float)
        assert sample.size
        found = f"{sample.min():.4g} … {np.median(sample):.4g} … {sample.max():.4g} {unit}".rstrip()
        line = f"{label}: {found} ({sample.size} flights; asked {low:g} … {high:g})"
        request.node.user_properties.append(("measured", f"{request.node.name}: {line}"))
        asked = " … ".join("" if abs(bound) == np.inf else f"{bound:g}" for bound in (low, high)).strip()
        kept = {
            "check": request.node.name.removeprefix("test_").replace("_", " "),
            "label": label,
            "found": found,
            "size": f"{sample.size}",
            "asked": "–" if asked == "…" else asked,
        }
        request.node.user_properties.append(("figure", kept))
        assert np.isfinite(sample).all(), line
        assert np.all((sample >= low) & (sample <= high)), line

    return check


@pytest.fixture
def table(request: pytest.FixtureRequest) -> Callable[[str], None]:
    """Put a line of a table into the summary."""
    return lambda line: request.node.user_properties.append(("measured", line))


def flown(name: str, last: int, *overrides: str) -> Batch:
    """Fly a packaged scenario with seeds 1 … last."""
    return fly_seeds(load_scenario(name, overrides=overrides), list(range(1, last + 1)), workers=WORKERS)


@pytest.fixture(scope="session")
def catapult_50() -> Batch:
    return flown("catapult", 50)


@pytest.fixture(scope="session")
def catapult_paper_50() -> Batch:
    """With the published estimator."""
    return flown("catapult", 50, "estimator.kind=paper")


@pytest.fixture(scope="session")
def gusty_without_gust_20() -> Batch:
    return flown("gusty", 20, "environment.gust_speed=0")


@pytest.fixture(scope="session")
def gusty_20() -> Batch:
    return flown("gusty", 20)


@pytest.fixture(scope="session")
def strong_20() -> Batch:
    return flown("strong-launch", 20)


@pytest.fixture(scope="session")
def rough_20() -> Batch:
    return flown("rough-rail", 20)


@pytest.fixture(scope="session")
def weak_20() -> Batch:
    return flown("weak-launch", 20)


@pytest.fixture(scope="session")
def weak_with_6_g_20() -> Batch:
    return flown("weak-launch", 20, "launcher.peak_specific_force_g=6", "expect=cruise")


@pytest.fixture(params=["untared", "cheap-sensors", "blocked-pitot", "iced-pitot"])
def sensors_20(request: pytest.FixtureRequest) -> Batch:
    return flown(request.param, 20)
