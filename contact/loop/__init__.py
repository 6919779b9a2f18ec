"""Step loops and their sums, compiled by numba."""
