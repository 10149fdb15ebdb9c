"""Flights that many tests look at, flown once a session."""

import pytest

import uavsim
from uavsim.flight import Flight


@pytest.fixture(scope="session")
def catapult() -> Flight:
    """Return the packaged `catapult`, seed 1."""
    return uavsim.fly("catapult", seed=1)


@pytest.fixture(scope="session")
def weak_launch() -> Flight:
    """Return the packaged `weak-launch`, seed 1."""
    return uavsim.fly("weak-launch", seed=1)
