"""Least-squares updating of a model against measured frequencies."""
