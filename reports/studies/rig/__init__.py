"""What the whole chain gives, from a test to the rub."""
