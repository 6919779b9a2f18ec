"""How frequencies converge with the mesh, of charts, bolts, rings and imported parts, and whether none is missed."""
