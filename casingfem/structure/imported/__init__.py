"""Meshes from files: readers, checks, solids and shells made of them."""
