"""Studies of the whole chain: rubs of the source study, coatings that wear, jumps, the rig from a test to the rub."""
