"""Is it right? Structures, contact, rubs, identification and updating against published, exact, independent values."""
