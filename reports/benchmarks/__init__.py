"""Benchmarks: time of each step, of sweeps and of start-up, and error against time."""
