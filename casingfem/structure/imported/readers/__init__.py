"""Readers of mesh files: Abaqus and CalculiX, Nastran, Ansys; cells, groups and attachments."""
