"""What a step costs: the flight in the loop against the same JSBSim with the same truth recorded.

Three flights of the same aircraft and launch, JSBSim's own outputs off, advance side by side in chunks:

* in loop: plant, sensors, flight computer, all of it recorded;
* reference: the plant alone, every truth column recorded at every step, flown by the command tape of the first;
* bare: the same without recording.

Machines are noisy, so the ratio is the median over pairs of neighbouring chunks, not a quotient of totals. The
reference must end in the same state bit for bit, or it was not the same flight.

Of that, what would run on the aircraft: detector and airspeed estimator over a flight's own readings at 1 kHz and
100 Hz, from the rail to cruise, both all the way. The mean is that of the whole run, timed once; the percentile is over
single steps, each with the clock's own cost in it.
"""

from array import array
from collections.abc import Callable
from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter

from uavsim.beliefs import believed_air, believed_noise
from uavsim.cosim import Cosimulation, Draws, draw, plant_settings, tare_window
from uavsim.dispersions import resolved
from uavsim.onboard import airspeed, launch
from uavsim.onboard.rail_offset import RailOffset
from uavsim.plants.jsbsim import JsbsimPlant
from uavsim.plants.plant import Commands
from uavsim.scenario import Scenario

CHUNK = 500  # plant steps
PART, RATE = "icm-42688-p", 1000.0  # an accelerometer that has this output rate, Hz
REPEATS = 5  # runs of the same readings, of which the fastest counts: the others were disturbed


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost of a step, µs, and the ratios between the three ways to fly it."""

    in_loop: float
    reference: float
    bare: float
    ratio: float
    ratio_over_bare: float
    steps: int
    same_state: bool


@dataclass(frozen=True, slots=True)
class OnboardCost:
    """Cost of a step of detector and estimator together, µs: mean and 99th percentile."""

    mean: float
    p99: float
    steps: int


def measure_onboard(scenario: Scenario) -> OnboardCost:
    """Run detector and estimator of a scenario over the readings of its flight with an accelerometer at 1 kHz."""
    scenario = resolved(scenario, scenario.index)
    accelerometer = replace(scenario.accelerometer, preset=PART, rate=RATE, range_g=None, filter=None)
    timed = Scenario.from_dict(replace(scenario, accelerometer=accelerometer).to_dict())
    simulation = Cosimulation(timed)
    while not simulation.ended:
        simulation.advance(CHUNK)
    forces, air = _rows(simulation.readings, 4), _rows(simulation.air_readings, 6)
    whole, single = [], []
    for _ in range(REPEATS):
        whole.append(_run(timed, simulation.draws, forces, air, None))
        steps: list[float] = []
        _run(timed, simulation.draws, forces, air, steps)
        single.append(sorted(steps)[int(0.99 * len(steps))])
    return OnboardCost(mean=1e6 * min(whole) / len(forces), p99=1e6 * min(single), steps=len(forces))


def _rows(flat: "array[float]", width: int) -> list[tuple[float, ...]]:
    return list(zip(*(flat[i::width] for i in range(width)), strict=True))


def _run(
    scenario: Scenario,
    draws: Draws,
    forces: list[tuple[float, ...]],
    air: list[tuple[float, ...]],
    steps: list[float] | None,
) -> float:
    """Time a run, s; into `steps`, if it is a list, go the single steps."""
    detector = launch.build(scenario.detector, RATE)
    estimator = airspeed.build(
        believed_air(scenario),
        noise := believed_noise(scenario, draws.calibration),
        tare_window(scenario, draws.release_time),
    )
    rail = RailOffset(noise)
    feel, detect, step = estimator.accelerometer, detector.step, estimator.step
    rows = iter([*air, (float("inf"),) * 6])
    row, told, flying = next(rows), False, False
    begun = perf_counter()
    for force in forces:
        start = perf_counter() if steps is not None else 0.0
        t, fx, fy, fz = force
        if not flying:  # as the flight computer does it, here and below
            rail.add(t, fx, fy, fz)
        x, y, z = rail.offset
        fx, fy, fz = fx - x, fy - y, fz - z
        feel(t, fx, fy, fz)
        if told:
            estimator.tidy()
            feel, told = estimator.accelerometer, False
        if detect(t, fx, fy, fz):
            flying = True
            estimator.rested(rail.offset, rail.sd)
            estimator.launched(t)
        if row[0] <= t:
            step(*row)
            row, told = next(rows), True
        if steps is not None:
            steps.append(perf_counter() - start)
    return perf_counter() - begun


class _TapedPlant(JsbsimPlant):
    """A plant that keeps the commands it was given, with the step from which they act."""

    def __init__(self, scenario: Scenario) -> None:
        super().__init__(plant_settings(scenario, draw(scenario)))
        self.tape: list[tuple[int, Commands]] = []

    def command(self, commands: Commands) -> None:
        self.tape.append((self.k, commands))
        super().command(commands)


def measure(scenario: Scenario, *, progress: Callable[[float], None]) -> Cost:
    """Fly a scenario three ways at once and compare what a step takes.

    Raises
    ------
    ValueError
        If it is a rig, which JSBSim does not fly.
        If the flight ends before its time; its last chunks would not compare.
    """
    if not scenario.plant.chosen.flies:
        raise ValueError(f"{scenario.name}: plant.kind = {scenario.plant.kind!r}: only a flight in JSBSim has it")
    scenario = resolved(scenario, scenario.index)
    leader = _TapedPlant(scenario)
    loop = Cosimulation(scenario, plant=leader)
    reference = JsbsimPlant(plant_settings(scenario, draw(scenario)))
    bare = JsbsimPlant(plant_settings(scenario, draw(scenario)))
    times: list[tuple[float, float, float]] = []
    while leader.k < loop.steps:
        first, begin = len(leader.tape), leader.k
        start = perf_counter()
        loop.advance(CHUNK)
        middle = perf_counter()
        if loop.ended not in ("", "completed"):
            raise ValueError(f"{scenario.name}: the flight ends at {leader.t:g} s ({loop.ended}); nothing to compare")
        tape = leader.tape[first:]
        begun = perf_counter()
        _follow(reference, leader.k, tape, reference.step)
        done = perf_counter()
        _follow(bare, leader.k, tape, bare.step_unrecorded)
        ended, steps = perf_counter(), leader.k - begin
        times.append(((middle - start) / steps, (done - begun) / steps, (ended - done) / steps))
        progress(leader.k / loop.steps)
    per_step = [1e6 * median(column) for column in zip(*times, strict=True)]
    return Cost(
        in_loop=per_step[0],
        reference=per_step[1],
        bare=per_step[2],
        ratio=median(a / b for a, b, _ in times),
        ratio_over_bare=median(a / c for a, _, c in times),
        steps=leader.k,
        same_state=leader.row == reference.row,
    )


def _follow(plant: JsbsimPlant, until: int, tape: list[tuple[int, Commands]], step: Callable[[], object]) -> None:
    """Fly `plant` to step `until`, giving each command of the tape when its turn comes."""
    for k, commands in [*tape, (until, None)]:
        for _ in range(k - plant.k):
            step()
        if commands is not None:
            plant.command(commands)
