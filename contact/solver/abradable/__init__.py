"""One step against a coating that flows."""
