"""Contact problem of one step with Coulomb friction.

Newton, sweeps, pivoting, starting points with all contacts sliding.
"""
