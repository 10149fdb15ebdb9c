"""The instant at which the filter stands, and how it goes on from there by the specific force.

The filter stands at the middle of the last total pressure's conversion, less the lag of its tube. From there to the
next it is predicted with the force's integral and the variance of what moves the airspeed beside it:

    ΔV = ∫ f_x dt − …,    σ² = 2 σ_g²/L · max(V, 1 m/s) Δt + Δw + what unfolding adds

with the gusts' variance σ_g² and length L (`air`) and the variance Δw of the integral (`speed_gained`). The integral
is kept there, so that a reading of the accelerometer costs one sum.
"""

from math import inf, sqrt

from uavsim.onboard.airspeed.air import SLOWEST, Air
from uavsim.onboard.airspeed.energy import EnergyFilter
from uavsim.onboard.airspeed.flow_angles import FlowAngles
from uavsim.onboard.airspeed.gust import GRAVITY
from uavsim.onboard.airspeed.interface import NoiseModel
from uavsim.onboard.airspeed.lift import pulled
from uavsim.onboard.airspeed.onset import Onset
from uavsim.onboard.airspeed.ports import Ports
from uavsim.onboard.airspeed.push_end import PushEnd
from uavsim.onboard.airspeed.rail_wind import RailWind
from uavsim.onboard.airspeed.rest_force import RestForce
from uavsim.onboard.airspeed.settings import AidedSettings
from uavsim.onboard.airspeed.shock import Shock
from uavsim.onboard.airspeed.speed_gained import SpeedGained
from uavsim.onboard.airspeed.unfolding import Unfolding

SLOW = 24.0  # m/s, from which on an angle of attack is a usual one (`flow_angles`)
PITCHES = 2.0  # s after the wings are out, in which an aircraft that was slow pitches up and gains speed. By hand


class Progress:
    """Where the filter stands, and what moves it.

    Parameters
    ----------
    aided : AidedSettings
        What is believed of air and aircraft.
    noise : NoiseModel
        What is believed of the sensors.
    air : Air
        That it flies in.
    gained, rest : SpeedGained, RestForce
        Of the readings of specific force.
    onset : Onset
        Of the airspeed by pressures.
    ports : Ports
        The watch over the two ports.

    Attributes
    ----------
    energy : EnergyFilter
        The filter.
    time : float
        The instant at which it stands, s.
    t : float
        Time stamp of the reading of the head that was taken last, s.
    u, w : float
        ∫ f_x dt, m/s, and its variance, m²/s², at `time`.
    grown : float
        By how much the airspeed has grown by a wind that is known, m/s.
    force : float
        Mean of f_x less that at rest up to `time`, m/s².
    lift : float
        Mean of −f_z up to `time`, m/s²; NaN if none has been read.
    steady_from : float
        From when on the ports are watched, s; inf while the push lasts.
    wind, angles, unfolding, push_end : RailWind, FlowAngles, Unfolding, PushEnd
        What is known of each.
    """

    __slots__ = (
        "_on_rail", "_onset", "_ports", "_shock", "air", "angles", "energy", "force", "gained", "grown", "lift",
        "push_end", "rest", "steady_from", "t", "time", "u", "unfolding", "w", "wind",
    )  # fmt: skip

    energy: EnergyFilter

    def __init__(
        self,
        aided: AidedSettings,
        noise: NoiseModel,
        *,
        air: Air,
        gained: SpeedGained,
        rest: RestForce,
        onset: Onset,
        ports: Ports,
    ) -> None:
        self.air, self.gained, self.rest, self._onset, self._ports = air, gained, rest, onset, ports
        self.wind, self.angles, self.unfolding = RailWind(aided, noise.head), FlowAngles(aided), Unfolding(aided)
        self.push_end = PushEnd()
        self._shock = Shock(noise.accelerometer_sd / sqrt(max(1.0, noise.accelerometer_rate / noise.head_rate)))
        self._on_rail = aided.on_rail
        self.time = self.t = -inf
        self.u = self.w = self.grown = self.force = 0.0
        self.lift, self.steady_from = GRAVITY, inf

    @property
    def now(self) -> tuple[float, float]:
        """Instant, s, and ∫ f_x dt with what the wind has given, m/s: what the watch over the ports goes by."""
        return self.time, self.u + self.grown

    def start(self, start: float, steady_from: float) -> None:
        """Stand at an instant, s."""
        self.time = self.t = start
        self.reread()
        self.steady_from = steady_from
        self.push_end.forget(steady_from)
        self._shock.forget()

    def reread(self) -> None:
        """Take ∫ f_x dt at the instant anew: what was read of it before means nothing."""
        self.u, self.w = self.gained.at(self.time)

    def advance(self, to: float) -> None:
        """Predict to a later time; an earlier one leaves the filter where it is."""
        dt = to - self.time
        if not dt > 0.0:
            return
        gained, variance = self.go(to, dt)
        total, density = self._ports.total, self.air.density
        if total.faulty and total.coasts:
            total.carry(self.energy, dt, gained, variance, density)
        else:
            energy, wind = self.energy, self.wind
            energy.predict(dt, gained, variance, density, self.force > self._on_rail)
            if wind.on:  # the model climbs by the airspeed, the aircraft up its rail by that over the ground
                energy.shift_static(density * energy.s * (energy.v - wind.gained(energy.v)) * dt)

    def go(self, to: float, dt: float) -> tuple[float, float]:
        """Go on to a later time; return ∫ f_x dt, m/s, and the variance that gust and accelerometer add to V's."""
        wind, air, energy = self.wind, self.air, self.energy
        v = energy.v if not wind.on else wind.speed(energy.v)
        u, w = self.gained.at(to)
        gained = u - self.u
        self.force = gained / dt - self.rest.mean
        if self.steady_from == inf:
            self.push_end.add(to, self.force, dt)
            self.steady_from = self.push_end.steady_from
        if air.growth:
            grown = air.growth * (wind.gained(energy.v) if wind.on else v) * dt
            gained += grown
            self.grown += grown
        variance = air.gust * (v if v > SLOWEST else SLOWEST) * dt
        if wind.on:
            railed = self.force > self._on_rail
            wind.advance(energy, dt, gained, variance, air.density, railed)
            if railed:
                wind.pushed = True
            elif wind.pushed or to > self._onset.patience:
                self.leave_rail()
        if w > self.w:  # else readings have come late, and w has counted already that they might be lost
            variance = variance + w - self.w
            if self.gained.torn(w - self.w, dt):
                self._ports.torn = True
        unfolding = self.unfolding
        if self.time < unfolding.end:
            variance += unfolding.variance(self.time, to)
        lift = self.lift = self.gained.lift()
        if lift == lift and to > unfolding.end > -inf:  # the wings are out
            self.angles.lift = lift
        if self.time > self.steady_from and lift == lift:
            turned, doubt = pulled(lift, v)
            gained -= turned * dt
            variance += doubt * dt
        if v < SLOW and to < unfolding.end + PITCHES:
            variance += self.angles.pitching(v, self.air.density) * dt
        self.time, self.u, self.w = to, u, w
        return gained, variance

    def leave_rail(self) -> None:
        """Be told that the push is over: from here on the filter's airspeed is along the path."""
        self.wind.leave(self.energy, self.air.heat)
        self.energy.hold_difference()
        self.angles.leave(self.time, self.wind.side)

    def lose_wind(self) -> None:
        """Be told that what the total pressure has told of the wind on the rail is void."""
        self.wind.drop(self.energy, self.air.heat)

    def unfold(self, t: float) -> None:
        """Be told that the wings are commanded out at `t`, s."""
        if self.wind.on:
            self.leave_rail()
        self.unfolding.begin(t)

    def feel_shock(self, to: float) -> None:
        """Open b after a step of f_x; name the accelerometer where b has taken it up."""
        shock, energy, ports = self._shock, self.energy, self._ports
        size = shock.add(to, self.force, energy.b)
        if size != 0.0:
            energy.widen_bias(size * size)
            ports.total.open_bias(self.time, size * size)
        elif to > shock.due:
            offset, moved = shock.judge(energy.b, energy.bb)
            if offset:
                ports.tell(self.t, "airspeed_fault", "accelerometer", "offset")
            else:
                ports.total.close_bias(moved * moved)
