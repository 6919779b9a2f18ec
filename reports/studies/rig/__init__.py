"""The whole chain on the rig, from a test to the rub."""
