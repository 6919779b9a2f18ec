"""What `python -m reports.studies.rig` runs: chain.py."""

from reports.studies.rig import chain
from reports.tables import command_line

if __name__ == "__main__":
    command_line(chain.__doc__, chain.main)
