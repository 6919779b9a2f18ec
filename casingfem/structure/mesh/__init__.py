"""Mesh of a surface: p-elements, their numbering, strains, and interpolation at any point."""
