"""Many flights: what to fly, how, what is kept of it, and what it shows."""
