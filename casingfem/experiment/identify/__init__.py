"""Identification of modes from measured frequency responses."""
