"""Bodies in pictures: the surface, shapes painted on it, shapes that a reader turns."""
