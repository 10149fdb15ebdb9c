"""What a step of each launch detector costs, µs, as a table in Markdown.

    .venv/bin/python scripts/detector_cost.py

One axis, plain Python, the least of seven runs over 10⁵ samples; at rest, and at 4.1 g with σ 1 g, where windows are
open half of the time.
"""

from time import perf_counter

import numpy as np

from uavsim.onboard.launch import KINDS, DetectorSettings, build
from uavsim.truth import STANDARD_GRAVITY as G0

RATE, SAMPLES, RUNS = 1000.0, 100_000, 7
LOADS = (0.17, 4.1)  # g along the axis: a rail of 10°, and the load
SIGMAS = (0.0, 1.0)  # g


def cost(kind: str, readings: list[tuple[float, float]]) -> float:
    """Return the time of a step, µs."""
    least = float("inf")
    for _ in range(RUNS):
        detector = build(DetectorSettings(kind=kind), RATE)
        step, begun = detector.step, perf_counter()
        for t, f in readings:
            if step(t, f, 0.0, 0.0):
                detector.reset()
        least = min(least, perf_counter() - begun)
    return 1e6 * least / len(readings)


def main() -> None:
    """Print the table."""
    noise = np.random.default_rng(1).standard_normal(SAMPLES)
    times = (np.arange(SAMPLES) / RATE).tolist()
    signals = [
        list(zip(times, (G0 * (load + sigma * noise)).tolist(), strict=True))
        for load, sigma in zip(LOADS, SIGMAS, strict=True)
    ]
    print("| kind | at rest, µs | at 4.1 g, σ 1 g, µs |\n|---|---|---|")
    for kind in KINDS:
        print(f"| {kind} | {' | '.join(f'{cost(kind, signal):.2f}' for signal in signals)} |")


if __name__ == "__main__":
    main()
