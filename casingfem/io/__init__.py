"""Files: strict CSV, arrays that are read only, sets of files written whole or not at all."""
