"""Steps between located events."""
