"""The doorway to numba: what is compiled, how arrays reach it, with what promises."""
