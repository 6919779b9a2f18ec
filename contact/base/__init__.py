"""What everything stands on: errors, arrays that are read only."""
