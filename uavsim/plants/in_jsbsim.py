"""The aircraft in JSBSim as a kind of plant; JSBSim itself is loaded when one is made."""

from uavsim.plants.kinds import Kind
from uavsim.plants.plant import Plant, Run


def _make(_: None, run: Run) -> Plant:
    from uavsim.plants.jsbsim import JsbsimPlant

    return JsbsimPlant(run)


KIND = Kind("jsbsim", _make, flies=True, rings=True)
