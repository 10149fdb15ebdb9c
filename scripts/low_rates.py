"""What the default detector does on logs of 50 to 200 Hz: alarms an hour, delays, and the bound.

    .venv/bin/python scripts/low_rates.py --hours 20 --trials 2000 --seed 43

Disturbances and launches as `uavsim.studies.low_rates` makes them, filtered below 0.4 of the rate before they are
sampled, and plainly sampled. Prints a table in Markdown.
"""

import argparse
from dataclasses import replace

import numpy as np

from uavsim.onboard.launch import DetectorSettings
from uavsim.studies.low_rates import alarms, bound, delays

RATES = (50.0, 100.0, 200.0)  # Hz
CLASSES = ("mix", "vibration", "centrifuge")
SIGMA = 0.3  # g


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=20.0)
    parser.add_argument("--trials", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=43)
    options = parser.parse_args()
    own = DetectorSettings()
    rules = {
        "ours": own,
        "ours, `adaptive.confirm = false`": replace(own, adaptive=replace(own.adaptive, confirm=False)),
        "`multi-level-window`": DetectorSettings(kind="multi-level-window"),
    }
    print(
        "| rate | rule | alarms an hour, filtered: handling, 3 g rms, 4.1 g | plainly sampled "
        "| delay from the onset, ms: median, 95 % | lost | bound, ms |"
    )
    print("|---|---|---|---|---|---|---|")
    for rate in RATES:
        counted = {
            filtered: [
                alarms(tuple(rules.values()), rate, options.hours, seed=options.seed, filtered=filtered, kind=kind)
                for kind in CLASSES
            ]
            for filtered in (True, False)
        }
        least = bound(rate, SIGMA)
        for i, (name, rule) in enumerate(rules.items()):
            found = delays(rule, rate, options.trials, seed=options.seed, sigma_g=SIGMA)
            middle, late = 1e3 * np.nanquantile(found, (0.5, 0.95))
            told = [
                ", ".join(
                    f"{one[i].rate:.3g} (≤ {one[i].most:.2g})" if filtered else f"{one[i].rate:.3g}" for one in of
                )
                for filtered, of in counted.items()
            ]
            print(
                f"| {rate:g} Hz | {name} | {told[0]} | {told[1]} | {middle:.1f}, {late:.1f} "
                f"| {int(np.isnan(found).sum() + (found < 0.0).sum())} of {found.size} "
                f"| {'none' if least is None else f'{1e3 * least:.1f}'} |"
            )


if __name__ == "__main__":
    main()
