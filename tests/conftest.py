"""Flights that many tests look at, flown once a session."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

import uavsim
from uavsim.flight import Flight


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--whole`: what `make certify` adds to the long checks."""
    parser.addoption("--whole", action="store_true", help="all seeds of the long checks, not a fixed part of them")


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print what the long checks measured, least … median … greatest, in whatever process they ran."""
    reports = [report for outcome in ("passed", "failed") for report in terminalreporter.stats.get(outcome, ())]
    lines = [value for report in reports if report.when == "call" for name, value in report.user_properties
             if name == "measured"]  # fmt: skip
    if file := os.environ.get("UAVSIM_FIGURES"):  # for the documentation, see scripts/docs_numbers.py
        figures = [value for one in reports for name, value in one.user_properties if name == "figure"]
        Path(file).write_text(json.dumps(figures, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")
    if lines:
        terminalreporter.section("measured: least … median … greatest")
        for line in lines:
            terminalreporter.write_line(line)


@pytest.fixture(scope="session")
def whole(request: pytest.FixtureRequest) -> bool:
    """Whether all seeds of the long checks are flown; else the first of them, which are always the same."""
    return bool(request.config.getoption("--whole"))


@pytest.fixture(scope="session")
def catapult() -> Flight:
    """Return the packaged `catapult`, seed 1."""
    return uavsim.fly("catapult", seed=1)


@pytest.fixture(scope="session")
def weak_launch() -> Flight:
    """Return the packaged `weak-launch`, seed 1."""
    return uavsim.fly("weak-launch", seed=1)
