"""The compiled step loops of the schemes."""
