"""What `python -m reports.robustness.broken` runs: table.py."""

from reports.robustness.broken import table
from reports.tables import command_line

if __name__ == "__main__":
    command_line(table.__doc__, table.main)
