"""Where the truth comes from. Only `uavsim.plants.jsbsim` imports jsbsim."""
