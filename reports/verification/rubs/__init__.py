"""Rubs against poles, richer bases, smaller steps and plain NumPy."""
