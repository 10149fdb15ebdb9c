"""Parts of `build_aircraft.py`: geometry and mass; shape and aerodynamics; trim; and the XML that they become."""
