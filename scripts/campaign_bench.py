"""What flying many costs beside flying: throughput, CPU, memory, and where a large cluster would saturate.

    python scripts/campaign_bench.py throughput --pairs 5 --flights 24
    python scripts/campaign_bench.py memory --flights 1000 20000
    python scripts/campaign_bench.py capacity

`throughput` flies the same flights with two workers of the engine and with two independent processes that know nothing
of each other, in pairs one after the other, and prints the ratio of flights a second, with the range of the pairs and a
95 % interval of the median by the sign test. Beside it stand CPU a flight over the CPU of its loop, and what the
engine and writing take of the flying time. `memory` flies short flights of a rig and prints the greatest memory of the
process that drives. `capacity` measures the cost of an empty task and of a row, and says what follows for a million
flights on 200 cores.
"""

import argparse
import resource
import subprocess
import sys
import time
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from uavsim.cosim import Cosimulation
from uavsim.scenario import load_scenario
from uavsim.studies.campaign.campaign import fly_plan
from uavsim.studies.campaign.flown import fly_position
from uavsim.studies.campaign.keep import NOTHING
from uavsim.studies.campaign.plan import Random
from uavsim.studies.campaign.record import Record
from uavsim.studies.engine import engine

RIG = ("duration=1.75", "launcher.wait_min=1.6", "launcher.wait_max=1.61", "plant.launch_curve.length=0.06",
       "requirements=[]")  # fmt: skip
MILLION, CORES = 1_000_000, 200


def plan_of(scenario: str, flights: int, overrides: tuple[str, ...] = ()) -> Random:
    """Return random flights of a scenario."""
    return Random(load_scenario(scenario, overrides=overrides), flights)


def alone(scenario: str, first: int, last: int) -> None:
    """Fly some in this process, one after the other; print how long that took without start-up, s."""
    plan = plan_of(scenario, last)
    fly_position(plan, NOTHING, None, first)  # what a process does once
    started = time.perf_counter()
    for position in range(first, last):
        fly_position(plan, NOTHING, None, position)
    print(time.perf_counter() - started)


def independent(scenario: str, flights: int) -> float:
    """Return flights a second of two processes at once, each with half of them."""
    half = flights // 2
    commands = [[sys.executable, __file__, "alone", scenario, str(a), str(b)] for a, b in ((0, half), (half, flights))]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for command in commands]
    longest = max(float(process.communicate()[0]) for process in running)
    return flights / longest


def engaged(scenario: str, flights: int) -> tuple[float, float, float]:
    """Return flights a second of two workers, CPU of both a flight, and of the process that drives, s."""
    plan = plan_of(scenario, flights)
    with TemporaryDirectory() as folder, engine(workers=2) as crew:
        warm = partial(fly_position, plan, NOTHING, None)
        crew.each(warm, [0, 1], done=lambda _: None)
        before = crew.site.client.run(_cpu)  # type: ignore[attr-defined]
        own, started = time.process_time(), time.perf_counter()
        fly_plan(Record(Path(folder), plan), crew, NOTHING)
        elapsed, own = time.perf_counter() - started, time.process_time() - own
        after = crew.site.client.run(_cpu)  # type: ignore[attr-defined]
    spent = sum(after.values()) - sum(before.values())
    return flights / elapsed, spent / flights, own / flights


def _cpu() -> float:
    return time.process_time()


def loop_cpu(scenario: str, flights: int) -> float:
    """Return CPU of a flight's loop alone, s."""
    plan = plan_of(scenario, flights)
    found = []
    for position in range(flights):
        simulation = Cosimulation(plan.flight(position))
        started = time.process_time()
        simulation.advance(simulation.steps)
        found.append(time.process_time() - started)
    return median(found)


def throughput(scenario: str, pairs: int, flights: int) -> None:
    """Print pairs of rates, and CPU."""
    ratios, workers, drivers = [], [], []
    for number in range(pairs):
        if number % 2:
            engine_rate, worker, driver = engaged(scenario, flights)
            other = independent(scenario, flights)
        else:
            other = independent(scenario, flights)
            engine_rate, worker, driver = engaged(scenario, flights)
        ratios.append(engine_rate / other)
        workers.append(worker)
        drivers.append(driver)
        print(f"pair {number + 1}: {engine_rate:.3f} over {other:.3f} flights/s = {ratios[-1]:.3f}", flush=True)
    loop, worker, driver = loop_cpu(scenario, min(flights, 8)), median(workers), median(drivers)
    print(f"ratio: median {median(ratios):.3f}, from {min(ratios):.3f} to {max(ratios):.3f}")
    print(f"CPU a flight: worker {worker:.3f} s, driver {driver:.4f} s, loop alone {loop:.3f} s")
    print(f"worker over loop {worker / loop:.2f}, driver over worker {driver / worker:.3f}")


def memory(counts: list[int]) -> None:
    """Print the greatest memory of a process that drives, MB, each in a process of its own."""
    for count in counts:
        command = [sys.executable, __file__, "drive", str(count)]
        print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip(), flush=True)


def drive(count: int) -> None:
    """Fly that many short flights of a rig and print the memory of this process."""
    plan, started = plan_of("launch-curve", count, RIG), time.perf_counter()
    with TemporaryDirectory() as folder, engine(workers=2) as crew:
        flown = fly_plan(Record(Path(folder), plan), crew, NOTHING)
        rows = len(flown.frame(["index"]))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{rows} rows: {peak:.0f} MB at most, {count / (time.perf_counter() - started):.1f} flights/s")


def empty(_: int) -> None:
    """Do nothing."""


def _row(row: dict[str, object], index: int) -> dict[str, object]:
    """Another flight's row: no two have the same figures, which would pack to nothing."""
    other = {name: value * (1.0 + 1e-6 * index) if isinstance(value, float) else value for name, value in row.items()}
    return {**other, "index": index}


def capacity() -> None:
    """Measure what a task and a row cost, and say what that means for many."""
    with engine(workers=2) as crew:
        crew.each(empty, range(20), done=lambda _: None)
        cluster = crew.site.client  # type: ignore[attr-defined]
        started, own = time.perf_counter(), time.process_time()
        futures = [cluster.submit(empty, i, pure=False) for i in range(2000)]
        cluster.gather(futures)
        task, cpu = (time.perf_counter() - started) / 2000, (time.process_time() - own) / 2000
    plan = plan_of("catapult", 1000, ("duration=5", "expect=timeout"))
    flown = fly_position(plan, NOTHING, None, 0)
    with TemporaryDirectory() as folder:
        record = Record(Path(folder), plan)
        spent = []
        for position in range(0, 1000, 5):
            rows = [(position + i, flown._replace(row=_row(flown.row, position + i), trace=None)) for i in range(5)]
            started = time.process_time()
            record.keep(rows)
            spent.append(time.process_time() - started)
        size = sum(p.stat().st_size for p in Path(folder).rglob("*.parquet")) / 1000
    write = sum(spent) / 1000
    print(f"a task: {1e3 * task:.2f} ms, {1e3 * cpu:.2f} ms of it in the process that drives and schedules")
    print(f"a row: {1e3 * write:.2f} ms of CPU to write in bundles of five, {size:.0f} bytes")
    for seconds, bundle in ((0.8, 4), (0.8, 20)):
        tasks = CORES / (seconds * bundle)
        busy = tasks * cpu + CORES / seconds * write * 5 / bundle
        hours = MILLION * seconds / CORES / 3600
        print(
            f"{MILLION} flights of {seconds} s on {CORES} cores: {hours:.1f} h; bundles of {bundle}: {tasks:.0f} tasks "
            f"a second, driver busy {100 * busy:.0f} %, rows {MILLION * size / 1e9:.1f} GB"
        )


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("throughput")
    one.add_argument("--scenario", default="catapult")
    one.add_argument("--pairs", type=int, default=5)
    one.add_argument("--flights", type=int, default=24)
    two = commands.add_parser("memory")
    two.add_argument("--flights", type=int, nargs="+", default=[1000, 20000])
    commands.add_parser("capacity")
    inner = commands.add_parser("alone")
    inner.add_argument("scenario")
    inner.add_argument("first", type=int)
    inner.add_argument("last", type=int)
    commands.add_parser("drive").add_argument("count", type=int)
    given = parser.parse_args()
    if given.command == "throughput":
        throughput(given.scenario, given.pairs, given.flights)
    elif given.command == "memory":
        memory(given.flights)
    elif given.command == "capacity":
        capacity()
    elif given.command == "alone":
        alone(given.scenario, given.first, given.last)
    else:
        drive(given.count)


if __name__ == "__main__":
    main()
