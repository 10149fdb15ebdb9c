"""Write the aided airspeed filter's code from its model in symbols.

    python scripts/derive_airspeed.py            # writes uavsim/onboard/airspeed/energy_model.py
    python scripts/derive_airspeed.py --check    # compares it, and writes nothing

The model stands in scripts/airspeed_model/physics.py. The covariance's steps are multiplied out in symbols and compared
with F P Fᵀ + Q before anything is written. Needs sympy and ruff (`pip install -e .[dev]`). Exit status 1 if --check
finds another text.
"""

import argparse
import sys
from pathlib import Path

from airspeed_model.module import written

MODULE = Path(__file__).parent.parent / "uavsim" / "onboard" / "airspeed" / "energy_model.py"


def main() -> int:
    """Write the module; with --check, compare it."""
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--check", action="store_true", help="compare with what is there and write nothing")
    text = written()
    if options.parse_args().check:
        same = MODULE.read_text(encoding="utf-8") == text
        print(f"{MODULE.name} {'is' if same else 'is not'} what the model gives")
        return int(not same)
    MODULE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
