"""What each step costs, alone, in sweeps and when a program starts."""
