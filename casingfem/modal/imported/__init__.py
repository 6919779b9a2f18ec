"""What are the modes of an imported part, what does contact see of it? Modes, interfaces and outputs on meshes."""
