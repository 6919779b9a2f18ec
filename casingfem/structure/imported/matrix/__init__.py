"""Matrices that other programs hand out: how they are read, what their rows mean, how ours are written."""
