"""What would run on the aircraft: it sees readings and time, never truth.

Each part is stepped with one reading and answers at once: scalar arithmetic, constant memory, and a defined answer to
gaps, NaN and late samples. SI units; specific force in body axes, forward-right-down.
"""
