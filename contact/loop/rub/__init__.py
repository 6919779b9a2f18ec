"""The step loop of a rub: prediction, contact forces, energies."""
