"""Strains and matrices of one cell of an imported mesh, for solids and shells."""
