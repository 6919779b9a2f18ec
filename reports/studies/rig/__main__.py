"""Runs chain.py for `python -m reports.studies.rig`."""

from reports.studies.rig import chain
from reports.tables import command_line

if __name__ == "__main__":
    command_line(chain.__doc__, chain.main)
