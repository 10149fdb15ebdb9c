"""The aided airspeed filter's model in symbols, and the code that is written from it."""
