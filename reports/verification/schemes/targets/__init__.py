"""Which targets of the contact part are met, line by line."""
