"""What a scenario may change of an aircraft that is not known exactly: factors of 1, and two point masses of nothing.

    factor/lift, factor/drag, factor/pitch, factor/thrust     multiply that force or moment
    ballast/fore-pointmass, ballast/aft-pointmass             numbers of two point masses, which the simulation places

The simulation sets them before a flight (`uavsim.plants.varied`). With factors of 1 and no ballast they change no
bit of a flight.
"""

FORE, AFT = 4, 5  # behind the panels' four
FACTORS = ("lift", "drag", "pitch", "thrust")


def factor(name: str) -> str:
    """Return the property of a factor."""
    if name not in FACTORS:
        raise KeyError(name)
    return f"factor/{name}"


def factors_xml() -> str:
    """Write the properties, of the system of constants."""
    values = {**{factor(name): 1 for name in FACTORS}, "ballast/fore-pointmass": FORE, "ballast/aft-pointmass": AFT}
    return "".join(f'    <property value="{value}">{name}</property>\n' for name, value in values.items())


def excess_thrust_xml() -> str:
    """Write the magnitude of the thrust that comes on top of the propeller's."""
    return (
        f"<function><product><difference><property>{factor('thrust')}</property><value>1</value></difference>"
        "<property>propulsion/engine/thrust-lbs</property></product></function>"
    )
