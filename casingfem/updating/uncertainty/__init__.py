"""How sure is a fit beyond J^T J? Laplace's approximation, samples of the posterior, rows that were left out."""
