"""Tables of study.toml: keys, types and ranges, all in SI."""
