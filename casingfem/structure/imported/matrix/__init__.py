"""Matrices of other programs: reading, meaning of their rows, and writing."""
