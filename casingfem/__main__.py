"""The command `casingfem`, and `python -m casingfem`."""

import os
from collections.abc import Mapping

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def run() -> None:
    """Run a command line; Ctrl-C while its modules are being imported is no traceback either."""
    try:
        os.environ.update(threads(os.environ))
        from casingfem.cli import main

        main()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


def threads(environment: Mapping[str, str]) -> dict[str, str]:
    """Settings for BLAS, which reads them when numpy is imported: one thread, unless the environment states otherwise.

    The matrices of a shell are small: more threads wait for each other, and where other programs run as well they wait
    long (six times the seconds for the modes of a casing on two busy cores).
    """
    chosen = {"OMP_NUM_THREADS", *THREADS} & set(environment)
    return {} if chosen else dict.fromkeys(THREADS, "1")


if __name__ == "__main__":
    run()
