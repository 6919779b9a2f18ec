"""Comparison of identified, paired and fitted modes with the truth, and of the uncertainty of updates."""
