"""What numba compiles: step loops, the sums they keep."""
