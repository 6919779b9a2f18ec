"""For maintainers: which campaigns are due, which small faults the tests see, how the packages are built."""
