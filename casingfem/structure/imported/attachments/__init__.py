"""What do attachments do to a mesh? Rigid and mean connections, ties and equations as motions of its nodes."""
