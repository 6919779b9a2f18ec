"""How does a wheel of equal or mistuned sectors move, what does contact see of it? From the mesh of one sector."""
