"""Where an error would lie to the user, and the tests that are run against one there, the quickest killers first.

Files that move are renamed here; one that is missing is an error that says so.
"""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

FLIGHTS = "tests/test_golden_flights.py"
STRATA: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "score": (("uavsim/score.py",), ("tests/test_score.py", FLIGHTS)),
    "cosim": (
        ("uavsim/cosim.py", "uavsim/beliefs.py"),
        (FLIGHTS, "tests/test_beliefs.py", "tests/test_mismatch.py", "tests/test_cosim.py"),
    ),
    "flight computer": (
        ("uavsim/onboard/flight_computer.py",),
        ("tests/onboard/test_flight_computer.py", FLIGHTS),
    ),
    "watch": (
        ("uavsim/onboard/airspeed/watch.py", "uavsim/onboard/airspeed/climb.py"),
        (FLIGHTS, "tests/onboard/test_aided_equations.py", "tests/onboard/test_airspeed_monitor.py"),
    ),
    "aided filter": (
        ("uavsim/onboard/airspeed/aided.py",),
        (FLIGHTS, "tests/onboard/test_aided_equations.py", "tests/onboard/test_airspeed_aided.py"),
    ),
    "energy model": (
        ("uavsim/onboard/airspeed/energy.py", "uavsim/onboard/airspeed/energy_model.py"),
        ("tests/onboard/test_airspeed_energy.py", "tests/onboard/test_airspeed_model.py", FLIGHTS),
    ),
    "rail": (("uavsim/plants/rail.py",), ("tests/plants/test_rail.py", FLIGHTS)),
    "plant": (("uavsim/plants/jsbsim.py",), (FLIGHTS, "tests/plants/test_launch_physics.py")),
    "accelerometer": (
        ("sensors/accelerometer.py",),
        (FLIGHTS, "tests/sensors/test_sensors_accelerometer.py"),
    ),
    "pressure": (("sensors/pressure.py",), (FLIGHTS, "tests/sensors/test_sensors_pressure.py")),
    "pneumatics": (("sensors/pneumatics.py",), ("tests/sensors/test_sensors_pneumatics.py", FLIGHTS)),
    "clocks": (("sensors/clock.py",), ("tests/sensors/test_sensors_clock.py", FLIGHTS)),
    "exact": (("uavsim/studies/exact.py",), ("tests/studies/test_exact.py",)),
    "kernels": (
        tuple(
            f"uavsim/onboard/launch/{name}.py"
            for name in (
                *("nested", "sliding_window", "sequence_window", "hold", "cusum", "adaptive_cusum", "glr"),
                *("px4", "ardupilot", "inav", "paparazzi", "altos", "autopilot"),
            )
        ),
        ("tests/studies/test_detections.py", "tests/onboard/test_launch.py", "tests/onboard/test_launch_time.py"),
    ),
}
