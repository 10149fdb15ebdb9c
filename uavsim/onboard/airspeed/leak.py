"""Whether the airspeed has left what the specific force gave, by more than gusts do and for longer: a leak.

The difference between the two is the gust G, Dryden's first-order process of standard deviation σ and length L
(MIL-F-8785C),

    Ġ = V̇ − (f_x − b − s) − G V/L

with b what f_x is off by and s = g sin γ. A filter that believes in gusts follows a slow leak as if it were one. Each
innovation is small, and in the end the airspeed told has fallen to nothing. But no gust goes on and on: |G| stays below
5 σ. A single gust may be beyond that while it passes. So what counts is the way that it leads beyond,

    D = Σ (|G| − 5 σ) dt, never below 0
"""

LEAST_SD = 1.0  # m/s, of gusts that are granted where fewer are declared: a single gust may come in calm air. By hand
FAR = 5.0  # σ, beyond which a gust counts. Turbulence is there in 6 of 10 million of the time
NEAR = 2.5  # σ, within which a gust is a usual one, and what the port says counts as sound. Half of `FAR`, by hand
LARGE = 2.0  # σ, beyond which a gust that is alone is a leak (`smooth`); air for which gusts are declared may be still
# m of D, above which it is a leak. By hand: a gust of 6 m/s, 1 − cos in 2.5 s, in turbulence of 1.2 m/s led to 5.8 m at
# the most in 200 flights, and a leak of 5 s takes some 7 s to 10 m (docs/faults.md, slow-leak-gusts)
WAY = 10.0


class LeakTest:
    """The difference G, m/s, and how far it has led.

    Parameters
    ----------
    sd, length : float
        Of the gusts, m/s and m.

    Attributes
    ----------
    way : float
        D, m.
    gust : float
        G, m/s.
    near : bool
        Whether G is a usual gust, so that what the port says is sound.
    large : bool
        Whether it is one of two standard deviations, so that a port that shows no other gusts leaks.
    """

    __slots__ = ("_far", "_large", "_length", "_near", "gust", "large", "near", "way")

    def __init__(self, sd: float, length: float) -> None:
        sd = max(sd, LEAST_SD)
        self._far, self._near, self._large, self._length = FAR * sd, NEAR * sd, LARGE * sd, length
        self.forget()

    def forget(self) -> None:
        """Begin without a gust."""
        self.gust, self.way, self.near, self.large = 0.0, 0.0, True, False

    def add(self, speed: float, change: float, gained: float, dt: float) -> bool:
        """Take the airspeed, m/s, by how much it and what the force gave have changed, m/s, in a time, s.

        Returns
        -------
        bool
            Whether it is no gust.
        """
        gust = self.gust = self.gust * (1.0 - dt * speed / self._length) + change - gained
        size = gust if gust > 0.0 else -gust
        self.near, self.large = size < self._near, size > self._large
        way = self.way + (size - self._far) * dt
        self.way = way if way > 0.0 else 0.0
        return way > WAY
