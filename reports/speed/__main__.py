"""What `python -m reports.speed` runs: steps.py."""

from reports.speed import steps
from reports.tables import command_line

if __name__ == "__main__":
    command_line(steps.__doc__, steps.main)
