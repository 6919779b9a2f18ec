"""A shell as a value, its matrices, loads and prestress."""
