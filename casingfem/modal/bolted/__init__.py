"""Casings around which their bolts alone vary: harmonics of the perfect casing, coupled by the bolts."""
