"""What `python -m reports.contact.targets` runs: table.py."""

from reports.contact.targets import table
from reports.tables import command_line

if __name__ == "__main__":
    command_line(table.__doc__, table.main)
