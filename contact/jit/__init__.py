"""The only access to numba: compilation, the passing of arrays, and the guarantees of compiled code."""
