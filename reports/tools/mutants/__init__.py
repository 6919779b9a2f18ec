"""Which small faults, put in one at a time, the tests see."""
