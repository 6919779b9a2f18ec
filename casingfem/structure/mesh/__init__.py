"""Division of a surface: p-elements, their numbering, strains and places on it."""
