"""How is a mesh file read? Abaqus and CalculiX, Nastran, Ansys: cells, groups and what hangs on them."""
