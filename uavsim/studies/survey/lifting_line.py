"""Angle of attack of a wing's sections behind its own downwash, and the velocity it induces elsewhere.

Prandtl's lifting line, Γ(θ) = 2·b·U·Σ A_n·sin nθ at y = −b/2·cos θ, with the section's own slope and angle of no lift
(Glauert, The Elements of Aerofoil and Airscrew Theory, chapter XI):

    Σ A_n·sin nθ·[n·μ + sin θ] = μ·sin θ·(α − α₀),        μ = a·c/(4·b)

The odd n serve a symmetric wing. On an elliptic wing the downwash is constant, which is the test. Γ as a row of
horseshoes gives by Biot and Savart what the wing does to the flow at fuselage and tail.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TERMS = 24
HORSESHOES = 60  # on both sides together
CORE = 0.05  # of the span; vortices nearer than that are softened, as a rolled-up sheet has no infinite speeds


@dataclass(frozen=True)
class LiftingLine:
    """A symmetric wing in a unit stream.

    Attributes
    ----------
    span, root_chord, tip_chord : float
        m; the chord is linear between.
    slope : float
        Of the section's lift, 1/rad.
    zero_lift : float
        Angle of no lift with the incidence taken off, rad.
    place : (x, z)
        Of the quarter chord, m, x aft, z up.
    """

    span: float
    root_chord: float
    tip_chord: float
    slope: float
    zero_lift: float
    place: tuple[float, float] = (0.0, 0.0)

    def chord(self, y: float) -> float:
        """Chord at a distance from the plane of symmetry, m."""
        share = min(abs(y) / (0.5 * self.span), 1.0)
        return self.root_chord + (self.tip_chord - self.root_chord) * share

    @cached_property
    def _terms(self) -> tuple[Array, Array]:
        """N and A_n per rad of α − α₀."""
        n: Array = 2.0 * np.arange(TERMS, dtype=float) + 1.0
        theta = 0.5 * np.pi * (np.arange(TERMS) + 1.0) / TERMS
        chord = np.array([self.chord(0.5 * self.span * np.cos(t)) for t in theta])
        mu = (self.slope * chord / (4.0 * self.span))[:, None]
        sine, all_sines = np.sin(theta)[:, None], np.sin(theta[:, None] * n)
        return n, np.asarray(np.linalg.solve(all_sines * (n * mu + sine), (mu * sine)[:, 0]), dtype=float)

    def downwash_slope(self, y: float) -> float:
        """Downwash angle at a section per rad of α − α₀; towards the tip what it is at 0.98 of the half span."""
        n, a = self._terms
        theta = np.arccos(min(abs(y) / (0.5 * self.span), 0.98))
        return float(np.sum(n * a * np.sin(n * theta)) / np.sin(theta))

    def section_angle(self, y: float, alpha: Any, upwash: Any = 0.0) -> Any:
        """Angle of attack of the section at y, rad, over its own downwash; `upwash`, rad, comes from elsewhere."""
        return alpha + upwash - self.downwash_slope(y) * (alpha - self.zero_lift)

    @cached_property
    def _horseshoes(self) -> tuple[Array, Array, Array]:
        """Left and right end of each, m, and its Γ/U per rad of α − α₀, m."""
        n, a = self._terms
        ends = -0.5 * self.span * np.cos(np.pi * np.arange(HORSESHOES + 1) / HORSESHOES)
        middle = np.arccos(np.clip(-2.0 / self.span * 0.5 * (ends[1:] + ends[:-1]), -1.0, 1.0))
        gamma = 2.0 * self.span * np.sum(a * np.sin(middle[:, None] * n), axis=1)
        return ends[:-1], ends[1:], gamma

    def induced(self, x: float, y: float, z: float, alpha: float) -> tuple[float, float]:
        """Velocity that the wing induces at (x, y, z), m, x aft, z up: along x and along z, shares of the stream's."""
        left, right, gamma = self._horseshoes
        gamma = gamma * (alpha - self.zero_lift)
        dx, dz = x - self.place[0], z - self.place[1]
        soft = (CORE * self.span) ** 2
        off = dx * dx + dz * dz
        ends = [(y - end) / np.sqrt(off + (y - end) ** 2 + 1e-12) for end in (left, right)]
        bound = gamma / (4.0 * np.pi) * (ends[0] - ends[1]) / (off + 1e-3 * soft)
        along, up = float(np.sum(bound * dz)), float(-np.sum(bound * dx))
        for end, sign in ((left, -1.0), (right, 1.0)):  # of the two trailing vortices
            dy = y - end
            reach = 1.0 + dx / np.sqrt(dx * dx + dy * dy + dz * dz + 1e-12)
            up += float(np.sum(sign * gamma / (4.0 * np.pi) * dy * reach / (dy * dy + dz * dz + soft * 1e-2)))
        return along, up
