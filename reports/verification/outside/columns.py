"""A row of the table of other people's results."""

from reports.tables import Row, check

KINDS = {
    "published": "printed in a paper or a standard",
    "measured": "measured",
    "program": "computed by another program",
}


def row(
    kind: str,
    case: str,
    source: str,
    value: float,
    ours: float,
    allowed: float,
    *,
    gap: float = 0.0,
    reason: str = "",
    open_: str = "",
) -> Row:
    """One comparison: kind of source, case, source, its value, ours, difference and allowed difference [%].

    `open_` is what the source leaves open. The verdict is "pass" within `allowed`, the `reason` up to `gap`, else FAIL.
    """
    found = check(case, source, value, ours, allowed, gap=gap, reason=reason)
    return {
        "kind": KINDS[kind],
        "case": case,
        "source": source,
        "value": found["reference"],
        "ours": found["computed"],
        "difference %": found["error %"],
        "allowed %": found["allowed %"],
        "verdict": found["verdict"],
        "the source leaves open": open_,
    }
