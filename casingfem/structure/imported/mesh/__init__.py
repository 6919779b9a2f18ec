"""A mesh from a file: nodes, cells, groups, kinds of cells, and attachments."""
