"""Runs table.py for `python -m reports.verification.schemes.targets`."""

from reports.tables import command_line
from reports.verification.schemes.targets import table

if __name__ == "__main__":
    command_line(table.__doc__, table.main)
