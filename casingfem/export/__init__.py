"""Files for other programs: meshes with mode shapes, universal files."""
