"""The hinged beam in a circle, explicit and implicit."""
