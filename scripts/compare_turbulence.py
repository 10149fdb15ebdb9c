"""Fly through turbulence over fields of several heights in several source trees, and print what was met at 60 m.

    python scripts/compare_turbulence.py 0.1=../v01 now=. [--fields 0,400,610,1000,1500,3000] [--wind 7.5]

One flight of five minutes a field and tree: a mean wind of 6 m/s, turbulence of a wind of 7.5 m/s at 20 ft, no gust.
Printed are the standard deviation of the vertical wind from 40 s on (of w the law has 0.1 of the wind at 20 ft) and the
mean of its one-sided density over that of Dryden's law at that height and airspeed from 1 to 3 and from 3 to 40 Hz,
which says something where the wind at 20 ft rules.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from compare_versions import run, tree
from scipy.signal import welch

HEIGHT = 60.0  # m above the ground; σ_w is 0.1 of the wind at 20 ft there, and L_w the height
SETTLED = 40.0  # s
FLIGHT = ("duration=300", "environment.wind_speed=6", "environment.gust_speed=0", "flight_computer.height=60")
BANDS = ((1.0, 3.0), (3.0, 40.0))  # Hz


def density(f: np.ndarray, wind: float, airspeed: float) -> np.ndarray:
    """One-sided density of w over the frequency in Hz, (m/s)²/Hz: MIL-F-8785C 3.7.1.2."""
    time = HEIGHT / airspeed
    x = 3.0 * (2.0 * np.pi * f * time) ** 2
    return 2.0 * (0.1 * wind) ** 2 * time * (1.0 + x) / (1.0 + x / 3.0) ** 2


def main() -> None:
    """Parse, fly, print."""
    parser = argparse.ArgumentParser(description="Compare the turbulence of several source trees.")
    parser.add_argument("trees", nargs="+", metavar="[NAME=]FOLDER", type=tree)
    parser.add_argument("--fields", default="0,400,610,1000,1500,3000", help="heights above sea level, m")
    parser.add_argument("--wind", type=float, default=7.5, help="at 20 ft, of which the turbulence is, m/s")
    parser.add_argument("--seed", default="1")
    options = parser.parse_args()
    heads = " | ".join(f"{low:g} … {high:g} Hz" for low, high in BANDS)
    print(f"| field, m | | sd of w, m/s | mean height, m | {heads} |", "|---" * 6 + "|", sep="\n")
    for field in options.fields.split(","):
        changes = [*FLIGHT, f"environment.turbulence_wind_20ft={options.wind}", f"environment.ground_elevation={field}"]
        for name, root in options.trees:
            with tempfile.TemporaryDirectory() as folder:
                run(root, "gusty", ["--seed", options.seed], changes, Path(folder) / "flight")
                columns = ["t", "altitude", "airspeed", "wind_d"]
                truth = pd.read_parquet(Path(folder) / "flight" / "truth.parquet", columns=columns)
            late = truth[truth["t"] > SETTLED]
            f, found = welch(late["wind_d"].to_numpy(), fs=1000.0, nperseg=8192)
            law = density(f, options.wind, late["airspeed"].mean())
            ratios = " | ".join(f"{np.mean((found / law)[(f > low) & (f < high)]):.2f}" for low, high in BANDS)
            above = late["altitude"].mean() - float(field)
            print(f"| {field} | {name} | {late['wind_d'].std():.2f} | {above:.0f} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
