"""What is a mesh from a file: its nodes, cells and groups, the kinds of cells, and what hangs on it."""
