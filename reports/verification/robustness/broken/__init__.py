"""Whether every broken model is refused or warned of by its code."""
