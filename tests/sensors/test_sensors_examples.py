"""The examples in the docstrings run and give what they say."""

import doctest
from importlib import import_module

import pytest


@pytest.mark.parametrize("module", ["bench", "catalogue", "probe", "promise", "streams"])
def test_examples(module):
    result = doctest.testmod(import_module(f"sensors.{module}"))
    assert result.attempted > 0
    assert result.failed == 0
