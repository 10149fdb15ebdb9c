"""What a reading or an estimate can be at all. Beyond, a reading is taken as NaN is, and no airspeed is valid.

| quantity | bounds | where they come from |
|---|---|---|
| pressure | 1 … 250 kPa | the air at 31 km; total pressure at Mach 1 at sea level, 192 kPa, and a sensor's offset |
| temperature | 180 … 360 K | the coldest tropopause, 190 K; the parts' own range ends at 85 °C |
| specific force | ±4000 m/s² | the widest range of a MEMS accelerometer, ±400 g, and 2 % for its scale |
| the same in flight | ±60 m/s² | 6 g, more than an airframe with its wings out has to take |
| airspeed | 0 … 340 m/s | the relation of pressures and airspeed ends at Mach 1, 340 m/s at 15 °C |
| its standard deviation | 0 … 340 m/s | an airspeed that is known no better is not known |

A scenario's aircraft is slower, `estimator.fastest`; on a rig a force of flight is as any other,
`estimator.aided.flight_force`. The bounds of a specific force are open ones, so that a comparison
with them leaves NaN out, too.
"""

LEAST_PRESSURE, MOST_PRESSURE = 1e3, 2.5e5  # Pa
LEAST_TEMPERATURE, MOST_TEMPERATURE = 180.0, 360.0  # K
MOST_FORCE = 4000.0  # m/s², either sign
MOST_FLIGHT_FORCE = 60.0  # m/s², either sign
FASTEST = 340.0  # m/s
