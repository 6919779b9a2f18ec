"""Compliant contacts: force-depth laws, and the contact problem of one step with them."""
