"""Mutants of the packages: random draws, and their sources."""

import fnmatch
import random
import types
import warnings
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from reports.tools.mutants.sites import Site, sites

PER_FUNCTION = 2


@dataclass(frozen=True, slots=True)
class Mutant:
    """A source with one piece changed; `after` is the line as it is then."""

    file: str
    line: int
    start: int
    end: int
    new: str
    function: str
    before: str
    after: str

    def source(self, text: str) -> str:
        """The whole source, changed."""
        lines = text.splitlines(keepends=True)
        row = lines[self.line - 1]
        lines[self.line - 1] = row[: self.start] + self.new + row[self.end :]
        return "".join(lines)


def mutant(file: str, text: str, site: Site, new: str) -> Mutant | None:
    """The source with a site changed; None if that is not valid Python, or compiles to the same code."""
    row = text.splitlines()[site.line - 1]
    after = row[: site.start] + new + row[site.end :]
    made = Mutant(file, site.line, site.start, site.end, new, site.function, row.strip(), after.strip())
    try:
        same = does(made.source(text)) == does(text)
    except SyntaxError:
        return None
    return None if same else made


def does(source: str) -> object:
    """Compiled code of a source, independent of its file."""

    def whole(code: types.CodeType) -> tuple[object, ...]:
        constants = [whole(c) if isinstance(c, types.CodeType) else (type(c), repr(c)) for c in code.co_consts]
        return code.co_code, constants, code.co_names, code.co_varnames, code.co_exceptiontable

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # such as of `1 is not 2`
        return whole(compile(source, "", "exec", dont_inherit=True))


def draw(sources: dict[str, str], seed: int, count: int, only: str = "*") -> list[Mutant]:
    """Mutants at random over all sites, at most two of one function; a smaller `count` draws the first of them."""
    pool = [(file, site) for file in sorted(sources) if fnmatch.fnmatch(file, only) for site in sites(sources[file])]
    rng = random.Random(seed)
    rng.shuffle(pool)
    taken: Counter[tuple[str, str]] = Counter()
    drawn: list[Mutant] = []
    for file, site in pool:
        if len(drawn) == count:
            break
        made = mutant(file, sources[file], site, rng.choice(site.choices))
        if made is not None and taken[file, site.function] < PER_FUNCTION:
            taken[file, site.function] += 1
            drawn.append(made)
    return drawn


def read_sources(root: Path, packages: Iterable[str], without: str) -> dict[str, str]:
    """Sources of packages by their path below the root, those of `without`, a pattern, left out."""
    files = {path.relative_to(root).as_posix(): path for name in packages for path in (root / name).rglob("*.py")}
    return {file: path.read_text("utf-8") for file, path in files.items() if not fnmatch.fnmatch(file, without)}
