"""Exact-modal step loops with one or several contacts; they skip free flight."""
