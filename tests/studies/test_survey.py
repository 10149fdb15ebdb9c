"""Where to mount the head: each flow against its exact solution, and the conclusions that follow.

Exact: the sphere and prolate spheroids (surface speed is the tangential part of a constant vector, Lamb, Hydrodynamics,
§ 105 and 114), the Kármán–Trefftz section, the elliptic wing, the stagnation point at any Mach number. Tolerances are
the discretisations' own errors, measured, with a third to spare.
"""

import csv
import importlib.util
import json
import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import trapezoid

import uavsim
from sensors.probe import recovery, static_port
from uavsim import airdata
from uavsim.scenario import load_scenario
from uavsim.studies.survey import (
    check_envelope,
    choose,
    choose_source,
    envelope_of,
    load_envelope,
    read_outline,
    survey,
)
from uavsim.studies.survey.body import BodyFlow, body_through
from uavsim.studies.survey.compressible import axial_ratio, critical_coefficient, impact_share_of, speed_ratio
from uavsim.studies.survey.edge import edge_speed
from uavsim.studies.survey.flow import AircraftFlow, recovered
from uavsim.studies.survey.lifting_line import LiftingLine
from uavsim.studies.survey.places import places
from uavsim.studies.survey.ranking import airspeed_ratio, probe_polynomial, rank
from uavsim.studies.survey.section import SectionFlow, naca_flow, naca_four_digit
from uavsim.views import survey as view

NEURALFOIL = importlib.util.find_spec("neuralfoil") is not None


# -- body of revolution


def spheroid(ratio, panels=160):
    angle = np.pi * np.arange(panels + 1) / panels
    radius = ratio * np.sin(angle)
    radius[[0, -1]] = 0.0
    return BodyFlow(-np.cos(angle), radius)


def exact_factors(ratio):
    """Speed at the equator in axial and in cross flow over the stream's: 2/(2 − α₀), 2/(2 − β₀)."""
    if ratio == 1.0:
        return 1.5, 1.5
    e = math.sqrt(1.0 - ratio**2)
    alpha = 2.0 * (1.0 - e * e) / e**3 * (math.atanh(e) - e)
    beta = 1.0 / e**2 - (1.0 - e * e) / e**3 * math.atanh(e)
    return 2.0 / (2.0 - alpha), 2.0 / (2.0 - beta)


@pytest.mark.parametrize(
    ("ratio", "axial", "cross"), [(1.0, 0.0022, 0.0022), (0.5, 0.0018, 0.0055), (0.12, 0.0046, 0.027)]
)
def test_body_against_sphere_and_spheroids(ratio, axial, cross):
    """Surface speeds on all 160 panels, both ends included; in the middle the cross flow is within 0.2 %."""
    body = spheroid(ratio)
    along, across = exact_factors(ratio)
    tx, tr = body.tangent
    assert np.max(np.abs(body.axial - along * tx)) < axial
    t, w = body.cross
    assert np.max(np.abs(t - across * tr)) < cross
    assert np.max(np.abs(w - across)) < cross
    assert w[80] == pytest.approx(across, rel=2.5e-3)
    assert body.at(0.0)[0] == pytest.approx(along, rel=5e-3)


def test_body_converges_with_its_panels():
    errors = [abs(spheroid(0.5, n).axial[n // 2] - exact_factors(0.5)[0]) for n in (40, 80, 160)]
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


def test_velocity_off_a_sphere():
    """u = 1 − R³/x³ on the axis ahead, 1 + R³/(2x³) across it: within 0.2 %."""
    along, radial, forward, across = spheroid(1.0).off_axis(-2.0, 0.0)
    assert along == pytest.approx(1.0 - 1.0 / 8.0, rel=2e-3)
    assert across == pytest.approx(1.0 + 0.5 / 8.0, rel=2e-3)
    assert abs(radial) < 1e-5
    assert abs(forward) < 1e-5


def test_a_fuselage_is_closed_and_stands_still_at_its_nose():
    body = body_through([0.0, 0.1, 0.5, 1.0], [0.0, 0.1, 0.12, 0.05])
    assert body.r[0] == body.r[-1] == 0.0
    assert body.at(0.0)[0] == 0.0
    assert body.at(0.4)[0] > 1.0  # its thickest part is passed faster than the stream
    assert np.interp(0.5, body.x, body.r) == pytest.approx(0.06, rel=2e-3)
    with pytest.raises(ValueError, match="closed"):
        BodyFlow(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.1, 1.0, 1.0, 0.0]))


# -- section


def karman_trefftz(panels, alpha):
    """Corners of a cambered section of 10° trailing-edge angle, and the exact speed there."""
    k, centre = 2.0 - math.radians(10.0) / math.pi, complex(-0.08, 0.06)
    radius, beta = abs(1.0 - centre), math.asin(0.06 / abs(1.0 - centre))
    theta = np.linspace(2.0 * np.pi - beta, -beta, panels + 1)  # lower trailing edge … nose … upper trailing edge
    z = centre + radius * np.exp(1j * theta[1:-1])
    high, low = (z + 1.0) ** k, (z - 1.0) ** k
    shape = np.concatenate(([k], k * (high + low) / (high - low), [k]))
    speed = np.exp(-1j * alpha) - radius**2 * np.exp(1j * alpha) / (z - centre) ** 2
    speed += 2j * radius * np.sin(alpha + beta) / (z - centre)
    speed /= 4.0 * k * k * ((z + 1.0) * (z - 1.0)) ** (k - 1.0) / (high - low) ** 2
    front, chord = shape.real.min(), np.ptp(shape.real)
    lift = 8.0 * np.pi * radius / chord * np.sin(alpha + beta)
    return (shape.real - front) / chord, shape.imag / chord, np.abs(speed), lift


@pytest.mark.parametrize("alpha", [-0.05, 0.0, 0.1])
def test_section_against_karman_and_trefftz(alpha):
    """Speed within 0.3 % of the stream's ahead of the last 2 % of chord, lift within 0.1 %."""
    x, y, exact, lift = karman_trefftz(200, alpha)
    flow = SectionFlow(x, y)
    ahead = x[1:-1] < 0.98
    assert np.max(np.abs(np.abs(flow.speed(alpha)[1:-1]) - exact)[ahead]) < 0.003
    assert flow.lift(alpha) == pytest.approx(lift, abs=1e-3)


def test_symmetric_section_is_symmetric():
    flow = naca_flow("naca0012")
    assert flow.zero_lift == pytest.approx(0.0, abs=1e-9)
    assert flow.speed_at(0.0, 0.0) == pytest.approx(0.0, abs=1e-9)
    for place in (0.05, 0.3, 0.9):
        assert flow.speed_at(place, 0.05) == pytest.approx(-flow.speed_at(-place, -0.05), rel=1e-9)


def test_naca_4412_against_thin_aerofoil_theory():
    """Angle of no lift −(1/π)∫z'(cos θ − 1)dθ of the mean line, which thickness moves by 4 %; 2π(1 + 0.77·t/c)."""
    flow = naca_flow("naca4412")
    theta = np.linspace(0.0, np.pi, 4001)
    x = 0.5 * (1.0 - np.cos(theta))
    slope = 0.08 * (0.4 - x) / np.where(x < 0.4, 0.16, 0.36)
    no_lift = -trapezoid(slope * (np.cos(theta) - 1.0), theta) / np.pi
    assert flow.zero_lift == pytest.approx(no_lift, rel=0.04)
    lift_slope = (flow.lift(0.02) - flow.lift(0.0)) / 0.02
    assert lift_slope == pytest.approx(2.0 * math.pi * (1.0 + 0.77 * 0.12), rel=0.03)


def test_far_from_a_section_the_flow_is_that_of_a_vortex():
    """A hundred chords ahead the upwash is Γ/(2πr), Γ = U·c·C_L/2; the vortex is somewhere on the chord: 0.5 %."""
    flow = naca_flow("naca4412")
    _, v = flow.velocity(-100.0, 0.0, 0.0)
    assert v == pytest.approx(0.5 * flow.lift(0.0) / (2.0 * math.pi * 100.5), rel=0.005)


@pytest.mark.parametrize("name", ["clarky", "naca23012", "naca4400", "naca4012", ""])
def test_other_sections_are_refused(name):
    with pytest.raises(ValueError, match="four-digit"):
        naca_four_digit(name)


# -- lifting line


class Elliptic(LiftingLine):
    def chord(self, y):
        return self.root_chord * math.sqrt(max(1.0 - (2.0 * y / self.span) ** 2, 0.0))


def test_elliptic_wing():
    """Downwash the same along the span, C_L/(π·AR), and a slope of a/(1 + a/(π·AR))."""
    wing = Elliptic(8.0, 1.0, 1.0, 2.0 * math.pi, 0.0)
    aspect = 8.0**2 / (math.pi * 0.25 * 8.0 * 1.0)
    slope = 2.0 * math.pi / (1.0 + 2.0 / aspect)
    for y in (0.0, 1.0, 3.0):
        assert wing.downwash_slope(y) == pytest.approx(slope / (math.pi * aspect), rel=1e-9)
    assert wing.section_angle(1.0, 0.1) == pytest.approx(0.1 * slope / (2.0 * math.pi), rel=1e-9)


def test_the_downwash_far_behind_is_twice_that_at_the_wing():
    wing = Elliptic(8.0, 1.0, 1.0, 2.0 * math.pi, 0.0)
    assert wing.induced(200.0, 0.0, 0.0, 0.1)[1] == pytest.approx(-2.0 * 0.1 * wing.downwash_slope(0.0), rel=0.02)
    assert wing.induced(-1.0, 0.0, 0.0, 0.1)[1] > 0.0  # upwash ahead
    above, below = (wing.induced(0.0, 0.0, z, 0.1)[0] for z in (0.5, -0.5))
    assert above == pytest.approx(-below, rel=1e-12)
    assert above > 0.0


# -- compressibility


@pytest.mark.parametrize("mach", [0.0, 0.1, 0.6, 0.8])
def test_stagnation_reads_all_of_the_impact_pressure(mach):
    assert impact_share_of(0.0, mach) == pytest.approx(1.0, rel=1e-12)
    assert impact_share_of(1.0, mach) == pytest.approx(0.0, abs=1e-12)
    assert speed_ratio(0.0, mach) == 0.0
    assert speed_ratio(1.0, mach) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("mach", [0.3, 0.6, 0.8])
def test_small_disturbances_follow_prandtl_and_glauert(mach):
    """Cp/β of a section and, along a body, Göthert's disturbance over β²; linear to 1e-3 of the disturbance's size."""
    beta = math.sqrt(1.0 - mach * mach)
    assert (speed_ratio(1.001, mach) - 1.0) / 0.001 == pytest.approx(1.0 / beta, rel=5e-3)
    cp = impact_share_of(speed_ratio(1.001, mach) ** 2, mach) * airdata.impact_over_dynamic(mach)
    assert cp / -0.002001 == pytest.approx(1.0 / beta, rel=5e-3)
    assert axial_ratio(1.001, 1.0007, mach) - 1.0 == pytest.approx(0.0007 / beta**2, rel=1e-9)
    assert axial_ratio(0.0, 0.0, mach) == 0.0


def test_critical_pressure_coefficient():
    """NACA 1135 and textbooks: Cp* = −1.29 at Mach 0.6, −0.78 at 0.7; there the isentropic flow is at Mach 1."""
    assert critical_coefficient(0.6) == pytest.approx(-1.29, abs=0.006)
    assert critical_coefficient(0.7) == pytest.approx(-0.78, abs=0.006)
    pressure = 1e5 * (1.0 + critical_coefficient(0.6) * 0.7 * 0.36)
    total = airdata.total_pressure(static=1e5, mach=0.6)
    assert airdata.mach(total=total, static=pressure) == pytest.approx(1.0, rel=1e-9)


def test_airspeed_follows_from_the_share_by_air_data():
    mach, share = np.array([0.05, 0.1, 0.6]), np.array([0.9, 1.02, 0.5])
    total = airdata.total_pressure(static=1e5, mach=mach)
    read = airdata.mach(total=1e5 + share * (total - 1e5), static=1e5)
    np.testing.assert_allclose(airspeed_ratio(share, mach) * mach, read, rtol=1e-12)
    assert airspeed_ratio(np.array([-0.1]), np.array([0.1]))[0] == 0.0


def test_tubes_lose_what_the_probe_model_says():
    for angle in np.radians([0.0, 9.0, 15.0, 20.0, 40.0, -25.0]):
        assert recovered(np.array(angle)) == pytest.approx(recovery(abs(float(angle)), math.radians(20.0)), rel=1e-12)


# -- the aircraft


@cache
def flown():
    return uavsim.fly("catapult", seed=1, overrides=["duration=12"])


@cache
def surveyed():
    return survey(read_outline("fw8"), envelope_of([flown().truth], ["catapult"]), "panels")


ZERO = np.array(0.0)


def test_pressures_are_those_of_a_stream_about_the_aircraft():
    """Far from its limits: nose 1, a ring of holes sees no sign of β, right and left are mirrored, upper is sucked."""
    flow = AircraftFlow(read_outline("fw8"))
    mach = np.array(0.1)
    assert flow.hole_on_body(0.0, 0.0)(ZERO, ZERO, mach) == pytest.approx(1.0, abs=1e-3)  # wing's upwash
    right, left = flow.hole_on_body(0.3, 0.5 * np.pi), flow.hole_on_body(0.3, 1.5 * np.pi)
    angle = np.array(0.1)
    assert right(ZERO, angle, mach) == pytest.approx(left(ZERO, -angle, mach), rel=1e-9)
    assert right(ZERO, angle, mach) > left(ZERO, angle, mach) + 0.02  # windward
    top, bottom = flow.hole_on_body(0.03, 0.0), flow.hole_on_body(0.03, np.pi)
    assert bottom(angle, ZERO, mach) > top(angle, ZERO, mach) + 0.1
    wing = flow.outline.wing
    upper, lower = (flow.hole_on_section(wing, 0.5, x, flow.wing_angle(0.5)) for x in (0.3, -0.3))
    assert upper(angle, ZERO, mach) < -0.5 < lower(angle, ZERO, mach)


def test_a_folded_wing_induces_nothing():
    """With the wing folded a body of revolution reads alike on top and bottom at no angle; with it out it does not."""
    bottom, top = (
        next(p for p in places(AircraftFlow(read_outline("fw8"))) if p.name == f"fuselage at 300 mm, {side}")
        for side in ("bottom", "top")
    )
    at = (ZERO, ZERO, np.array(0.1))
    assert bottom.share(*at, False) == pytest.approx(top.share(*at, False), rel=1e-9)
    assert bottom.share(*at) > top.share(*at) + 0.01
    mixed = top.share(np.zeros(2), np.zeros(2), np.full(2, 0.1), np.array([True, False]))
    assert mixed.tolist() == pytest.approx([float(top.share(*at)), float(top.share(*at, False))], rel=1e-12)


def test_booms_ahead_of_a_fuselage_read_what_flight_tests_found():
    """Static error 1 diameter ahead of a nose +0.03…+0.05, 1.5 diameters +0.02: typical figures handed down, ±0.01."""
    boom = {p.name: p for p in places(AircraftFlow(read_outline("fw8")))}
    shares = [float(boom[f"nose, boom {n} diameters ahead"].share(ZERO, ZERO, np.array(0.1))) for n in ("1", "1.5")]
    assert 0.03 - 0.01 < shares[0] < 0.05 + 0.01
    assert shares[1] == pytest.approx(0.02, abs=0.01)


def test_the_envelope_is_that_of_the_flight():
    e = envelope_of([flown().truth], ["catapult"])
    truth = flown().truth
    scored = truth[truth["phase"].astype(str).isin(["stroke", "transition", "cruise"]) & (truth["airspeed"] >= 8.0)]
    assert e.range("alpha")[0] >= scored["alpha"].min()
    assert e.range("mach")[1] == pytest.approx(scored["mach"].max(), rel=1e-3)
    assert e.weight.sum() == pytest.approx(1.0, rel=1e-12)
    for name in ("stroke", "transition", "cruise"):
        assert e.weight[e.phase == name].sum() == pytest.approx(1.0 / 3.0, rel=1e-12)
    assert not e.wing_out[e.phase == "stroke"].any()


def test_ranking_and_named_places():
    """A tube at the nose and a boom ahead of it are always in the stream; in the stroke a folding wing is not."""
    found = surveyed()
    total, static = choose(found.total), choose(found.static)
    assert total.place.name == "nose, tube"
    assert static.place.name == "nose, boom 1.5 diameters ahead"
    assert choose(found.total, "hole").place.name == "nose, hole at the tip"
    for ranks in (found.total, found.static):
        assert all(a.constant <= b.constant for a, b in pairwise(ranks))
        assert all(each.angles <= each.constant + 1e-3 or each.place.kind == "tube" for each in ranks)
        assert all(each.available < 0.7 for each in ranks if each.place.part == "wing")
    raw = {each.place.name: each.raw for each in found.total}
    assert raw["nose, tube"] < raw["nose, hole at the tip"] < raw["wing at 50 % of span, leading edge"]


def test_the_error_of_a_place_is_that_of_flying_with_it():
    """A head that reads by the same share, put through airdata on the envelope's rows, has the rank's rms error."""
    found = surveyed()
    e, each = found.envelope, choose(found.static)
    total = airdata.total_pressure(static=e.static, mach=e.mach)
    head = total - e.static
    read = e.static + head * each.place.share(e.alpha, e.beta, e.mach, e.wing_out)
    number = airdata.mach(total=total - read + e.static, static=e.static)
    error = e.airspeed * (number / e.mach - 1.0)
    assert math.sqrt(np.sum(e.weight * error**2)) == pytest.approx(each.raw, rel=1e-9)
    # raw error of a small share c: −c/2 of the airspeed
    assert each.raw == pytest.approx(0.5 * abs(each.mean) * math.sqrt(np.sum(e.weight * e.airspeed**2)), rel=0.05)


def test_the_probe_model_reads_the_position_error():
    """The scenario that is written gives the port the share of the flow, to the polynomial's stated difference."""
    found = surveyed()
    scenario = view.position_error(found)["air_data"]
    settings = load_scenario("catapult").air_data.static_port
    from dataclasses import replace

    port = static_port(replace(settings, **scenario["static_port"]))
    assert port is not None
    place = choose(found.static).place
    assert found.polynomial_error < 0.002
    for alpha, beta, mach in ((0.0, 0.0, 0.08), (0.05, -0.04, 0.09), (-0.03, 0.05, 0.05)):
        total = airdata.total_pressure(static=1e5, mach=mach)
        read = (port(total, 1e5, mach, alpha, beta, 0.0) - 1e5) / (total - 1e5)
        expected = float(place.share(np.array(alpha), np.array(beta), np.array(mach)))
        assert read == pytest.approx(expected, abs=found.polynomial_error + 1e-9)


def test_the_published_case_on_this_aircraft():
    """Front and leading edges are highest, at nearly the stagnation Cp of 1.093; the rest is not of one pressure."""
    case = surveyed().paper
    assert case["p_total"] == pytest.approx(129_240.4, abs=0.1)
    assert case["front_and_leading_edge_highest"] is True
    stagnation = airdata.impact_over_dynamic(0.6)
    assert all(1.0 < each["cp"] <= stagnation + 1e-9 for each in case["front"].values())
    assert case["front"]["nose, hole at the tip"]["cp"] == pytest.approx(stagnation, rel=5e-3)
    low, high = case["elsewhere"]["cp"]
    assert low < -0.8
    assert high < 0.3
    assert max(case["trailing_edge"]["cp"]) < 0.3
    middle = [each["cp"] for each in case["off_the_middle_of_the_front"]]
    assert middle[0] == max(middle) == pytest.approx(stagnation, rel=1e-3)
    assert middle[1] < 0.5 * middle[0]


@pytest.mark.skipif(not NEURALFOIL, reason="NeuralFoil is an extra: pip install 'uavsim[survey]'")
def test_neuralfoil_agrees_with_the_panels():
    """0 to 6°, 5 to 75 % of chord: within 6 % of the stream, what a boundary layer at Re 3.6e5 takes."""
    alphas = np.radians([0.0, 2.0, 4.0, 6.0])
    for place in (0.05, 0.15, 0.3, 0.5, 0.75, -0.05, -0.15, -0.3, -0.5, -0.75):
        ours, theirs = (edge_speed("naca4412", place, source, 3.6e5)(alphas) for source in ("panels", "neuralfoil"))
        assert np.max(np.abs(theirs - ours)) < 0.06


@pytest.mark.skipif(not NEURALFOIL, reason="NeuralFoil is an extra: pip install 'uavsim[survey]'")
def test_neuralfoil_names_the_same_places():
    found = survey(read_outline("fw8"), surveyed().envelope, "auto")
    assert found.source == "neuralfoil"
    assert found.cross_check is not None
    for ranks, others in ((found.total, surveyed().total), (found.static, surveyed().static)):
        assert choose(ranks).place.name == choose(others).place.name
        assert choose(ranks).raw == pytest.approx(choose(others).raw, rel=1e-6)


def test_without_neuralfoil_panels_serve_and_asking_for_it_is_an_error(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "neuralfoil", None)
    monkeypatch.setitem(sys.modules, "aerosandbox", None)
    assert choose_source("auto") == "panels"
    assert choose_source("panels") == "panels"
    with pytest.raises(ValueError, match=r"pip install 'uavsim\[survey\]'"):
        choose_source("neuralfoil")


def test_what_is_written(tmp_path):
    found = surveyed()
    folder = tmp_path
    view.save(found, folder, plots=True)
    names = {"survey.json", "survey.csv", "position_error.toml", "position_error.csv", "map.png", "pressures.png"}
    assert {path.name for path in folder.iterdir()} == names
    data = json.loads((folder / "survey.json").read_text(encoding="utf-8"))
    assert data["named"]["static"]["place"] == choose(found.static).place.name
    assert data["section_speed"] == "panels"
    with (folder / "survey.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(found.total) + len(found.static)
    assert float(rows[0]["rms_calibrated"]) == found.total[0].constant
    raw = [float(row["rms_raw"]) for row in sorted(rows[-len(found.static) :], key=lambda row: int(row["rank_raw"]))]
    assert raw == sorted(raw)
    scenario = load_scenario(str(folder / "position_error.toml"))
    assert scenario.air_data.static_port.error == found.polynomial.terms[0][0]
    assert scenario.air_data.total_port.probe == "plain"
    assert (folder / "map.png").stat().st_size > 20_000


def test_a_flight_with_the_named_port_errs_as_the_survey_says(tmp_path):
    """`position_error.toml` flown with ideal sensors: the raw airspeed of the cruise is off by −c_s/2, to 0.05 m/s."""
    found = surveyed()
    view.save(found, tmp_path, plots=False)
    quiet = [f"air_data.{port}.{key}" for port in ("total", "static") for key in ('unit="ideal"', "noise_scale=0")]
    quiet.append('air_data.calibration="none"')  # else it is corrected
    flight = uavsim.fly(str(tmp_path / "position_error.toml"), seed=1, overrides=["duration=12", *quiet])
    truth, estimate = flight.truth, flight.estimate
    cruise = estimate[estimate["t"] > flight.score["flight"]["wing_out_time"] + 2.5]
    t = cruise["t"].to_numpy()
    true, alpha, beta, mach = (np.interp(t, truth["t"], truth[key]) for key in ("airspeed", "alpha", "beta", "mach"))
    share = choose(found.static).place.share(alpha, beta, mach)
    expected = true * (airspeed_ratio(1.0 - share, mach) - 1.0)
    error = cruise["airspeed_raw"].to_numpy() - true
    assert np.mean(expected) < -0.3
    assert np.mean(error) == pytest.approx(np.mean(expected), abs=0.05)


def test_the_table_holds_the_shares(tmp_path):
    found = surveyed()
    view.save(found, tmp_path, plots=False)
    with (tmp_path / "position_error.csv").open(encoding="utf-8", newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    mach, alpha, beta = (tuple(sorted({row[name] for row in rows})) for name in ("mach", "alpha", "beta"))
    held = {(row["mach"], row["alpha"], row["beta"]): row["static_share"] for row in rows}
    table = airdata.Table(
        mach, alpha, beta, tuple(tuple(tuple(held[m, a, b] for b in beta) for a in alpha) for m in mach)
    )
    share = float(choose(found.static).place.share(np.array(0.01), np.array(0.01), np.array(0.09)))
    assert table(0.09, 0.01, 0.01) == pytest.approx(share, abs=1e-3)


def test_flights_on_disk_give_the_same_envelope(tmp_path):
    flown().save(tmp_path / "one")
    flown().save(tmp_path / "campaign" / "flights" / "1")
    expected = envelope_of([flown().truth], ["catapult"])
    for folder in ("one", "campaign"):
        found = load_envelope([tmp_path / folder])
        np.testing.assert_allclose(found.alpha, expected.alpha, rtol=0.0, atol=0.0)
        np.testing.assert_allclose(found.weight, expected.weight, rtol=0.0, atol=0.0)


def test_wrong_envelopes_are_refused(tmp_path):
    truth = flown().truth
    with pytest.raises(ValueError, match="no column alpha"):
        envelope_of([truth.drop(columns=["alpha"])], ["x"])
    with pytest.raises(ValueError, match="no scored phase at 8 m/s"):
        envelope_of([truth[truth["airspeed"] < 1.0]], ["x"])
    with pytest.raises(ValueError, match="not a flight's folder"):
        load_envelope([tmp_path])
    with pytest.raises(ValueError, match=r"reach Mach 0\.95"):
        check_envelope(envelope_of([truth.assign(mach=0.95)], ["x"]))


def test_a_place_that_is_never_in_the_stream_is_not_ranked():
    truth = flown().truth
    e = envelope_of([truth[truth["phase"].astype(str) == "stroke"]], ["x"])
    wing = next(p for p in surveyed().places if p.part == "wing")
    assert rank(wing, wing.roles[0], e) is None


def test_the_polynomial_says_how_well_it_fits():
    found = surveyed()
    far = next(p for p in found.places if p.name.endswith("upper side at 5 % of chord"))
    assert probe_polynomial(far, found.envelope)[1] > 10.0 * found.polynomial_error
