"""Modes, their labels, and reduction to a modal basis."""
