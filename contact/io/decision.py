"""Whether a motion grows: the one decision of single runs, sweeps, tables of dangerous speeds and their pages."""


def decision(outcome: str | None, *, passed: bool) -> bool | None:
    """Whether a motion grows, from `RunGrowth.outcome` and whether it passed a limit; None if the run does not decide.

    `outcome` is None for a problem without one, such as two rods.

    >>> decision("grows", passed=False), decision("bounded", passed=True), decision("bounded", passed=False)
    (True, True, False)
    >>> decision("numerical", passed=True), decision("undecided", passed=False), decision(None, passed=False)
    (None, None, False)
    """
    if outcome == "numerical":
        return None
    if passed or outcome == "grows":
        return True
    return None if outcome == "undecided" else False
