"""Contact problems of one step; compiled, so imported only when a run starts."""
