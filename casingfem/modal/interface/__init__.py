"""Interface of a structure for contact: rims, tips and nodes as rows over its displacements, and outputs."""
