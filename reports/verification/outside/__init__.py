"""Results of others: published values, measurements and other programs, each with what its source leaves open."""
