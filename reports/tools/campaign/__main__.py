"""What `python -m reports.tools.campaign` runs: run.py."""

import sys

from reports.tools.campaign.run import command_line

if __name__ == "__main__":
    sys.exit(command_line())
