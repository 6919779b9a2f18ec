"""Readers of mesh files of Abaqus, CalculiX, Nastran, Ansys and others: cells, groups and attachments."""
