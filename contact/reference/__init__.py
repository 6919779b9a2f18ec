"""Exact answers: impacts, waves in rods, analytic solutions."""
