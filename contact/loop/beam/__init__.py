"""Step loops of a hinged beam in a circle."""
