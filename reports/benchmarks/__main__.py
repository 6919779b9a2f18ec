"""Runs steps.py for `python -m reports.benchmarks`."""

from reports.benchmarks import steps
from reports.tables import command_line

if __name__ == "__main__":
    command_line(steps.__doc__, steps.main)
