"""Which small faults, introduced one at a time, the tests detect."""
