"""All eigenvalues of a band: spectrum slicing (Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl. 15, 1994, 228).

The inertia at two shifts gives the number of eigenvalues between them. A slice with few enough eigenvalues is solved
about its middle until all are found, and a few beyond its ends. An end that is on an eigenvalue is moved outwards into
the first clear gap and counted again. The next slice starts where the last one ended.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from casingfem.errors import NumericsError
from casingfem.io.arrays import FloatArray
from casingfem.linalg.factor import Direct, factorise
from casingfem.linalg.krylov import BLOCKS, ConvergenceError, RitzPairs, nearest
from casingfem.linalg.memory import require_affordable
from casingfem.linalg.pencil import Pencil, clear_of_eigenvalues, round_off, warn_of_count

CLEAR = 1e-7  # eigenvalues closer than this, relative, are not parted
CLEARER = (CLEAR, 1e-5, 1e-3)  # the same, try by try: on a miss, a gap that no round-off bridges
MANY = 64  # eigenvalues of one slice
PLACES = (0.5, 0.47, 0.53, 0.44)  # where in a slice the shift may be


@dataclass(frozen=True, slots=True, eq=False)
class Slice:
    """All eigenvalues between two ends, ascending (k,), and their B-orthonormal vectors (n, k).

    `below` is the number below the upper end; `counted` is false if round-off of the eigenvalues reaches an end, so
    that no count there is reliable.
    """

    low: float
    high: float
    values: FloatArray
    vectors: FloatArray
    products: int
    below: int
    counted: bool


@dataclass(frozen=True, slots=True)
class End:
    """A position on the axis of eigenvalues and the number below it; `settled` ends are in a clear gap."""

    place: float
    below: int
    settled: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Counter:
    """Counts eigenvalues below positions; those below `floor` are zero up to round-off."""

    pencil: Pencil
    floor: float
    direct: Direct

    def width(self, place: float, clear: float = CLEAR) -> float:
        """Distance from a position within which an eigenvalue counts as on it."""
        return clear * max(abs(place), self.floor)

    def counted(self, place: float, way: float) -> End:
        """An end, moved in its direction (1 up, -1 down) so that a mode exactly there is included.

        Twice if another one is there.
        """
        for step in (1.0, 2.0):
            there = place + way * step * self.width(place)
            try:
                return End(there, self.pencil.count_below(there, self.direct))
            except NumericsError as error:
                singular = error
        raise singular

    def moved(self, end: End, values: FloatArray, way: float, clear: float) -> End:
        """The end itself or, if an eigenvalue is on it, a position in the first clear gap outwards.

        `values` ascend in the outward direction: `way` is 1 at an upper end, -1 at a lower one, for which they are
        negated.
        """
        place, width = way * end.place, self.width(end.place, clear)
        there = np.flatnonzero(np.abs(values - place) <= width)
        if end.settled or not len(there):
            return End(end.place, end.below, settled=True)
        last = int(there[-1])
        while last + 1 < len(values) and values[last + 1] - values[last] <= width:
            last += 1
        gap = values[last + 1] - values[last] if last + 1 < len(values) else 10.0 * width
        outside = way * float(values[last] + min(0.5 * gap, 5.0 * width))
        return End(outside, self.pencil.count_below(outside, self.direct), settled=True)


def slices(pencil: Pencil, low: float, high: float, shift: float, direct: Direct) -> Iterator[Slice]:
    """The slices of a band from low to high, ascending; from 0 they start at the negative shift, below all modes.

    Raises
    ------
    NumericsError
        If the number of eigenvalues found in a slice differs from its count.
    """
    counter = Counter(pencil, abs(shift), direct)
    start = End(shift, 0, settled=True) if low == 0.0 else counter.counted(low, -1.0)
    ends = [counter.counted(high, 1.0)]
    require_affordable(ends[0].below - start.below, pencil.size)
    while ends:
        end = ends[-1]
        if end.place <= start.place:  # the last slice had to reach beyond it
            ends.pop()
            continue
        if end.below - start.below > MANY and end.place - start.place > 1e-3 * abs(end.place):
            middle = 0.25 * (np.sqrt(max(start.place, 0.0)) + np.sqrt(end.place)) ** 2
            ends.append(counter.counted(middle, 1.0))
            continue
        found = solve_slice(counter, start, ends.pop())
        yield found
        start = End(found.high, found.below, settled=True)


def solve_slice(counter: Counter, start: End, end: End) -> Slice:
    """The eigenvalues between two ends, which move outwards if an eigenvalue is on them."""
    products = 0
    for block, clear in zip(BLOCKS, CLEARER, strict=True):  # a missed mode shows in the count: search again
        found = around_middle(counter, start, end, block, clear)
        products += found.products
        order = np.argsort(found.values)
        values, vectors = found.values[order], found.vectors[:, order]
        low, high = counter.moved(start, -values[::-1], -1.0, clear), counter.moved(end, values, 1.0, clear)
        between = (values > low.place) & (values < high.place)
        noise = round_off(counter.pencil.A, vectors)
        # nothing is counted at an end below all modes
        above = (end.place for end in (low, high) if end.place > 0.0)
        reached = [place for place in above if not clear_of_eigenvalues(place, values, noise)]
        part = Slice(low.place, high.place, values[between], vectors[:, between], products, high.below, not reached)
        if part.counted and np.count_nonzero(between) == high.below - low.below:
            return part
    if reached:
        warn_of_count(reached[-1], values, noise)
        return part
    ends = [f"{np.sqrt(max(place, 0.0)) / 2 / np.pi:.6g}" for place in (low.place, high.place)]
    raise NumericsError(f"{high.below - low.below} modes lie in {ends[0]} to {ends[1]} Hz, {between.sum()} were found")


def around_middle(counter: Counter, start: End, end: End, block: int, clear: float) -> RitzPairs:
    """All pairs of a slice, with those on its ends and their neighbours, from a shift near its middle."""
    pencil, low, high, products = counter.pencil, start.place, end.place, 0
    for place in PLACES:
        sigma = low + place * (high - low)
        radius = max(high - sigma + 10.0 * counter.width(high, clear), sigma - low + 10.0 * counter.width(low, clear))
        try:
            factor = factorise(pencil.shifted(sigma), counter.direct)
        except NumericsError:
            continue
        wanted = end.below - start.below + 4
        while True:
            try:
                found = nearest(pencil, factor.solve, sigma, min(wanted, pencil.modes), block)
            except ConvergenceError:
                break
            products += found.products
            reach = np.abs(found.values - sigma)
            if reach[0] < 1e-7 * radius:
                break  # the shift is on an eigenvalue: the others are lost in its round-off
            if wanted >= pencil.modes or reach[-1] > radius:
                return RitzPairs(values=found.values, vectors=found.vectors, products=products)
            wanted += max(8, wanted // 2)
    raise NumericsError(f"found no shift between {low:.6g} and {high:.6g} rad^2/s^2 that is far enough from every mode")
