"""Many flights: campaigns, sweeps, sensitivity, verification."""
