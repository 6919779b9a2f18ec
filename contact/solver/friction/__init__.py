"""One step with Coulomb friction: Newton, sweeps, pivoting, starts where all slide."""
