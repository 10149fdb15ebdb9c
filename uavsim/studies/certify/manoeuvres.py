"""Twenty hours of flight on prescribed courses in which nothing is broken: no port may be condemned.

620 flights of 120 s with the rig `flight-path`. Each is pushed by a catapult, a motor, a bungee or a hand, climbs, and
then flies drawn legs one after the other: still and level flight, set speeds from 20 m/s to the greatest that is drawn
(60, 120 or 200 m/s), turns with up to 60° of bank, push-overs to 0 g, pull-ups to 4 g, climbs and descents. Parts,
tare, noise, field (-400 … 4000 m) and temperature (-40 … 55 °C at the ground) are drawn; half of the flights are in
still air, half in a wind of 3 … 8 m/s with its turbulence.

Each is scored as the rig is, over its whole run. A flag that says `range` where a pressure of the course is beyond the
part's range is none that is false.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sensors import Streams
from sensors.knowledge import known_of_head
from uavsim.flight import Flight
from uavsim.scenario import Scenario
from uavsim.studies.certify.figures import Row
from uavsim.studies.certify.healthy import ACCELEROMETERS, PRESSURES
from uavsim.studies.certify.tasks import Task
from uavsim.studies.certify.verdict import Check, Verdict
from uavsim.studies.intervals import rate_interval, share_interval
from uavsim.truth import STANDARD_GRAVITY

SIZE = 620
HOURS = 20.0
DURATION = 120.0  # s
SLOWEST, FASTEST = 20.0, (60.0, 120.0, 200.0)  # m/s
FAST_ENOUGH = 36.0  # m/s from which on a wing of 25 kg/m² gives 4 g below its stall
SLOWEST_TURN = 28.0  # m/s, likewise for 2 g
HIGH_ENOUGH = 150.0  # m above the ground from which on it may descend
PUSHES = {
    "catapult": ("launcher.peak_specific_force_g=8",),
    "motor": ("launcher.peak_specific_force_g=5.5", "launcher.elevation_deg=25"),
    "bungee": ("launcher.peak_specific_force_g=9", "launcher.stroke=9"),
    "throw": ("launcher.peak_specific_force_g=9",),
}
WARMEST, COLDEST = 55.0, -40.0  # °C at the ground
SHOWN = 24


class Course:
    """Legs that are drawn one after the other, with the speed, the climb and the height that they lead to.

    Parameters
    ----------
    generator
        Draws.
    fastest
        Greatest airspeed, m/s.
    """

    def __init__(self, generator: np.random.Generator, fastest: float) -> None:
        self._draw, self._fastest = generator, fastest
        self.legs: list[str] = []
        self.time, self.speed, self.climb, self.height = 0.0, 30.0, 12.0, 0.0

    def add(self, duration: float, **keys: float) -> None:
        """Add a leg with its keys beside the duration; what is not said stays as it was."""
        leg = {"duration": duration, **keys}
        self.legs.append("{" + ",".join(f"{key}={value:.3g}" for key, value in leg.items()) + "}")
        self.time += duration
        speed, climb = keys.get("airspeed", self.speed), keys.get("climb_deg", self.climb)
        mean = np.radians(0.5 * (climb + self.climb))
        self.height += float(np.sin(mean)) * 0.5 * (speed + self.speed) * duration
        self.speed, self.climb = speed, climb

    def begin(self) -> None:
        """Climb away from the rail at a speed that carries, to where it may descend."""
        self.add(6.0, airspeed=float(self._draw.uniform(30.0, 45.0)), climb_deg=12.0)
        self.add(max(2.0, (HIGH_ENOUGH - self.height) / (0.2 * self.speed)))
        self.level()

    def level(self) -> None:
        """Go over to level flight without bank."""
        self.add(3.0, climb_deg=0.0, bank_deg=0.0)

    def next(self) -> None:
        """Add what is drawn next; it ends level."""
        kind = str(self._draw.choice(["still", "speed", "turn", "load", "load", "climb", "descent"]))
        if kind == "still":
            self.add(float(self._draw.uniform(8.0, 20.0)))
        elif kind == "speed":
            aim = float(self._draw.uniform(SLOWEST, self._fastest))
            self.add(max(4.0, abs(aim - self.speed) / 5.0), airspeed=aim)
            self.add(float(self._draw.uniform(2.0, 6.0)))
        elif kind == "turn":
            self._turn()
        elif kind == "load":
            self._load()
        else:
            self._climb(down=kind == "descent")

    def _turn(self) -> None:
        if self.speed < SLOWEST_TURN:
            self.add(5.0, airspeed=SLOWEST_TURN)
        self.add(2.0, bank_deg=float(self._draw.choice([-1.0, 1.0]) * self._draw.uniform(20.0, 60.0)))
        self.add(float(self._draw.uniform(4.0, 12.0)))
        self.add(2.0, bank_deg=0.0)

    def _load(self) -> None:
        """Push over to 0 g, or pull up to 2 … 4 g; half of the extreme load is there on average."""
        if self.speed < FAST_ENOUGH:
            self.add(8.0, airspeed=float(self._draw.uniform(FAST_ENOUGH, 60.0)))
        over = self._draw.random() < 0.5 and self.height >= HIGH_ENOUGH
        load, time = (0.0, 2.0) if over else (float(self._draw.uniform(2.0, 4.0)), 1.5)
        self.add(time, load_g=load)
        turned = 0.5 * (load - 1.0) * STANDARD_GRAVITY * time / self.speed  # rad of climb
        self.height += self.speed * turned * (0.5 * time + 1.5)  # of it, and of the way back to level flight
        self.level()

    def _climb(self, *, down: bool) -> None:
        down = down and self.height > 2.0 * HIGH_ENOUGH
        climb = float(self._draw.uniform(3.0, 12.0)) * (-1.0 if down else 1.0)
        time = float(self._draw.uniform(3.0, 8.0))
        if down:
            room = (self.height - HIGH_ENOUGH) / (self.speed * float(np.sin(np.radians(-climb)))) - 3.0
            time = min(time, max(room, 0.2))
        self.add(2.0, climb_deg=climb)
        self.add(time)
        self.level()


def drawn_course(generator: np.random.Generator, fastest: float) -> str:
    """Return the legs of a flight as a value of `plant.flight_path.legs`."""
    course = Course(generator, fastest)
    course.begin()
    while course.time < DURATION:
        course.next()
    return f"[{','.join(course.legs)}]"


def task(number: int, seed: int) -> Task:
    """Return a flight of the set."""
    generator = Streams(seed, number)("certify.course")
    fastest = float(generator.choice(FASTEST))
    push = str(generator.choice(list(PUSHES)))
    part, accelerometer = str(generator.choice(PRESSURES)), str(generator.choice(ACCELEROMETERS))
    noise = float(generator.choice([0.3, 1.0, 3.0]))
    tare = str(generator.choice(["covered", "open"]))
    elevation = round(float(generator.uniform(-400.0, 4000.0)))
    standard = 15.0 - 6.5e-3 * elevation
    low, high = max(-60.0, COLDEST - standard), min(40.0, WARMEST - standard)
    offset = round(float(generator.uniform(low, high)), 1)
    wind = round(float(generator.uniform(3.0, 8.0)), 1) if number % 2 else 0.0
    away = round(float(generator.uniform(0.0, 360.0)))
    overrides = [
        "plant.kind=flight-path",
        f"plant.flight_path.push={push}",
        f"plant.flight_path.burn={generator.uniform(0.8, 2.5 if fastest > 100.0 else 1.0):.2f}",
        f"plant.flight_path.legs={drawn_course(generator, fastest)}",
        *PUSHES[push],
        f"duration={DURATION:g}",
        f"accelerometer.preset={accelerometer}",
        f"accelerometer.noise_scale={noise:g}",
        *(f"air_data.{p}.{k}={v}" for p in ("total", "static") for k, v in (("preset", part), ("noise_scale", noise))),
        f"air_data.tare={tare}",
        f"environment.ground_elevation={elevation}",
        f"environment.temperature_offset={offset:g}",
        "expect=completed",
        "requirements=[]",
    ]
    if wind:
        overrides += [f"environment.wind_speed={wind:g}", f"environment.wind_from_deg={away}"]
        overrides += [f"environment.turbulence_wind_20ft={wind:g}"]
    levels = {"push": push, "fastest": fastest, "accelerometer": accelerometer, "pressure": part, "tare": tare}
    levels |= {"noise": f"{noise:g}", "wind": "turbulent" if wind else "still", "elevation": elevation}
    return Task(number, "catapult", tuple(overrides), seed, levels, rule=beyond)


def beyond(flight: Flight) -> Row:
    """Say whether a pressure of the course is beyond its sensor's range: then a flag that says so is right."""
    known, truth = known_of_head(Scenario.from_dict(flight.scenario).air_data), flight.truth
    return {
        "beyond": any(
            bool((truth[f"p_{port}"] > knowledge.high).any() or (truth[f"p_{port}"] < knowledge.low).any())
            for port, knowledge in (("total", known.total), ("static", known.static))
        )
    }


def _true(row: Row) -> bool:
    """Whether what is flagged is so: a sensor at the end of its range."""
    return bool(row.get("beyond")) and row["flag_kind"] == "range" and int(row["flags"]) == 1


def tasks(seed: int, count: int | None = None) -> list[Task]:
    """Return the set, or its first flights."""
    return [task(number, seed) for number in range(SIZE if count is None else min(count, SIZE))]


def judge(rows: Sequence[Row], seed: int, before: dict[str, Any] | None = None) -> Verdict:
    """Hold the set against what is asked of it."""
    del before
    flown = [row for row in rows if row["outcome"] != "refused"]
    launched = [row for row in flown if row.get("detections")]
    hours = sum(row["hours"] for row in flown)
    flagged = [row for row in flown if row["flags"] and not _true(row)]
    events = sum(int(row["flags"]) for row in flagged)
    over = [row for row in flown if (row.get("worst_ratio") or 0.0) > 6.0]
    most = max((row["worst_ratio"] for row in flown), default=0.0)
    rate = rate_interval(events, hours)[1] if hours else float("nan")
    share = share_interval(len(flagged), len(flown))[1] if flown else 1.0
    checks = [
        Check("hours flown", f"≥ {HOURS:g} h", f"{hours:.2f} h, refused {len(rows) - len(flown)}",
              hours >= HOURS if len(rows) == SIZE else None),
        Check("launch recognised", f"{len(flown)}", f"{len(launched)}", len(launched) == len(flown)),
        Check("false flags", "0", f"{events} in {len(flagged)} of {len(flown)} flights; ≤ {rate:.3g} an hour, "
              f"≤ {100 * share:.2f} % a flight", not flagged),
        Check("a valid airspeed off by more than 6 sd", "none", f"{len(over)} flights; greatest {most:.3g}", not over),
    ]  # fmt: skip
    table = [_row(key, level, [row for row in flown if row[key] == level]) for key in
             ("push", "wind", "fastest", "pressure", "accelerometer", "tare", "noise")
             for level in sorted({row[key] for row in flown}, key=str)]  # fmt: skip
    return Verdict(tuple(checks), {"levels": table}, worst(rows, seed))


def _row(key: str, level: Any, some: Sequence[Row]) -> dict[str, Any]:
    counted = sum(row.get("run.rows") or 0 for row in some)
    square, of = sum(row.get("run.square") or 0.0 for row in some), sum(row.get("run.counted") or 0 for row in some)
    return {
        "factor": key,
        "level": level,
        "flights": len(some),
        "hours": sum(row["hours"] for row in some),
        "flags": sum(int(row["flags"]) for row in some),
        "off by 6 sd": sum((row.get("worst_ratio") or 0.0) > 6.0 for row in some),
        "coverage": sum(row.get("run.within") or 0 for row in some) / counted if counted else None,
        "valid": sum(row.get("run.valid") or 0 for row in some) / counted if counted else None,
        "rmse, m/s": float(np.sqrt(square / of)) if of else None,
    }


def worst(rows: Sequence[Row], seed: int) -> list[dict[str, Any]]:
    """Return flights that were refused, flagged, not recognised or far off their bars."""
    found = []
    for row in rows:
        wrong = []
        if row["outcome"] == "refused":
            wrong.append(f"refused: {row['reason']}")
        elif not row.get("detections"):
            wrong.append("not recognised")
        if row.get("flags"):
            wrong.append(f"{row['flag_channel']} {row['flag_kind']} at {row['flag_t']:.2f} s")
        if (row.get("worst_ratio") or 0.0) > 6.0:
            wrong.append(f"{row['worst_ratio']:.1f} sd at {row['worst_ratio_t']:.2f} s")
        if wrong:
            command = task(int(row["number"]), seed).command()
            found.append({"number": row["number"], "push": row["push"], "wrong": "; ".join(wrong), "command": command})
    return found[:SHOWN]
