"""Tools for maintainers: campaigns that are due, small faults that tests detect, structure of the packages."""
