"""What `python -m reports.mutants` runs: share.py."""

from reports.mutants.share import command_line, main

if __name__ == "__main__":
    main(command_line())
