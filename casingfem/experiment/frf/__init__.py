"""Measured functions: sets of frequency responses, their files, their estimation from records."""
