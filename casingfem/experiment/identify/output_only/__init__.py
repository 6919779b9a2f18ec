"""Modes from responses alone, under loads that nobody measured."""
