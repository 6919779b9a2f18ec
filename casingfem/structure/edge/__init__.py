"""What holds an edge: clamps, springs, bolts, rings, point masses."""
