"""Compliant contacts: force-depth laws, and the step of a contact with one."""
