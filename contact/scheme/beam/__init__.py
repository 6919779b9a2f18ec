"""Explicit and implicit schemes of the hinged beam in a circle."""
