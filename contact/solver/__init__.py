"""One-step contact problems."""
