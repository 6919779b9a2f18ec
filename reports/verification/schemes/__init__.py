"""How exact each contact scheme is on rods, bars and beams, and how far it can be pushed."""
