"""Runs share.py for `python -m reports.tools.mutants`."""

from reports.tools.mutants.share import command_line, main

if __name__ == "__main__":
    main(command_line())
