"""What the plant needs of an aircraft, and an aircraft that goes without a wing to fold or without a stabiliser.

Authority: the contract ("Times and phases"): a fixed wing is 1 throughout, its transition ends 2 s after the rail, and
a motor that is on there is a false launch.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import hostile_aircraft as hostile
import numpy as np
import pytest

import uavsim
from uavsim.criteria import outcome, reason
from uavsim.flight import Flight
from uavsim.judged import STROKE_LEAD, TRANSITION, Judged
from uavsim.plants.hangar import find_airframe
from uavsim.plants.interface import NEEDED, PARTS, interface_of, problems
from uavsim.scenario import load_scenario

EVERY = dict.fromkeys((*NEEDED, *(name for names in PARTS.values() for name in names)), "RW")
FIXED = {b"fcs/wing-cmd-norm": b"own/wing-cmd-norm", b"fcs/wing-pos-norm": b"own/wing-pos-norm"}
OUT = {
    b'<property value="0">' + name: b'<property value="1">' + name
    for name in (b"own/wing-cmd-norm", b"own/wing-pos-norm", b"wing/phase")
}


def without(*names: str) -> dict[str, str]:
    return {name: access for name, access in EVERY.items() if name not in names}


def test_all_that_is_missing_is_named_at_once() -> None:
    gone = [
        "external_reactions/push/magnitude",
        "external_reactions/rear-shoe-normal/location-x-in",
        "fcs/throttle-cmd-norm",
    ]
    (told,) = problems(without(*gone), ())
    assert all(repr(name) in told for name in gone)


def test_a_part_is_there_as_a_whole_or_not_at_all() -> None:
    assert problems(without(*PARTS["wing"], *PARTS["stabiliser"]), ()) == []
    told = problems(without("fcs/wing-pos-norm", "ap/engaged"), ())
    assert told == [
        "it has 'fcs/wing-cmd-norm' and so a wing, which lacks the property 'fcs/wing-pos-norm'",
        "it has 'ap/pitch-cmd-rad' and so a stabiliser, which lacks the property 'ap/engaged'",
    ]
    assert not interface_of(without(*PARTS["wing"])).folds


def test_what_cannot_be_set_or_is_a_function_is_named() -> None:
    told = problems(EVERY | {"ap/engaged": "R"}, {"fcs/wing-pos-norm"})
    assert [clause.split(" ")[0] for clause in told] == ["'fcs/wing-pos-norm'", "'ap/engaged'"]


def test_an_aircraft_without_anything_is_told_in_one_line(tmp_path: Path) -> None:
    good = hostile.packaged()
    main = good["fw8.xml"]
    for part in (b"external_reactions", b"propulsion"):
        start, end = main.index(b"<" + part + b">"), main.index(b"</" + part + b">")
        main = main[:start] + main[end + len(part) + 3 :]
    folder = hostile.write(good | {"fw8.xml": main}, tmp_path / "fw8")
    with pytest.raises(ValueError, match=r"it lacks the properties") as caught:
        uavsim.fly("catapult", overrides=[f"aircraft.model={folder}"])
    (line,) = str(caught.value).splitlines()
    assert "'fcs/throttle-cmd-norm'" in line
    assert "'external_reactions/push/magnitude'" in line
    assert "'external_reactions/rail-roll/magnitude-lbsft'" in line


@cache
def fixed() -> Flight:
    """The packaged aircraft with a wing that stands out, of which nobody is told, and no stabiliser that hears."""
    files = hostile.packaged()
    for old, new in FIXED.items():
        files = {path: content.replace(old, new) for path, content in files.items()}
    for old, new in OUT.items():
        files["systems/wing.xml"] = files["systems/wing.xml"].replace(old, new)
    folder = hostile.write(files, Path(mkdtemp()) / "fw8")
    return uavsim.fly("catapult", overrides=[f"aircraft.model={folder}"])


def test_a_fixed_wing_is_out_throughout_and_reaches_cruise() -> None:
    flight = fixed()
    score = flight.score["flight"]
    assert flight.score["outcome"] == "cruise"
    assert (score["wing_start_time"], score["wing_out_time"]) == (None, None)
    assert (flight.truth["wing"] == 1.0).all()
    rows = flight.truth[flight.truth["phase"] == "transition"]["t"].to_numpy()
    assert rows[0] == pytest.approx(score["rail_exit_time"], abs=1e-3)
    assert rows[-1] == pytest.approx(score["rail_exit_time"] + TRANSITION, abs=2e-3)
    assert flight.score["launch"]["true_time"] + STROKE_LEAD < rows[0]


def test_a_motor_on_the_rail_is_a_false_launch_of_a_fixed_wing() -> None:
    flight = fixed()
    early = [{"t": 1.0, "event": "wings_commanded"}, {"t": 1.1, "event": "motor_on"}]
    judged = Judged(
        load_scenario("catapult"),
        {"truth": flight.truth, "estimate": flight.estimate, "air_data": flight.air_data},
        [*early[:1], *flight.events],
        flight.score["launch"]["release_time"],
        "completed",
        {},
    )
    assert outcome(judged) == "cruise"  # a command for wings that it has not
    judged = replace(judged, events=[*early, *flight.events])
    assert outcome(judged) == "false_launch"
    assert str(reason(judged, "false_launch")).startswith("motor running on the rail: at 1.100 s")
    folds = flight.truth.assign(wing=np.where(flight.truth["t"] < 4.0, 0.0, 1.0))
    assert not replace(judged, tables={**judged.tables, "truth": folds}).is_fixed_wing


def test_impossible_masses_and_missing_files_are_named_at_once(tmp_path: Path) -> None:
    good = hostile.packaged()
    main = good["fw8.xml"].replace(b'<emptywt unit="KG">6.96', b'<emptywt unit="KG">-6.96')
    main = main.replace(b'<wingspan unit="M">1.8', b'<wingspan unit="M">0').replace(b">0.02112331<", b">0<")
    folder = hostile.write(good | {"fw8.xml": main}, tmp_path / "fw8")
    with pytest.raises(ValueError, match=r"<wingspan>: is 0 m.*<emptywt>: is -6.96 kg.*<ixx>: is 0 kg m²"):
        find_airframe(str(folder))
    for name in ("wing", "stabiliser"):
        (folder / "systems" / f"{name}.xml").unlink()
    (folder / "fw8.xml").write_bytes(good["fw8.xml"])
    with pytest.raises(ValueError, match=r"'wing\.xml' is not in .*'stabiliser\.xml' is not in"):
        find_airframe(str(folder))
