"""Comparison of the contact part with its targets, line by line."""
