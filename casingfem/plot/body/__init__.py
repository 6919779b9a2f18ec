"""Bodies in pictures: the surface, shapes painted on it, shapes that the reader can rotate."""
