"""Measured modes against computed ones: pairing, assurance criteria, expansion."""
