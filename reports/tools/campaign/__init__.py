"""When each report was last run in full, and whether the pages quote its figures."""
