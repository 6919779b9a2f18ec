"""Wheels of equal or mistuned sectors: motion, and interface to contact, from the mesh of one sector."""
