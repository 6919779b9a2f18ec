"""Behaviour with broken models, damaged files and killed runs."""
