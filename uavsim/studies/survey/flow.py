"""What a place on the aircraft reads: its share of the impact pressure, by angle of attack, sideslip and Mach number.

    hole     flush with the surface: (p − p_s)/q_c of the flow along it
    tube     open ahead, pointing forwards: all of q_c but for the flow's angle at its mouth (`sensors.probe`)
    boom     static holes around a thin tube ahead of the aircraft: 1 − |V/U|² of the field there, less sin²θ for the
             flow at an angle θ across the tube (potential flow about a circle, mean of 1 − 4·sin²φ)

Fuselage: flow of `body` in axial and in cross flow, and the velocity that the wing induces there. Wing, tail and fin:
flow of `section` at the angle of attack of `lifting_line`, in the plane across the span, the flow along the span apart
(a simple sweep); the fuselage's own upwash at the wing is α·R²/y², the wing's downwash at the tail that of its
horseshoes. Not in it: viscosity but for NeuralFoil's edge speed, wakes, the propeller, deflected tail halves, the
junction of the wing's panels folded back and on their way out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from sensors.probe import FREE_ANGLE, LIMITS
from uavsim.studies.survey.body import BodyFlow, body_through
from uavsim.studies.survey.compressible import axial_ratio, impact_share_of, speed_ratio
from uavsim.studies.survey.edge import edge_speed
from uavsim.studies.survey.geometry import Outline, Surface
from uavsim.studies.survey.lifting_line import LiftingLine
from uavsim.studies.survey.section import naca_flow

Array = NDArray[np.float64]
Share = Callable[[Array, Array, Array], Array]
"""alpha, beta, rad, Mach number -> (p − p_s)/q_c."""

KINEMATIC_VISCOSITY = 1.46e-5  # m²/s, air of the standard sea level; 300 K and 101 325 Pa have 1.57e-5
MACHS = (0.0, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9)  # where bodies are solved for Göthert's rule
PIPE = 0.05  # m, length of a tube ahead of the surface: the published head's


@dataclass(frozen=True)
class AircraftFlow:
    """Flow about an aircraft with its wing out.

    Attributes
    ----------
    outline : Outline
    source : {"neuralfoil", "panels"}
        What gives the speed along sections.
    most_mach : float
        Largest Mach number that will be asked for, below 0.9.
    speed : float
        Airspeed of the sections' Reynolds numbers, m/s.
    wing_out : bool
        Whether the wing is out and works on the flow elsewhere.
    """

    outline: Outline
    source: str = "panels"
    most_mach: float = 0.3
    speed: float = 30.0
    wing_out: bool = True

    def __post_init__(self) -> None:
        if not 0.0 <= self.most_mach <= MACHS[-1]:
            raise ValueError(f"Mach number: 0 to {MACHS[-1]}, where the rules for compressibility end")

    def body(self, mach: float = 0.0) -> BodyFlow:
        """Flow about the fuselage with radii times √(1 − M²)."""
        return _fuselage(self.outline.stations, self.outline.diameters, mach)

    @cached_property
    def _machs(self) -> tuple[float, ...]:
        count = 1 + sum(mach < self.most_mach for mach in MACHS)
        return MACHS[: min(count, len(MACHS))]

    @cached_property
    def wing_line(self) -> LiftingLine:
        """The wing as a lifting line."""
        return _line(self.outline.wing)

    @cached_property
    def tail_line(self) -> LiftingLine:
        """The tailplane as a lifting line; its two halves are joined."""
        assert self.outline.tail is not None
        return _line(self.outline.tail)

    @cached_property
    def tail_downwash(self) -> float:
        """Of the wing at the tailplane's middle, velocity up per rad of the wing's α − α₀ (negative)."""
        tail = self.outline.tail
        assert tail is not None
        return self._induced(tail.quarter_chord, 0.5 * (tail.root + tail.tip), tail.z)[1]

    def _induced(self, x: float, y: float, z: float) -> tuple[float, float]:
        """Velocity that the wing induces, along x and up, per rad of its α − α₀; none when it is folded."""
        if not self.wing_out:
            return 0.0, 0.0
        return self.wing_line.induced(x, y, z, self.wing_line.zero_lift + 1.0)

    # -- fuselage

    def hole_on_body(self, x: float, azimuth: float) -> Share:
        """Hole in the fuselage at a station, m, and an azimuth from the top to the right, rad."""
        axial, t, w = self.body().at(x)
        thin = np.array([self.body(mach).axial_at(x) for mach in self._machs])
        radius = self.outline.radius(x)
        line = self.wing_line
        gained = self._induced(x, radius * np.sin(azimuth), radius * np.cos(azimuth))[0]
        raised = self._induced(x, 0.0, 0.0)[1]

        def share(alpha: Array, beta: Array, mach: Array) -> Array:
            lift = alpha - line.zero_lift
            along = np.cos(alpha) * np.cos(beta) + gained * lift
            up, right = np.sin(alpha) * np.cos(beta) + raised * lift, -np.sin(beta)
            outwards = up * np.cos(azimuth) + right * np.sin(azimuth)
            around = right * np.cos(azimuth) - up * np.sin(azimuth)
            fast = axial_ratio(axial, np.interp(mach, self._machs, thin), mach)
            square = (along * fast + outwards * t) ** 2 + (around * w) ** 2
            return np.asarray(impact_share_of(square, mach))

        return share

    def tube_at_nose(self) -> Share:
        """Tube on the axis, its mouth a pipe's length ahead of the nose."""
        velocity = self._ahead_of_nose(PIPE)

        def share(alpha: Array, beta: Array, _mach: Array) -> Array:
            along, sideways = velocity(alpha, beta)
            return recovered(np.arctan2(sideways, along))

        return share

    def boom_at_nose(self, distance: float) -> Share:
        """Static holes on a boom, `distance` ahead of the nose, m."""
        velocity = self._ahead_of_nose(distance)

        def share(alpha: Array, beta: Array, mach: Array) -> Array:
            along, sideways = velocity(alpha, beta)
            return np.asarray(impact_share_of(speed_ratio(along, mach) ** 2 + 2.0 * sideways**2, mach))

        return share

    def _ahead_of_nose(self, distance: float) -> Callable[[Array, Array], tuple[Array, Array]]:
        """Velocity on the axis ahead of the nose, along and across it: α, β -> shares of the stream's."""
        x = self.outline.stations[0] - distance
        along, _, _, across = self.body().off_axis(x, 0.0)
        line = self.wing_line
        gained, raised = self._induced(x, 0.0, 0.0)

        def velocity(alpha: Array, beta: Array) -> tuple[Array, Array]:
            lift = alpha - line.zero_lift
            ahead = (np.cos(alpha) * np.cos(beta) + gained * lift) * along
            return ahead, np.hypot(np.sin(alpha) * np.cos(beta) + raised * lift, np.sin(beta)) * across

        return velocity

    # -- wing, tail, fin

    def wing_angle(self, y: float) -> Callable[[Array], Array]:
        """Angle of attack of the wing's section at y: α -> rad."""
        wing, line = self.outline.wing, self.wing_line
        radius = self.outline.radius(wing.quarter_chord)
        upwash = (radius / max(y, radius)) ** 2
        return lambda alpha: np.asarray(line.section_angle(y, alpha, upwash * alpha) + wing.incidence)

    def tail_angle(self, y: float) -> Callable[[Array], Array]:
        """Angle of attack of the tailplane's section at y: α -> rad; the tail halves not deflected."""
        tail = self.outline.tail
        assert tail is not None
        line, wing = self.tail_line, self.wing_line

        def angle(alpha: Array) -> Array:
            local = alpha + self.tail_downwash * (alpha - wing.zero_lift)
            return np.asarray(line.section_angle(y, local) + tail.incidence)

        return angle

    def hole_on_section(self, surface: Surface, y: float, place: float, angle: Callable[[Array], Array]) -> Share:
        """Hole in a wing or tailplane at x/c = `place`, above 0 on the upper, below 0 on the lower side."""
        speed = edge_speed(surface.airfoil, place, self.source, reynolds(self.speed, surface.chord(y)))

        def share(alpha: Array, beta: Array, mach: Array) -> Array:
            normal = np.cos(beta)
            square = (normal * speed_ratio(speed(angle(alpha)), mach * normal)) ** 2 + np.sin(beta) ** 2
            return np.asarray(impact_share_of(square, mach))

        return share

    def hole_on_fin(self, fin: Surface, z: float, place: float) -> Share:
        """Hole in the fin at x/c = `place`, above 0 on its right side; β takes the place of α."""
        speed = edge_speed(fin.airfoil, place, self.source, reynolds(self.speed, fin.chord(z)))
        height = fin.tip - fin.root
        ratio = 2.0 * height / (0.5 * (fin.root_chord + fin.tip_chord))  # mirrored in the fuselage
        kept = ratio / (ratio + 2.0)

        def share(alpha: Array, beta: Array, mach: Array) -> Array:
            normal = np.cos(alpha)
            square = (normal * speed_ratio(speed(-kept * beta), mach * normal)) ** 2 + np.sin(alpha) ** 2
            return np.asarray(impact_share_of(square, mach))

        return share

    def tube_ahead_of_section(self, surface: Surface, y: float, angle: Callable[[Array], Array]) -> Share:
        """Tube along the chord, its mouth a pipe's length ahead of the leading edge."""
        flow, ahead = naca_flow(surface.airfoil), -PIPE / surface.chord(y)
        (ux, vx), (uy, vy) = flow.velocity(ahead, 0.0, 0.0), flow.velocity(ahead, 0.0, 0.5 * pi)

        def share(alpha: Array, beta: Array, _mach: Array) -> Array:
            a = angle(alpha)
            u, v = ux * np.cos(a) + uy * np.sin(a), vx * np.cos(a) + vy * np.sin(a)
            sideways = np.hypot(v * np.cos(beta), np.sin(beta))
            return recovered(np.arctan2(sideways, u * np.cos(beta)))

        return share

    def boom_ahead_of_section(self, surface: Surface, y: float, angle: Callable[[Array], Array]) -> Share:
        """Static holes on a boom one chord ahead of the leading edge."""
        flow = naca_flow(surface.airfoil)
        (ux, vx), (uy, vy) = flow.velocity(-1.0, 0.0, 0.0), flow.velocity(-1.0, 0.0, 0.5 * pi)

        def share(alpha: Array, beta: Array, mach: Array) -> Array:
            a, normal = angle(alpha), np.cos(beta)
            u, v = ux * np.cos(a) + uy * np.sin(a), vx * np.cos(a) + vy * np.sin(a)
            square = (normal * speed_ratio(u, mach)) ** 2 + 2.0 * ((normal * v) ** 2 + np.sin(beta) ** 2)
            return np.asarray(impact_share_of(square, mach))

        return share


def recovered(angle: Array, limit: float = LIMITS["plain"]) -> Array:
    """Share of q_c that a plain tube keeps at a flow angle, rad: `sensors.probe.recovery` for arrays."""
    beyond = np.maximum(np.abs(angle) - FREE_ANGLE, 0.0)
    return np.maximum(1.0 - 0.01 * (beyond / (limit - FREE_ANGLE)) ** 2, 0.0)


def reynolds(speed: float, chord: float) -> float:
    """Reynolds number of a section, rounded to two digits."""
    return float(f"{speed * chord / KINEMATIC_VISCOSITY:.1e}")


@lru_cache(maxsize=16)
def _fuselage(stations: tuple[float, ...], diameters: tuple[float, ...], mach: float) -> BodyFlow:
    return body_through(stations, diameters, scale=(1.0 - mach * mach) ** 0.5)


def _line(surface: Surface) -> LiftingLine:
    flow = naca_flow(surface.airfoil)
    slope = (flow.lift(radians(2.0)) - flow.lift(0.0)) / radians(2.0)
    place = (surface.quarter_chord, surface.z)
    return LiftingLine(
        2.0 * surface.tip, surface.chord(0.0), surface.tip_chord, slope, flow.zero_lift - surface.incidence, place
    )
