"""Uncertainty of a fit beyond J^T J: Laplace's approximation, posterior samples, left-out rows."""
