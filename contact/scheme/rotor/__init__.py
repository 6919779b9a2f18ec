"""The exact step of a rotor under its unbalance."""
