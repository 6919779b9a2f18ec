"""The command `casingfem`, and `python -m casingfem`."""


def run() -> None:
    """Run a command line; Ctrl-C while its modules are being imported is no traceback either."""
    try:
        from casingfem.cli import main

        main()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == "__main__":
    run()
