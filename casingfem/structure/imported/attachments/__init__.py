"""What hangs on a mesh beside its cells: point masses, springs, rigid and mean connections, equations."""
