"""Large symmetric matrices: factors, block Lanczos, spectrum slicing, multigrid."""
