"""What `scripts/mutants.py` is made of: where, what, and how it is tried."""
