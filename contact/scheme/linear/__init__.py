"""Schemes for bodies given by matrices, one file for each method."""
