"""Modes from frequency responses."""
