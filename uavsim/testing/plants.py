"""Conformance of a plant.

| asked | how it is tried |
|---|---|
| clock | step k ends at k over the step rate, the first row is at time 0 |
| force | three numbers after each step, and the same in the truth's columns but for what is felt and not recorded |
| air, flow | pressures above 0, p_t not below p_s, a temperature of air, the same air in both and in the truth |
| truth | every column of `uavsim.truth.UNITS`, a value a step; NaN for what the plant does not have |
| commands | any that a flight computer gives are taken |
| replay | two of them, told the same, give the same truth, bit for bit |
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uavsim.failure import PartError, said
from uavsim.plants.guarded import GuardedPlant
from uavsim.plants.kinds import kind_of
from uavsim.plants.plant import Commands, Plant, Run
from uavsim.plants.settings import EnvironmentSettings, LauncherSettings
from uavsim.testing.invariants import expect as _expect
from uavsim.truth import UNITS

COMMANDS: tuple[Commands, ...] = ((0.0, 0.0, 0.1, 0.0, 0.0), (1.0, 0.7, 0.05, 0.0, 1.0), (1.0, 0.0, -0.05, 0.0, 1.0))
RUN = Run(EnvironmentSettings(), LauncherSettings(), 8.0, release_time=2.0)
"""What it is told here: 8 s at 1 kHz, released at 2 s."""
COLDEST, WARMEST = 150.0, 400.0  # K, between which there is air

Make = Callable[..., Any]
"""Makes a plant: ``make(settings, run)``; a class does."""


def check_plant(make: Make, *, settings: Any = None, run: Run = RUN, seconds: float = 3.0) -> None:
    """Hold a plant to what ours are held to.

    Parameters
    ----------
    make : callable
        A class or function: ``make(settings, run)``.
    settings : object, optional
        Its own; without, its `Settings` as they are by default, None if it has none.
    run : Run
        What it is told.
    seconds : float
        That are flown of it.

    Raises
    ------
    AssertionError
        What is wrong, in a line.
    """
    name = getattr(make, "__name__", "the plant")
    first = _flown(name, make, settings, run, seconds)
    again = _flown(name, make, settings, run, seconds)
    for column, values in first.items():
        same = np.array_equal(values, again[column], equal_nan=True)
        _expect(same, f"{name} flies another flight the second time: the column {column!r} differs")
    other = _flown(name, make, settings, replace(run, step_rate=2.0 * run.step_rate), 0.1)
    _expect(
        other["t"].size == round(0.2 * run.step_rate) + 1,
        f"{name} does not go by the step rate that it is told, {2.0 * run.step_rate:g} Hz",
    )


def _flown(name: str, make: Make, settings: Any, run: Run, seconds: float) -> dict[str, NDArray[np.float64]]:
    """Fly it, look at each step, and return its truth."""
    plant, guarded = _made(name, make, settings, run)
    forces = [guarded.force]
    steps = round(seconds * run.step_rate)
    try:
        for k in range(steps):
            if k % 500 == 250:
                guarded.command(COMMANDS[k // 500 % len(COMMANDS)])
            guarded.step()
            forces.append(guarded.force)
            if not guarded.aloft:
                break
            if k % 50 == 0:
                _look_at_the_air(name, guarded)
        _expect(isinstance(guarded.finite, bool), f"{name}.finite must be True or False")
    except PartError as failure:
        raise AssertionError(str(failure)) from failure
    return _truth(name, plant, guarded, np.array(forces))


def _made(name: str, make: Make, settings: Any, run: Run) -> tuple[Plant, GuardedPlant]:
    try:
        options = kind_of(make, name).options
        plant = make(options() if settings is None and options is not None else settings, run)
        return plant, GuardedPlant(name, plant, run)
    except PartError as failure:
        raise AssertionError(str(failure)) from failure
    except Exception as error:
        raise AssertionError(f"{name} cannot be made by {name}(settings, run): {said(error)}") from error


def _look_at_the_air(name: str, plant: GuardedPlant) -> None:
    total, static, temperature = plant.air(plant.t)
    flow = plant.flow()
    at = f"at {plant.t:.3f} s"
    _expect(static > 0.0, f"{name}.air gives a static pressure of {static:g} Pa {at}")
    _expect(total >= static * (1.0 - 1e-9), f"{name}.air gives p_t = {total:g} below p_s = {static:g} Pa {at}")
    _expect(COLDEST < temperature < WARMEST, f"{name}.air gives {temperature:g} K {at}; that is no air")
    near = np.allclose(flow[:3], (total, static, temperature), rtol=1e-6)
    _expect(near, f"{name}.flow gives the air {flow[:3]} {at}, and air {(total, static, temperature)}")
    _expect(flow[3] >= 0.0, f"{name}.flow gives the Mach number {flow[3]:g} {at}")


def _truth(name: str, plant: Plant, guarded: GuardedPlant, forces: NDArray[np.float64]) -> dict[str, Any]:
    try:
        truth = plant.truth()
    except Exception as error:
        raise AssertionError(f"{name}.truth() raises {said(error)}") from error
    missing = [column for column in UNITS if column not in truth]
    _expect(
        not missing, f"{name}.truth() lacks the column {missing[0] if missing else ''!r}; NaN for what there is none"
    )
    for column in UNITS:
        rows = np.asarray(truth[column]).shape
        _expect(
            rows == (guarded.k + 1,),
            f"{name}.truth() has the shape {rows} in the column {column!r}, after {guarded.k} steps",
        )
    t = np.asarray(truth["t"], float)
    _expect(
        bool(np.allclose(t, np.arange(t.size) / guarded.rate, rtol=0.0, atol=1e-9)),
        f"{name}.truth() has a column t that is not the steps' times",
    )
    felt = np.column_stack([truth[axis] for axis in ("fx", "fy", "fz")])
    away = np.abs(np.median(felt - forces, axis=0)).max() if felt.size else 0.0
    _expect(bool(away < 0.1), f"{name}.force is {away:.2g} m/s² off the truth's fx, fy, fz in the median")
    return {column: np.asarray(truth[column], float) for column in UNITS}
