"""How fast is it? Time of each step, of sweeps and of starting, and error against time."""
