"""Runs run.py for `python -m reports.tools.campaign`."""

import sys

from reports.tools.campaign.run import command_line

if __name__ == "__main__":
    sys.exit(command_line())
