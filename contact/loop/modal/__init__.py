"""Exact-modal step loops: one contact, several, leaps over free flight."""
