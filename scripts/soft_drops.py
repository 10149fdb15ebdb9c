"""What the limits of the default detector cost: soft drops taken for launches, against delay and launches lost.

    .venv/bin/python scripts/soft_drops.py --hours 200 --trials 1000 --seed 42

Drops of 6-12 g for 15-25 ms, 1800 an hour, a sixth of them along +x; wings: what the flight computer behind the
detector makes of them (`uavsim.studies.wing_commands`). Launches of 5 and 10 g as `uavsim roc` draws them. Prints a
table in Markdown.
"""

import argparse
from dataclasses import replace

from uavsim.onboard.launch import DetectorSettings
from uavsim.studies.false_alarms import count
from uavsim.studies.operating import launches_of, scored, tried
from uavsim.truth import STANDARD_GRAVITY as G0

LIMITS = ((9.0, 16.0), (11.0, 16.0), (14.0, 16.0), (20.0, 20.0))  # g·ms: the least and the highest
CELLS = ((5.0, 0.3), (10.0, 0.3), (5.0, 1.0))  # g: peak, σ


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=200.0)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=42)
    options = parser.parse_args()
    own = DetectorSettings()
    settings = [
        replace(own, adaptive=replace(own.adaptive, limit=round(a * 1e-3 * G0, 4), highest=round(b * 1e-3 * G0, 4)))
        for a, b in LIMITS
    ]
    drops = count(settings, {"soft drops": options.hours}, seed=options.seed)["soft drops"]
    cells = [
        [scored(one) for one in tried(settings, launches_of((*cell, False)), seed=options.seed, trials=options.trials)]
        for cell in CELLS
    ]
    print(
        "| `detector.adaptive.limit`, `highest` | soft drops taken for launches, 1/h | wings opened by them, 1/h "
        "| median delay at 5 and 10 g, σ 0.3 g, ms | lost at 5 g, σ 0.3 and 1 g |"
    )
    print("|---|---|---|---|---|")
    for i, one in enumerate(settings):
        five, ten, rough = (found[i] for found in cells)
        lost = [found["trials"] - found["detected"] for found in (five, rough)]
        most = drops[i].commands_interval()[1]
        print(
            f"| {one.adaptive.limit}, {one.adaptive.highest} | {drops[i].per_hour:.3g} "
            f"| {drops[i].commands_per_hour:.3g} (at most {most:.2g}) "
            f"| {1e3 * five['crossing_median']:.1f}, {1e3 * ten['crossing_median']:.1f} | {lost[0]}, {lost[1]} |"
        )


if __name__ == "__main__":
    main()
