"""One-step contact problems; compiled, so imported only when a run starts."""
