"""What launch detectors are judged on: launches and disturbances at the accelerometer, with their distributions.

Specific force in m/s², body axes forward-right-down, t in s. On a rail of elevation θ a launch is

    f_x(t) = a(t - t_onset) + g sin θ,   f_y = 0,   f_z = -g cos θ        reading = clip(f + σ ξ + v)

a is the kinematic stroke (`Stroke`): a half-sine P sin(π t/T), a trapezoid that rises and falls in the same time, or
the measured shape of an electromechanical catapult; P is the kinematic peak, T the time from no force to no force.
ξ is white and normal, so σ is noise and vibration at the detector, not a part's data sheet. v is vibration with a flat
spectrum in a band. After the stroke the rail's rest is felt again. Degrees and g are in the settings only, whose names
say so. Unless a setting says otherwise:

    launches      half-sine or trapezoid 50:50; P U(5, 15) g; T U(0.1, 0.4) s; rise U(10, 40) ms; θ U(5°, 35°);
                  wait before onset U(0.5, 1) s; the bump of a bump trial begins U(0.4 s, its length) before onset
    hang-fire     the force first stays at U(0.1, 0.4) P for U(0.1, 0.5) s, then the stroke comes
    broken        the force goes at U(0.1, 0.6) T, within 5 ms, for U(20, 60) ms, and comes back in 5 ms
    shocks        half-sine, peak U(20, 50) g, U(2, 5) ms, on x, y or z, either sign, then ringing of opposite sign:
                  U(0.2, 0.5) of the peak, U(80, 400) Hz, decay U(5, 20) ms
    soft drops    the same with U(6, 12) g, U(15, 25) ms and a tenth to a fifth of ringing at U(20, 60) Hz
    the mix       shocks as a Poisson process of 0.5/s; in each spell of 30 s vibration of 0, 1, 2 or 3 g rms (each
                  axis, 5-200 Hz), equally probable, on a rail of its own θ; σ 0.3 g; all of it clipped at ±16 g

All randomness comes from named streams of (seed, index), see `sensors.streams`: trial i of a seed is the same whatever
else is drawn. The disturbances are assumptions, not measurements, but for the bounds on walking (`WalkSettings`).
"""

from uavsim.studies.signals.launches import (
    BUMP_WITHIN,
    CROSSING,
    MEASURED_CATAPULT,
    Fault,
    Launch,
    LaunchSettings,
    LaunchTruth,
    Recordings,
    draw_launch,
    record_launches,
)
from uavsim.studies.signals.loads import (
    CentrifugeSettings,
    RunUpSettings,
    WalkSettings,
    centrifuge,
    run_up,
    walk,
)
from uavsim.studies.signals.mix import FADE, SOFT_DROPS, SPELL, Mix, MixSettings
from uavsim.studies.signals.noise import band_noise, sense
from uavsim.studies.signals.ranges import Array, NonNegative, Range, Single
from uavsim.studies.signals.shock import RING_DECAYS, SOFT_DROP, Shock, ShockSettings, draw_shock
from uavsim.studies.signals.stroke import (
    BREAK_RAMP,
    CATAPULT_KNOTS,
    CATAPULT_PEAK,
    CATAPULT_SECOND,
    CATAPULT_TIME,
    WEAK_RISE,
    Shape,
    Stroke,
)
from uavsim.truth import STANDARD_GRAVITY as G0

__all__ = [
    "BREAK_RAMP",
    "BUMP_WITHIN",
    "CATAPULT_KNOTS",
    "CATAPULT_PEAK",
    "CATAPULT_SECOND",
    "CATAPULT_TIME",
    "CROSSING",
    "FADE",
    "G0",
    "MEASURED_CATAPULT",
    "RING_DECAYS",
    "SOFT_DROP",
    "SOFT_DROPS",
    "SPELL",
    "WEAK_RISE",
    "Array",
    "CentrifugeSettings",
    "Fault",
    "Launch",
    "LaunchSettings",
    "LaunchTruth",
    "Mix",
    "MixSettings",
    "NonNegative",
    "Range",
    "Recordings",
    "RunUpSettings",
    "Shape",
    "Shock",
    "ShockSettings",
    "Single",
    "Stroke",
    "WalkSettings",
    "band_noise",
    "centrifuge",
    "draw_launch",
    "draw_shock",
    "record_launches",
    "run_up",
    "sense",
    "walk",
]
