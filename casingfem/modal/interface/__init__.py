"""Interface of a structure to contact: rims, tips and nodes as rows over its displacements, and outputs."""
