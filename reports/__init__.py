"""Tables and figures, each a script with `main(out, quick=False)`."""
