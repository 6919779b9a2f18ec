"""Universal files: read, checked, written."""
