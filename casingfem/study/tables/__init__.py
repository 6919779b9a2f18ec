"""Which keys has a table of study.toml, of which type and range? All SI."""
