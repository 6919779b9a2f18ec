"""Casings that differ by small imperfections around the circumference: their modes from those of the perfect casing."""
