"""Bodies, gaps and laws."""
