"""Step loops of linear bodies, one for each family of schemes."""
