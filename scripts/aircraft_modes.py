"""Modes and static margin of an aircraft, flown in JSBSim with its controls fixed: python scripts/aircraft_modes.py.

The method is that of `uavsim linearise` (`uavsim.studies.linearise`); here one airspeed is printed, and the static
margin over the angle of attack with the tail neutral: -dC_m/dC_L about the centre of gravity, over `ALPHA_STEP` either
way.
"""

import argparse
import math
from pathlib import Path

from uavsim.plants.columns import FT as FOOT
from uavsim.plants.columns import LBF as POUND
from uavsim.plants.free import SPEED, Free
from uavsim.studies.linearise import ALPHA_STEP, WINGS, describe, named, roots, trim

__all__ = ["FOOT", "SPEED", "WINGS", "Free", "roots"]

ALPHAS = range(-6, 15, 1)  # deg


def print_modes(model: Path, speed: float) -> None:
    """Print trim and modes."""
    free = Free(model)
    alpha, tail, push = trim(free, speed)
    print(f"{model.name}, wing out, level at {speed:g} m/s: angle of attack {math.degrees(alpha):.2f}°, ", end="")
    print(f"tail {math.degrees(tail):.2f}°, thrust {push * POUND:.2f} N")
    for mode in named(*roots(free, speed)):
        print(f"  {mode.name:13s} {describe(mode.value)}")


def print_margins(model: Path) -> None:
    """Print the static margin over the angle of attack and the wing position, and C_mα of the wing out."""
    print("static margin, % of the chord, tail neutral; last column: C_mα per rad, wing out")
    print("  alpha " + "".join(f"  w={w:4.2f}" for w in WINGS) + "     Cmα")
    frees = [Free(model, w, steady=True) for w in WINGS]
    for alpha in ALPHAS:
        change = [free.lift_and_moment(alpha + ALPHA_STEP) - free.lift_and_moment(alpha - ALPHA_STEP) for free in frees]
        cells = "".join(f"{-100 * moment / lift:8.1f}" for lift, moment in change)
        print(f"{alpha:5d}° {cells}{change[-1][1] / math.radians(2 * ALPHA_STEP):10.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Modes and static margin with fixed controls.")
    parser.add_argument("model", nargs="?", default="aircraft/fw8", type=Path, help="folder of the aircraft")
    parser.add_argument("--speed", type=float, default=SPEED, help="m/s")
    chosen = parser.parse_args()
    print_modes(chosen.model.resolve(), chosen.speed)
    print_margins(chosen.model.resolve())
