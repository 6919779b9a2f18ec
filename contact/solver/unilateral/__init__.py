"""Contact problem of one step without friction: complementarity, active sets."""
