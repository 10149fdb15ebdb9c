"""What a scenario says of the air and the place."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Interval

Profile = Literal["log", "power", "uniform"]
Model = Literal["mil-f-8785c", "mil-hdbk-1797"]
Event = Literal["time", "release", "rail-exit", "wings-commanded", "wing-out", "motor-on"]
Shape = Literal["one-minus-cosine", "step"]
Side = Literal["head", "tail", "left", "right", "up", "down"]

Speed = Annotated[float, Interval(ge=-15, le=15)]
Length = Annotated[float, Interval(ge=0.1, le=20)]
Delay = Annotated[float, Interval(ge=0, le=3600)]


@dataclass(frozen=True, slots=True)
class GustSettings:
    """One gust.

    Attributes
    ----------
    speed
        At its peak, m/s; 0 is none.
    direction
        "head" blows from ahead, "tail" from behind, "left" and "right" from that side, each level and by the heading of
        the rail; "up" and "down" blow that way. Two at once make any other.
    shape
        "one-minus-cosine" grows and dies away, ½ (1 − cos 2π t/length); "step" is there at once.
    at
        Event that it waits for: "release" of the latch, "rail-exit", "wings-commanded", "wing-out", "motor-on", or
        "time": the beginning of the record.
    delay
        Its start after that event, s.
    length_s
        How long it lasts, s. Without it 2 s of a one-minus-cosine; a step stays.
    """

    speed: Speed = 0.0
    direction: Side = "head"
    shape: Shape = "one-minus-cosine"
    at: Event = "wing-out"
    delay: Delay = 5.0
    length_s: Length | None = None


@dataclass(frozen=True, slots=True)
class EnvironmentSettings:
    """The air and the place.

    Attributes
    ----------
    preset
        Weather by name (docs/air.md); what else is said here comes before it. "" is none.
    latitude_deg
        Geodetic latitude, degrees.
    ground_elevation
        Of the ground above mean sea level, m.
    temperature_offset
        Difference from the standard atmosphere's temperature, K, at every height.
    sea_level_pressure
        Pressure of the day reduced to mean sea level by the standard atmosphere (QNH), Pa.
    humidity
        Relative humidity at the ground, 0 … 1; the share of vapour is the same at every height.
    wind_speed
        Mean wind over the ground at 20 ft (6.1 m), m/s.
    wind_from_deg
        Direction it comes from at 20 ft, degrees from north.
    wind_profile
        How it grows with height h above the ground: "log", as ln(h/roughness); "power", as h^wind_exponent; "uniform",
        not at all.
    roughness
        Length of the logarithmic law, m: 0.15 ft for take-off and landing, 2 ft else (MIL-F-8785C 3.7.3.2).
    wind_exponent
        Of the power law; 1/7 over open country.
    wind_veer
        How far it turns to the right with height, degrees in 100 m.
    turbulence_model
        Dryden's spectra with the lengths of "mil-f-8785c" or of "mil-hdbk-1797".
    turbulence_wind_20ft
        Wind speed at 20 ft that sets the intensity of the turbulence below 1000 ft, m/s; 0 is none at any height.
    turbulence_severity
        Curve of the probability of exceedance that sets it above 2000 ft, 1 (light and usual) … 7 (severe and rare).
    gust_speed, gust_direction, gust_shape, gust_at, gust_delay, gust_length_s
        A gust, as one of `gusts` has them.
    gusts
        More of them.
    """

    preset: str = ""
    latitude_deg: Annotated[float, Interval(ge=-90, le=90)] = 47.0
    ground_elevation: Annotated[float, Interval(ge=-400, le=4000)] = 0.0
    temperature_offset: Annotated[float, Interval(ge=-60, le=40)] = 0.0
    sea_level_pressure: Annotated[float, Interval(ge=87_000, le=108_500)] = 101_325.0
    humidity: Annotated[float, Interval(ge=0, le=1)] = 0.0
    wind_speed: Annotated[float, Interval(ge=0, le=25)] = 0.0
    wind_from_deg: Annotated[float, Interval(ge=-360, le=360)] = 0.0
    wind_profile: Profile = "log"
    roughness: Annotated[float, Interval(ge=1e-4, le=2)] = 0.04572
    wind_exponent: Annotated[float, Interval(gt=0, le=0.6)] = 1.0 / 7.0
    wind_veer: Annotated[float, Interval(ge=-60, le=60)] = 0.0
    turbulence_model: Model = "mil-f-8785c"
    turbulence_wind_20ft: Annotated[float, Interval(ge=0, le=25)] = 0.0
    turbulence_severity: Annotated[int, Interval(ge=1, le=7)] = 3
    gust_speed: Speed = 0.0
    gust_direction: Side = "head"
    gust_shape: Shape = "one-minus-cosine"
    gust_at: Event = "wing-out"
    gust_delay: Delay = 5.0
    gust_length_s: Length | None = None
    gusts: tuple[GustSettings, ...] = ()

    @property
    def all_gusts(self) -> tuple[GustSettings, ...]:
        """Every gust that has a speed."""
        own = GustSettings(
            self.gust_speed,
            self.gust_direction,
            self.gust_shape,
            self.gust_at,
            self.gust_delay,
            self.gust_length_s,
        )
        return tuple(gust for gust in (own, *self.gusts) if gust.speed != 0.0)
