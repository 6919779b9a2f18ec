"""From measured radii to a field: points, robust fit, checks."""
