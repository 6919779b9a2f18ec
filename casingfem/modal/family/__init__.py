"""Casings that differ by small imperfections around them: their modes from those of the perfect casing."""
