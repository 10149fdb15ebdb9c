"""Rare events: probabilities far below one over the number of flights that can be flown, with an error bar.

`estimate` takes a problem, a seed and a budget. `detectors` makes the problems of a launch detector at rest and in a
stroke, `flights` those of whole flights; `splitting`, `subset` and `shifted` are the methods. What they reach is
measured against exact probabilities in `docs/rare.md`.
"""

from uavsim.studies.campaign.rare.estimate import Estimate, Inputs, Step, estimate, per_hour
from uavsim.studies.campaign.rare.splitting import NoSplittingError, Watch

__all__ = ["Estimate", "Inputs", "NoSplittingError", "Step", "Watch", "estimate", "per_hour"]
