"""What touches: rods, masses, beams, bodies by their modes or matrices."""
