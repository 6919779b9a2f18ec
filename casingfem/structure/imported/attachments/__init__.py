"""Attachments of a mesh: rigid and mean connections, ties and equations, as motions of its nodes."""
