"""Contact problem of one step with a coating that yields."""
