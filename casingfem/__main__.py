"""The command `casingfem`, and `python -m casingfem`."""

import gc
import os
from collections.abc import Mapping

OBJECTS = 10_000  # new objects between two passes of the garbage collector, which with Python's 700 are many in imports
THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def run() -> None:
    """Run a command line; Ctrl-C during imports also ends it without a traceback.

    At its end nothing is left to collect: what lives goes with the process. Without `gc.freeze`, Python examines all
    objects once more, which takes some tenths of a second.
    """
    gc.set_threshold(OBJECTS)
    try:
        os.environ.update(threads(os.environ))
        from casingfem.cli import main

        main()
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    finally:
        gc.freeze()


def threads(environment: Mapping[str, str]) -> dict[str, str]:
    """Settings that BLAS reads when numpy is imported: one thread, unless the environment states otherwise.

    The matrices of a shell are small, so several threads mostly wait for each other. On two busy cores the modes of a
    casing take six times as long with them.
    """
    chosen = {"OMP_NUM_THREADS", *THREADS} & set(environment)
    return {} if chosen else dict.fromkeys(THREADS, "1")


if __name__ == "__main__":
    run()
