"""What `python -m reports.rig` runs: chain.py."""

from reports.rig import chain
from reports.tables import command_line

if __name__ == "__main__":
    command_line(chain.__doc__, chain.main)
