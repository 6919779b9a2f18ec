"""What the chain gives: rubs of the source study, coatings that wear, jumps, the rig from a test to the rub."""
