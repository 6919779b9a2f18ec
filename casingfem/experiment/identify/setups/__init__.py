"""Tests in several set-ups, whose peaks are shifted: which channels belong together, and few modes for all of them."""
