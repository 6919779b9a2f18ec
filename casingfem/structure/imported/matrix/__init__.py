"""Matrices of other programs: reading them, the meaning of their rows, and writing ours."""
