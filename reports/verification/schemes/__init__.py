"""Accuracy of each contact scheme on rods, bars and beams, and its limits."""
