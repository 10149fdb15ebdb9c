"""The aircraft in JSBSim as a kind of plant; JSBSim itself is loaded when one is made."""

from uavsim.plants.kinds import KINDS, Kind
from uavsim.plants.plant import Plant, Run

NAME = "jsbsim"


def in_jsbsim(_: None, run: Run) -> Plant:
    """Make the plant of one run; errors as of `JsbsimPlant`."""
    from uavsim.plants.jsbsim import JsbsimPlant

    return JsbsimPlant(run)


KINDS.add(Kind(NAME, in_jsbsim, flies=True, rings=True, ours=True))
