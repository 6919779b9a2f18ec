"""Runs table.py for `python -m reports.verification.outside`."""

from reports.tables import command_line
from reports.verification.outside import table

if __name__ == "__main__":
    command_line(table.__doc__, table.main, calculix="run CalculiX and write its table")
