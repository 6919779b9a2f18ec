"""Verification: structures, contact, rubs, identification and updating against published, exact, independent values."""
