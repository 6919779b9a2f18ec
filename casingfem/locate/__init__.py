"""Search for loose bolts or added masses: the smallest set of changes that explains frequencies and shapes."""
