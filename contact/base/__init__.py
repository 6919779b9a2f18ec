"""Base of both packages: errors, read-only arrays, files of arrays in one format."""
