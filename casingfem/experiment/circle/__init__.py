"""Round the circumference: orientations from sensors on a circle, and scans by a running laser spot."""
