"""Contacts that give way: force-depth laws, and the step of a contact with one."""
