"""How a surface is divided: p-elements, their numbering, strains and places on it."""
