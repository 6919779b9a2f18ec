"""How are files written whole, read strictly, names kept? Nothing here knows physics."""
