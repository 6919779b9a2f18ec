"""Identification of modes from responses alone, under loads that are not measured."""
