"""What is certified: sets of flights on seeds named beforehand, judged by rules that stand in code.

A set is a list of flights (`tasks`), each of which is fixed by its scenario, its overrides, the root seed and its
number; what one gave is a row of plain values (`figures`); what all gave together is a list of checks (`verdict`). The
sets are

    healthy         4410 combinations of parts, weather, tare, temperature and noise in which nothing is broken
    offset          an accelerometer whose offset is far larger than its datasheet allows
    from-start      what is broken before the launch
    manoeuvres      hours of prescribed flight in which nothing is broken

`scripts/certify.py` flies them; docs/certify.md says what came.
"""
