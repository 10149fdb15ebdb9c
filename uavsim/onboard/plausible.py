"""What a reading or an estimate can be at all. Beyond, a reading is taken as NaN is, and no airspeed is valid.

| quantity | bounds | where they come from |
|---|---|---|
| pressure | 1 … 250 kPa | the air at 31 km; total pressure at Mach 1 at sea level, 192 kPa, and a sensor's offset |
| temperature | 150 … 400 K | what the equations of `uavsim.airdata` take |
| specific force | ±4000 m/s² | the widest range of a MEMS accelerometer, ±400 g, and 2 % for its scale |
| airspeed | 0 … 340 m/s | the relation of pressures and airspeed ends at Mach 1, 340 m/s at 15 °C |
| its standard deviation | 0 … 340 m/s | an airspeed that is known no better is not known |

A scenario's aircraft is slower: `estimator.fastest`. The bounds of a specific force are open ones, so that a comparison
with them leaves NaN out, too.
"""

LEAST_PRESSURE, MOST_PRESSURE = 1e3, 2.5e5  # Pa
MOST_FORCE = 4000.0  # m/s², either sign
FASTEST = 340.0  # m/s
