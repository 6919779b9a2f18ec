"""What does one cell of an imported mesh strain, what do its matrices contain? Solids and shells."""
