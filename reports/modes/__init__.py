"""How frequencies settle with the mesh, on bolts and rings, imported or mistuned, and that none is missed."""
