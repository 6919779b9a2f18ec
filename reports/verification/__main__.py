"""Runs table.py for `python -m reports.verification`."""

from reports.tables import command_line
from reports.verification import table

if __name__ == "__main__":
    command_line(table.__doc__, table.main)
