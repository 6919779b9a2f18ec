"""The only access to numba: compilation, passing of arrays, and guarantees of compiled code."""
