"""A wheel from one sector of a mesh: its two faces paired, its matrices by nodal diameter."""
