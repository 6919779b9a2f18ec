"""What other programs read: meshes with mode shapes, universal files."""
