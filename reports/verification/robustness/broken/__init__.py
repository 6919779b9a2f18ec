"""Check that every broken model is refused, or gives a warning, with its code."""
