"""Is what is asked for within reach? Hours and gigabytes are said before they are spent."""

from casingfem.errors import ModelError

MOST = 2e8  # modes times unknowns: an hour or so, 1.6 GB of shapes
MODES = 1000.0  # asked for at once: below, whatever the unknowns, nobody is stopped


def require_affordable(modes: float, unknowns: int, what: str = "modes") -> None:
    """Refuse more modes at once than an hour's work gives.

    Raises
    ------
    ModelError
        `modes-count`, with the number of modes, of unknowns, and what they would cost.

    >>> require_affordable(1e5, 16_000)
    Traceback (most recent call last):
        ...
    casingfem.errors.ModelError: modes: some 1e+05 of 16000 unknowns, hours of work and 13 GB of shapes, expected at \
most 12500 at once, or band after band: ask for at least 1 and far fewer than the mesh has unknowns [modes-count]
    """
    most = max(MOST / unknowns, MODES)
    if not modes <= most:
        cost = f"hours of work and {8e-9 * modes * unknowns:.2g} GB of shapes"
        found = f"{what}: some {modes:.3g} of {unknowns} unknowns, {cost}"
        raise ModelError("modes-count", f"{found}, expected at most {most:.0f} at once, or band after band")
