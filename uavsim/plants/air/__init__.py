"""The air that an aircraft flies in: weather, mean wind, turbulence and gusts; SI, free of JSBSim."""
