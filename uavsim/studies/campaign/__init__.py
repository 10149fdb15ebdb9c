"""Many flights: what is flown, how it is kept, and what may be said of all of them together."""
