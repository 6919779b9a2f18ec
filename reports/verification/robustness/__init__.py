"""What becomes of broken models, damaged files and killed runs."""
