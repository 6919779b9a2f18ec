"""`python -m casingfem`: the command line."""

from casingfem.cli import main

if __name__ == "__main__":
    main()
