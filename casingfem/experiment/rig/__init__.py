"""The virtual test rig: records that a test would have made, all marked SYNTHETIC."""
