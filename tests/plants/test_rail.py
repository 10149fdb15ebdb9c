"""The rail by itself: what it pushes, holds and lets go, against statics and the profile that its settings describe.

Authority: Newtonian mechanics and Coulomb friction, written out here with numbers of a made-up aircraft of 8 kg.
"""

from dataclasses import replace
from itertools import pairwise
from math import cos, radians, sin
from typing import Any

import numpy as np
import pytest

from uavsim.plants.rail import CREEP_SPEED, FREE, Motion, Rail, RailForces, body_axes, turned
from uavsim.plants.settings import LauncherSettings
from uavsim.truth import STANDARD_GRAVITY

MASS, INERTIA, G = 8.0, 0.05, 9.81
FRONT, REAR = (0.25, 0.0, 0.08), (-0.15, 0.0, 0.08)  # m from the centre of gravity
ELEVATION = 12.5
RELEASE = 2.0
INSTANT = 1e-5  # s, a step over which hardly anything changes
SETTINGS = LauncherSettings(elevation_deg=ELEVATION)
UPRIGHT = (0.0, radians(ELEVATION), 0.0)


def rail(**changes: Any) -> Rail:
    more = {key: changes.pop(key) for key in ("front", "rear", "force_factor", "step") if key in changes}
    known = {"front": FRONT, "rear": REAR, "step": INSTANT, **more}
    return Rail(replace(SETTINGS, **changes), mass=MASS, roll_inertia=INERTIA, gravity=G, release_time=RELEASE, **known)


def at(
    box: Rail,
    time: float,
    way: float = 0.0,
    speed: float = 0.0,
    *,
    side: float = 0.0,
    attitude: tuple[float, float, float] = UPRIGHT,
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> RailForces:
    """Forces with the aircraft `way` along the rail and `side` to the right of it."""
    place = tuple(way * a + side * b for a, b in zip(box.along, box.right, strict=True))
    velocity = tuple(speed * a for a in box.along)
    return box.forces(time, Motion(place, velocity, attitude, rates), (FRONT, REAR))


# -- axes ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("attitude", [(0.0, 0.0, 0.0), UPRIGHT, (0.3, -0.5, 2.0), (-1.0, 1.2, -3.0)])
def test_body_axes_are_a_right_handed_set(attitude: tuple[float, float, float]) -> None:
    x, y, z = body_axes(attitude)
    for a in (x, y, z):
        assert sum(c * c for c in a) == pytest.approx(1.0)
    cross = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    assert cross == pytest.approx(z)


def test_the_rail_points_where_it_was_turned() -> None:
    box = rail(heading_deg=90.0, elevation_deg=30.0)
    assert box.along == pytest.approx((0.0, cos(radians(30.0)), -sin(radians(30.0))), abs=1e-12)
    assert box.right == pytest.approx((-1.0, 0.0, 0.0), abs=1e-12)


# -- at rest ---------------------------------------------------------------------------------------------------------


def test_at_rest_the_latch_and_the_shoes_carry_the_weight() -> None:
    """Along: m g sin; normal: m g cos shared by the lever rule; no moment about the centre of gravity; no friction."""
    box = rail()
    f = at(box, 1.0)
    assert f.axial == pytest.approx(MASS * G * sin(radians(ELEVATION)))
    assert f.front_normal + f.rear_normal == pytest.approx(-MASS * G * cos(radians(ELEVATION)))
    assert FRONT[0] * f.front_normal + REAR[0] * f.rear_normal == pytest.approx(0.0, abs=1e-9)
    assert (f.front_lateral, f.rear_lateral, f.roll_moment) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert (box.push, box.travel, box.active) == (0.0, 0.0, True)


@pytest.mark.parametrize("way", [1e-3, -1e-3])
def test_the_latch_pulls_it_back_from_both_sides(way: float) -> None:
    rest = at(rail(), 1.0).axial
    assert (at(rail(), 1.0, way).axial - rest) * way < 0.0


def test_after_release_the_stop_pushes_but_does_not_pull() -> None:
    """0.1 s after it with no push to speak of: ahead of the stop nothing holds, behind it the stop still pushes."""
    box = rail(peak_specific_force_g=0.1, rise=1.0, friction=0.0)
    assert at(box, RELEASE + 1e-9, 0.1).axial == pytest.approx(0.0, abs=1e-3)
    assert at(box, RELEASE + 1e-9, -1e-3).axial > MASS * G * sin(radians(ELEVATION))


def test_a_slot_holds_to_both_sides() -> None:
    right, left = at(rail(), 1.0, side=1e-3), at(rail(), 1.0, side=-1e-3)
    assert right.front_lateral < 0.0 < left.front_lateral
    assert right.rear_lateral < 0.0 < left.rear_lateral
    assert right.front_lateral == pytest.approx(-left.front_lateral)


def test_a_lateral_force_on_the_shoes_does_not_roll_the_aircraft() -> None:
    """The shoes are below the centre of gravity; the moment -z F_y of their forces is taken by the slot's width."""
    f = at(rail(), 1.0, side=1e-3)
    assert f.front_lateral != 0.0
    assert f.roll_moment - FRONT[2] * f.front_lateral - REAR[2] * f.rear_lateral == pytest.approx(0.0, abs=1e-9)


def test_roll_is_held_and_damped() -> None:
    rolled = (0.02, UPRIGHT[1], 0.0)
    assert at(rail(), 1.0, attitude=rolled).roll_moment < 0.0
    assert at(rail(), 1.0, rates=(0.1, 0.0, 0.0)).roll_moment < 0.0


def test_nose_up_loads_the_shoes_against_it() -> None:
    """Pitching up pushes the front shoe down on the rail's upper lip: the couple of the shoes is nose-down."""
    up = at(rail(), 1.0, attitude=(0.0, UPRIGHT[1] + 0.01, 0.0))
    couple = -(FRONT[0] * up.front_normal + REAR[0] * up.rear_normal)  # N m about y; a normal force is along +z
    assert couple < 0.0


def test_shoes_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(ValueError, match="front launch shoe"):
        rail(front=REAR, rear=FRONT)


@pytest.mark.parametrize(("ahead", "behind"), [(0.3, 0.1), (-0.1, -0.3)])
def test_both_shoes_may_be_on_one_side_of_the_centre_of_gravity(ahead: float, behind: float) -> None:
    """Their order is along x alone; the lever rule then has one of them pull."""
    f = at(rail(front=(ahead, 0.0, 0.08), rear=(behind, 0.0, 0.08)), 1.0)
    assert np.isfinite((f.front_normal, f.rear_normal)).all()
    with pytest.raises(ValueError, match="front launch shoe"):
        rail(front=(behind, 0.0, 0.08), rear=(ahead, 0.0, 0.08))


# -- the push --------------------------------------------------------------------------------------------------------


def test_the_push_rises_stays_and_is_proportional_to_the_draw() -> None:
    box = rail(force_factor=1.02)
    plateau = 8.0 * 1.02 * MASS * STANDARD_GRAVITY
    for since, share in ((-0.5, 0.0), (0.0, 0.0), (0.003, 0.1), (0.015, 0.5), (0.030, 1.0), (0.1, 1.0)):
        at(box, RELEASE + since, 0.1)
        assert box.push == pytest.approx(plateau * share, abs=1e-4 * plateau)


def test_the_push_falls_so_that_it_ends_with_the_stroke() -> None:
    """Integrated here with steps of 0.1 ms on the frictionless rail: 0 within 1 ms of the end of the stroke."""
    box = rail(friction=0.0)
    time, way, speed, step = RELEASE, 0.0, 0.0, 1e-4
    history = []
    while box.active:
        force = at(box, time, way, speed).axial
        history.append((time, box.push))
        speed += (force / MASS - G * sin(radians(ELEVATION))) * step
        way += speed * step
        time += step
        assert time < RELEASE + 1.0
    falling = [(t, push) for t, push in history if t > RELEASE + 0.05 and 0.0 < push < 0.999 * box.machine.peak]
    assert falling[-1][0] - falling[0][0] == pytest.approx(0.060, abs=0.003)
    assert history[-1][0] - falling[-1][0] < 1e-3
    slopes = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(falling)]
    assert slopes == pytest.approx([-box.machine.peak / 0.060] * len(slopes), rel=1e-6)


@pytest.mark.parametrize("elevation", [0.0, 40.0])
def test_the_push_begins_to_fall_where_what_is_left_is_the_way_of_its_fall(elevation: float) -> None:
    """v t_f + (n g₀/3 − g sin θ/2) t_f², the integral of n g₀ (1 − τ/t_f) − g sin θ: to 1 mm, steep and level, slowly.

    At 2 g and a fall of 0.2 s the climb takes 0.13 m off 0.86 m.
    """
    fall, speed, level = 0.2, 3.0, 2.0
    gravity = G * sin(radians(elevation))
    way = speed * fall + (level * STANDARD_GRAVITY / 3.0 - gravity / 2.0) * fall**2
    for before, falls in ((way + 1e-3, False), (way - 1e-3, True)):
        box = rail(elevation_deg=elevation, peak_specific_force_g=level, fall=fall, stroke=10.0)
        level_pitch = (0.0, radians(elevation), 0.0)
        at(box, RELEASE + 0.5, 10.0 - before, speed, attitude=level_pitch)
        at(box, RELEASE + 0.5 + fall / 2.0, 10.0 - before + 0.1, speed, attitude=level_pitch)
        assert box.push == pytest.approx(box.machine.peak * (0.5 if falls else 1.0), rel=1e-4)


def test_a_stroke_without_room_for_its_rise_still_ends() -> None:
    """15 g over 0.6 m: the push begins to fall as soon as it has risen."""
    box = rail(stroke=0.6, peak_specific_force_g=15.0)
    at(box, RELEASE + 0.020, 0.50, 18.0)
    assert box.push == pytest.approx(2.0 / 3.0 * box.machine.peak)
    at(box, RELEASE + 0.031, 0.55, 18.0)
    at(box, RELEASE + 0.061, 0.58, 18.0)
    assert box.push == pytest.approx(0.5 * box.machine.peak, rel=1e-3)


# -- friction --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [CREEP_SPEED, 0.1, 10.0])
def test_friction_is_coulombs(speed: float) -> None:
    """mu times the normal loads, against the motion, independent of speed."""
    rough, smooth = (at(rail(friction=mu), RELEASE + 0.1, 1.0, speed).axial for mu in (0.2, 0.0))
    normal = MASS * G * cos(radians(ELEVATION))
    assert smooth - rough == pytest.approx(0.2 * normal, rel=1e-6)


def test_friction_fades_at_a_creep_and_turns_with_the_motion() -> None:
    def drag(speed: float) -> float:
        return (
            at(rail(friction=0.2), RELEASE + 0.1, 1.0, speed).axial
            - at(rail(friction=0.0), RELEASE + 0.1, 1.0, speed).axial
        )

    assert drag(0.0) == pytest.approx(0.0, abs=1e-9)
    assert drag(0.5 * CREEP_SPEED) == pytest.approx(0.5 * drag(CREEP_SPEED), rel=1e-6)
    assert drag(-1.0) == pytest.approx(-drag(1.0), rel=1e-6)


# -- leaving ---------------------------------------------------------------------------------------------------------


def test_the_front_shoe_leaves_a_base_before_the_rear_one() -> None:
    base = FRONT[0] - REAR[0]
    before = at(rail(), RELEASE + 0.1, SETTINGS.stroke - base - 1e-3, 10.0)
    between = at(rail(), RELEASE + 0.1, SETTINGS.stroke - base + 1e-3, 10.0)
    assert before.front_normal != 0.0
    assert between.front_normal == between.front_lateral == 0.0
    assert between.rear_normal != 0.0


def test_after_the_stroke_nothing_is_left() -> None:
    box = rail()
    at(box, RELEASE + 0.1, SETTINGS.stroke - 1e-3, 10.0)
    assert box.active
    assert at(box, RELEASE + 0.1, SETTINGS.stroke + 1e-3, 10.0) == FREE
    assert (box.active, box.push) == (False, 0.0)


# -- within a step ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("since", [-0.9, -0.4, 0.0, 0.3, 12.0, 29.5, 29.0, 40.0])
def test_the_push_of_a_step_is_its_mean(since: float) -> None:
    """Of min(t/rise, 1) from `since` to `since` + 1 ms after the release, by quadrature at 10 001 points to 1e-7."""
    box = rail(step=1e-3)
    at(box, RELEASE + 1e-3 * (since + 0.5), 0.1)
    t = 1e-3 * np.linspace(since, since + 1.0, 10_001)
    mean = 1e3 * np.trapezoid(np.clip(t / 0.030, 0.0, 1.0), t)
    assert box.push == pytest.approx(box.machine.peak * mean, abs=1e-7 * box.machine.peak)


@pytest.mark.parametrize("begins", [0.1, 0.5, 0.9])
def test_the_push_begins_to_fall_within_a_step(begins: float) -> None:
    """At a share of a step of 2 ms the way that is left is that of the fall: its mean is 1 - (1 - share)² dt/(2 fall).

    To 3e-5: speed and acceleration make a parabola of the way within the step, which the rail takes for straight.
    """
    step, fall, speed = 2e-3, 0.06, 20.0
    box = rail(step=step, fall=fall, stroke=10.0)
    pushed = 8.0 * STANDARD_GRAVITY - G * sin(radians(ELEVATION))
    there = 10.0 - speed * fall - (8.0 * STANDARD_GRAVITY / 3.0 - G * sin(radians(ELEVATION)) / 2.0) * fall**2
    late = (0.5 - begins) * step  # of the step's middle, behind the corner
    middle = there + speed * late + 0.5 * pushed * late**2
    at(box, RELEASE + 0.5, middle, speed + pushed * late)
    assert box.push == pytest.approx(box.machine.peak * (1.0 - (1.0 - begins) ** 2 * step / (2.0 * fall)), rel=3e-5)
    at(box, RELEASE + 0.5 + step, middle + step * speed, speed)
    assert box.push == pytest.approx(box.machine.peak * (1.0 - (1.5 - begins) * step / fall), rel=6e-5)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.8, 1.0])
def test_a_shoe_that_leaves_within_a_step_holds_for_its_share_of_it(share: float) -> None:
    """10 m/s and 4 ms are 40 mm of way; what is left of the rail at the beginning of the step is a share of them."""
    way, base = 0.04, FRONT[0] - REAR[0]
    full = at(rail(step=4e-3), RELEASE + 0.1, 1.0, 10.0, side=1e-3)
    front = at(rail(step=4e-3), RELEASE + 0.1, SETTINGS.stroke - base + (0.5 - share) * way, 10.0, side=1e-3)
    rear = at(rail(step=4e-3, fall=1e-3), RELEASE + 0.1, SETTINGS.stroke + (0.5 - share) * way, 10.0, side=1e-3)
    assert front.front_normal == pytest.approx(share * full.front_normal, rel=1e-9, abs=1e-9)
    assert front.front_lateral == pytest.approx(share * full.front_lateral, rel=1e-9, abs=1e-9)
    assert front.rear_normal == pytest.approx(full.rear_normal)
    assert rear.rear_normal == pytest.approx(share * full.rear_normal, rel=1e-9, abs=1e-9)
    assert rear.front_normal == 0.0


@pytest.mark.parametrize("share", [0.25, 0.8, 1.0])
def test_roll_is_held_as_long_as_a_shoe_is(share: float) -> None:
    """Rolled and turning, with nothing to the side: of the step in which the rear shoe leaves it has its share."""
    way, rolled = 0.04, (0.02, UPRIGHT[1], 0.0)
    full, last = (
        at(rail(step=4e-3), RELEASE + 0.1, where, 10.0, attitude=rolled, rates=(0.1, 0.0, 0.0)).roll_moment
        for where in (1.0, SETTINGS.stroke + (0.5 - share) * way)
    )
    assert full < 0.0
    assert last == pytest.approx(share * full)


def test_the_push_ends_with_the_rail() -> None:
    """Whatever of it is left there: of the last step it has the share before the end."""
    box = rail(step=4e-3, friction=0.0)
    at(box, RELEASE + 0.1, 1.0, 10.0)
    assert box.push == pytest.approx(box.machine.peak)
    at(box, RELEASE + 0.2, SETTINGS.stroke - 0.25 * 0.04, 10.0)  # three quarters of 40 mm are left
    t = np.linspace(0.0, 3e-3, 1001)
    mean = np.trapezoid(1.0 - t / 0.060, t) / 4e-3
    assert box.push == pytest.approx(box.machine.peak * mean, rel=1e-6)


def test_angles_turn_as_a_body_does() -> None:
    """The rotation that the rates give, R' = R [ω]×, against the axes of the turned angles, to second order in time."""
    attitude, rates, time = (0.3, -0.4, 1.1), (0.7, -0.9, 0.5), 1e-5
    before, after = (np.array(body_axes(a)).T for a in (attitude, turned(attitude, rates, time)))
    p, q, r = rates
    cross = np.array([[0.0, -r, q], [r, 0.0, -p], [-q, p, 0.0]])
    assert (after - before) / time == pytest.approx(before @ cross, abs=1e-4)
