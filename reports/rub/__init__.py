"""What rubs of reduced casings and blades show, and what they converge with."""
