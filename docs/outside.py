"""The page of the results of others: `.venv/bin/python docs/outside.py` writes docs/outside.md from two kept tables."""

import csv
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE / "outside.md"
HEAD = """# Results of others

Made by `.venv/bin/python docs/outside.py` from two tables. `python -m reports.verification.outside` computes the
[first](outside.csv): values from papers, measurements and other programs. `python -m reports.verification` computes the
[second](verification.csv), which has closed forms and standards too.

A row passes if the difference lies within the accuracy that its source states or that its digits allow. Otherwise the
verdict states the reason.
"""
KINDS = {
    "printed in a paper or a standard": "Published values",
    "measured": "Measurements",
    "computed by another program": "Other programs",
}
PUBLISHED = (
    "Carpenter et al. 1991", "Doyen et al. 2011", "Fox, first order", "MacNeal & Harder", "NAFEMS", "NAFEMS, printed",
    "Wright et al., Hodges & Rutkowski", "thin ring, Blevins",
)  # fmt: skip
APART = """
## What cannot be compared

| result | why not |
|---|---|
| interaction speeds and response curves of rotors 37 and 67 in rub studies (Batailly, Colaitis, Nyssen, Piollet, \
Thouverez, Vadcard and co-workers) | A search of open texts found no table of frequencies or speeds whose mesh, \
root, clearance, damping and coating are all stated. The bar before an obstacle above is by the same authors. |
| measured cylinders of Sewall and Naumann | A search found no open text with their tables. |
| blades of Krause | A search found no open text with them. |
| thick cylinder of Singhal, Guan and Williams (2002) | A search found the summary, without sizes and frequencies: \
finite elements within 4.05 % of the test. |
| a measured Tibetan bowl (Essl and Cook, 2002) | The source gives ratios of frequencies and no geometry. |
| tuning fork of CoFEA | The licence of its meshes forbids copies here. `casingfem modes` on three of them gave \
441.103 Hz (quadratic bricks, 2 mm), 496.880 Hz (linear bricks) and 564.488 Hz (linear tetrahedra); Code_Aster has \
441.10, 496.87 and 564.48 Hz. |
| composite cylinder Z11 with free axial motion at its ends (Castro and others, 2014; pyfe3d) | The only printed \
frequencies are those of a coarse mesh, 40 cells around. No support leaves the axial motion of a clamped edge free. \
|
| rotors of code_aster (V2.06) | The manual names another program as its source; the search found no frequencies. |
"""


def read(name: str) -> list[dict[str, str]]:
    """Rows of a kept table."""
    with (HERE / name).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def number(text: str, digits: int = 4) -> str:
    """A value of a table as the page shows it."""
    return f"{float(text):.{digits}g}"


def section(title: str, rows: list[dict[str, str]]) -> str:
    """The rows of one kind."""
    lines = [
        f"\n## {title}\n",
        "| case | source | value | ours | difference | allowed | verdict | the source leaves open |",
    ]
    lines.append("|---|---|---|---|---|---|---|---|")
    lines += [
        f"| {one['case']} | {one['source']} | {number(one['value'], 6)} | {number(one['ours'], 6)} | "
        f"{number(one['difference %'], 2)} % | {number(one['allowed %'], 2)} % | {one['verdict']} | "
        f"{one['the source leaves open'] or '–'} |"
        for one in rows
    ]
    return "\n".join(lines) + "\n"


def standards(rows: list[dict[str, str]]) -> str:
    """Published sources of the second table: rows, how many pass, the largest difference, reasons."""
    lines = [
        "\n## Published values in the table of verification\n",
        "| source | rows | pass | largest difference | reasons |",
    ]
    lines.append("|---|---|---|---|---|")
    for source in PUBLISHED:
        part = [one for one in rows if one["source"] == source]
        passed = sum(one["verdict"] == "pass" for one in part)
        worst = max(abs(float(one["error %"])) for one in part)
        reasons = {one["verdict"].partition(":")[0] for one in part if one["verdict"] != "pass"}
        lines.append(f"| {source} | {len(part)} | {passed} | {worst:.2g} % | {'; '.join(sorted(reasons)) or '–'} |")
    return "\n".join(lines) + "\n"


def page() -> str:
    """The page as text."""
    rows = read("outside.csv")
    passed = sum(one["verdict"] == "pass" for one in rows)
    count = f"\nOf {len(rows)} rows, {passed} pass and {len(rows) - passed} have a reason.\n"
    kinds = [section(title, [one for one in rows if one["kind"] == kind]) for kind, title in KINDS.items()]
    return HEAD + count + "".join(kinds) + standards(read("verification.csv")) + APART


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
