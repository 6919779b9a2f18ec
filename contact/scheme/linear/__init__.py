"""Schemes for bodies given by matrices: one file, one method."""
