"""Where an error would lie to the user, and the tests that are run against one there, the quickest killers first.

Files that move are renamed here; one that is missing is an error that says so.
"""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

FLIGHTS = "tests/test_golden_flights.py"
STRATA: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "score": (
        ("uavsim/score.py", "uavsim/judged.py", "uavsim/criteria.py", "uavsim/misleading.py"),
        ("tests/test_score.py", FLIGHTS),
    ),
    "cosim": (
        ("uavsim/cosim.py", "uavsim/beliefs.py"),
        (
            FLIGHTS,
            "tests/test_beliefs.py",
            "tests/test_cosim.py::test_the_same_seed_is_the_same_flight_twice_in_one_process",
            "tests/test_cosim.py::test_replay_of_its_own_readings_gives_the_flight",
            "tests/test_cosim.py::test_replay_needs_no_truth",
            "tests/test_cosim.py::test_replay_of_a_flight_that_was_ended_says_how_it_ended",
            "tests/test_cosim.py::test_replay_hands_on_the_readings_in_the_order_of_the_flight",
            "tests/test_cosim.py::test_readings_reach_onboard_in_the_order_of_their_time_stamps",
            "tests/test_cosim.py::test_commands_act_after_the_reading_that_caused_them",
            "tests/test_cosim.py::test_a_diverged_flight_is_a_result_with_what_was_flown",
            "tests/test_cosim.py::test_a_vibration_that_is_alike_in_all_phases_does_not_notice_the_rails_end",
        ),
    ),
    "flight computer": (
        ("uavsim/onboard/flight_computer.py", "uavsim/onboard/stroke.py"),
        ("tests/onboard/test_flight_computer.py", "tests/onboard/test_stroke.py", FLIGHTS),
    ),
    "watch": (
        tuple(
            f"uavsim/onboard/airspeed/{name}.py" for name in ("watch", "climb", "ports", "frozen", "monitor", "leak")
        ),
        (
            FLIGHTS,
            *(f"tests/onboard/test_{name}.py" for name in ("aided_equations", "airspeed_rooms", "airspeed_monitor")),
            "tests/onboard/test_airspeed_leak.py",
        ),
    ),
    "aided filter": (
        tuple(
            f"uavsim/onboard/airspeed/{name}.py"
            for name in (
                *("aided", "hand_over", "admission", "progress", "corrections", "told", "launch_checks", "port_errors"),
                *("onset", "unfolding", "air", "offset"),
            )
        ),
        (
            FLIGHTS,
            *(f"tests/onboard/test_{name}.py" for name in ("aided_equations", "airspeed_rooms", "airspeed_aided")),
            "tests/onboard/test_airspeed_offset.py",
            "tests/onboard/test_nothing_raises.py::test_clocks_that_disagree_leave_the_pressures_alone",
        ),
    ),
    "energy model": (
        ("uavsim/onboard/airspeed/energy.py", "uavsim/onboard/airspeed/energy_model.py"),
        ("tests/onboard/test_airspeed_energy.py", "tests/onboard/test_airspeed_model.py", FLIGHTS),
    ),
    "rail": (("uavsim/plants/rail.py",), ("tests/plants/test_rail.py", FLIGHTS)),
    "plant": (
        ("uavsim/plants/jsbsim.py",),
        (
            FLIGHTS,
            "tests/plants/test_launch_physics.py",
            "tests/studies/test_bench.py::test_a_step_that_records_nothing_flies_the_same",
            "tests/plants/test_airframe.py::test_a_function_that_fails_at_the_start_is_a_line",
            "tests/plants/test_airframe.py::test_a_function_that_fails_in_the_air_ends_the_flight_with_a_reason",
        ),
    ),
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
        (
            "tests/studies/test_detections.py",
            *(f"tests/onboard/test_launch{name}.py" for name in ("", "_time", "_rivals", "_field", "_adaptive_cusum")),
        ),
    ),
}
