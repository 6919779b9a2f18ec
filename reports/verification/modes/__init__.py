"""Convergence of frequencies with the mesh, for charts, bolts, rings and imported parts; a check for missed modes."""
