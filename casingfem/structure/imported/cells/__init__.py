"""What does one cell of an imported mesh strain, what do its matrices hold? Solids and shells."""
