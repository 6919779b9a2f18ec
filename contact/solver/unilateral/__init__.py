"""One step without friction: complementarity, active sets."""
