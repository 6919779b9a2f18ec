"""What `python -m reports.campaign` runs: run.py."""

import sys

from reports.campaign.run import command_line

if __name__ == "__main__":
    sys.exit(command_line())
