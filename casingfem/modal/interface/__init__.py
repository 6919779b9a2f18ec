"""What does contact see of a structure? Rims, tips and nodes as rows over its displacements, and outputs."""
