"""The generated model is what its derivation writes; what it computes is held in `test_airspeed_model`."""

import importlib
from pathlib import Path

from uavsim.onboard.airspeed import energy_model

SCRIPTS = Path(__file__).parents[2] / "scripts"


def test_generated_code_is_what_the_model_gives(monkeypatch):
    """A failure means that the model or the generator has changed: run `scripts/derive_airspeed.py`."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    derive = importlib.import_module("derive_airspeed")
    module = Path(energy_model.__file__)
    assert module == derive.MODULE
    assert module.read_text(encoding="utf-8") == derive.written()
