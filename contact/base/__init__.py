"""What everything is on: errors, arrays that are read only, files of arrays of one format."""
