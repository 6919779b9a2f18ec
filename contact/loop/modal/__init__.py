"""Exact-modal step loops: one contact, several; free flight skipped."""
