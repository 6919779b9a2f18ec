"""Which bolts are loose, or where mass was added: from the splits and shifts of many pairs at once.

One loose bolt at theta adds to the split vector of a pair a part along (cos 2 n theta, sin 2 n theta): several n tell
places apart that one n does not. No frequency and no orientation can tell theta from theta + pi: turned by half a
turn the casing has the same table. Such twins are listed with every answer; shapes measured around the rim decide
between them (`shape_check.py`).
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from casingfem.errors import ModelError
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.locate.located import Explanation, Found, Localisation
from casingfem.locate.mass_places import Masses, refined, search_masses
from casingfem.locate.misfit import Misfit, Point
from casingfem.locate.sparse_fit import Bounds, fitted
from casingfem.locate.sparse_search import scale2, search, threshold
from casingfem.locate.unknown_coupling import half_split, widened
from casingfem.modal.affine import AffineModel, affine_model, bolt_changes, mass_changes
from casingfem.modal.modes import count_below
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell, require_shell
from casingfem.structure.shell.variation import outer_supports
from casingfem.updating.calibration import calibrated

AMONG = ("bolts", "mass")
EDGE = "top"  # where masses are looked for unless told
TWO_PI = 2.0 * np.pi
PLACES = 48  # candidates for masses around an edge
LEAST = 0.1  # of a bolt's stiffness: bolts that have lost less are as they come
REDUCED = 2.2  # modes in the basis for each mode compared
LIKELY = 9.0  # alternatives whose chi^2/s^2 is within this of the best are listed: 3 sigma
TWINS = 4  # places whose half turns are all tried: 2^4 combinations


def bolted_edge(shell: Shell) -> str:
    """The one edge with bolts.

    Raises
    ------
    ModelError
        locate-bolts.
    """
    edges = [edge for edge, support in outer_supports(shell).items() if isinstance(support, Bolts)]
    if len(edges) != 1:
        raise ModelError("locate-bolts", f"locate among bolts: {len(edges)} edges of the structure have bolts")
    return edges[0]


def search_model(
    shell: Shell, table: FrequencyTable, *, among: str = "bolts", edge: str | None = None, places: int = PLACES
) -> tuple[AffineModel, FloatArray]:
    """The reduced model that a search needs, and the candidates' angles [rad]; it serves many tables.

    Raises
    ------
    ModelError
        locate-among, locate-bolts, locate-edge.
    """
    if among not in AMONG:
        raise ModelError("locate-among", f"locate among {among!r}")
    edge = edge or (bolted_edge(shell) if among == "bolts" else EDGE)
    if edge not in shell.chart.edges or shell.chart.edges[edge][0] != 0 or not shell.chart.periodic:
        raise ModelError("locate-edge", f"locate on the edge {edge!r}")
    wanted = count_below(shell, 1.1 * float(table.freq_hz.max())) + 6
    system = assemble(shell)
    if among == "bolts":
        bolts = outer_supports(shell)[edge]
        assert isinstance(bolts, Bolts)
        angles, changes = bolts.angles, bolt_changes(system, edge)
    else:
        angles = TWO_PI * np.arange(places) / places
        changes = mass_changes(system, edge, angles)
    return affine_model(system, changes, min(round(REDUCED * wanted), system.size // 4)), angles


def locate(
    shell: Shell,
    table: FrequencyTable,
    *,
    baseline: FrequencyTable | None = None,
    among: str = "bolts",
    edge: str | None = None,
    most: int = 4,
    level: float = 0.01,
    angle_sigma: float = 0.01,
    model_error: float = 0.0,
    model: tuple[AffineModel, FloatArray] | None = None,
) -> Localisation:
    """Find which bolts are loose, or where mass was added.

    Parameters
    ----------
    shell
        The casing as designed: its bolts tight, without the mass.
    table
        Its frequencies now, with n; orientations where they are known.
    baseline
        The same measured before; without it manufacture looks like damage.
    among
        "bolts" or "mass".
    edge
        Where to look; the bolted edge, or the top for masses.
    most
        Largest number of places.
    level
        Probability of a false alarm in a table that holds nothing but noise.
    angle_sigma
        Standard deviation of n psi [rad], psi a measured orientation.
    model_error
        What the model may be off by, relative, in each frequency; take the size of its splits without a baseline.
    model
        What `search_model` gave, when many tables are searched.

    Raises
    ------
    ModelError
        locate-among, locate-bolts, locate-edge, locate-unlabelled; locate-baseline where the baseline lacks pairs.
    """
    require_shell(shell, "locate")
    check_labelled(table)
    reduced, angles = model or search_model(shell, table, among=among, edge=edge)
    if baseline is not None:
        check_labelled(baseline)
        try:
            reduced = calibrated(reduced, baseline)
            table = with_baseline_noise(table, baseline)
        except ValueError as error:
            raise ModelError("locate-baseline", f"baseline: {error}") from None
    count = min(len(reduced.nominal), round(len(reduced.nominal) / REDUCED) + 4)
    misfit = Misfit(model=reduced, table=table, count=count, angle_sigma=angle_sigma, model_error=model_error)
    start = misfit.at(np.zeros(reduced.changes))
    if among == "bolts":
        bounds = loosening(factors_of(reduced))
        active, point = search(misfit.at, bounds, most=most, level=level, least=LEAST)
        if baseline is not None and active:  # again, with what the couplings that these bolts show leave unknown
            wider = widened(table, reduced, start.modes, point.modes, half_split(baseline), misfit.reach)
            misfit = replace(misfit, table=wider)
            active, point = search(misfit.at, bounds, most=most, level=level, least=LEAST)
        explained = bolts_explained(misfit, active, point, angles)
    else:
        edge = edge or EDGE
        masses = search_masses(misfit, edge, angles, most=most, level=level)
        if len(masses.masses):  # the casing's own answers to masses just there
            changes = mass_changes(reduced.system, edge, np.concatenate([masses.angles, masses.angles + np.pi]))
            exact = affine_model(reduced.system, changes, len(reduced.nominal), reduced.nominal)
            misfit = replace(misfit, model=exact if baseline is None else calibrated(exact, baseline))
            masses = significant_masses(misfit, edge, refined(misfit, edge, masses.angles, masses.masses))
        point, explained = masses.point, masses_explained(misfit, edge, masses, len(angles))
    scale = float(np.sqrt(scale2(point, len(explained[0].found))))
    return Localisation(
        among=among,
        angles_deg=np.degrees(angles),
        best=explained[0],
        others=explained[1:],
        chi2=point.chi2,
        chi2_start=start.chi2,
        rows=len(point.values),
        scale=scale,
        smallest=visible(start, level, scale),
        alike=groups_alike(start.jacobian),
        calibrated=baseline is not None,
        misfit=misfit,
    )


def with_baseline_noise(table: FrequencyTable, baseline: FrequencyTable) -> FrequencyTable:
    """The table with what a baseline leaves unknown added to its sigma.

    The noise of the baseline itself; and the couplings of different n, which manufacture makes as large as it makes
    splits: c, the baseline's rms half split, moves modes of another n at a distance D by c^2/D, or c if nearer.
    """
    noise = float(np.sqrt(np.mean((baseline.sigma_hz / baseline.freq_hz) ** 2)))
    pairs = [baseline.freq_hz[list(group.rows)] for group in baseline.groups() if len(group.rows) == 2]
    c = float(np.sqrt(np.mean([(0.5 * np.ptp(pair)) ** 2 for pair in pairs]))) if pairs else 0.0
    apart = np.abs(table.freq_hz[:, None] - table.freq_hz)
    apart[table.n[:, None] == table.n] = np.inf
    coupled = c**2 / np.maximum(apart.min(axis=1), c) if c else 0.0
    return replace(table, sigma_hz=np.sqrt(table.sigma_hz**2 + (noise * table.freq_hz) ** 2 + coupled**2))


def check_labelled(table: FrequencyTable) -> None:
    """Refuse a table without doublets that have n."""
    if not any(len(group.rows) == 2 for group in table.groups()):
        raise ModelError("locate-unlabelled", f"{table.path}: found no doublet with nodal diameters")


def loosening(factors: FloatArray) -> Bounds:
    """A bolt can lose all that it has: `factors` of a tight one's stiffness, (bolts,)."""
    return Bounds(lower=-factors, upper=np.zeros(len(factors)))


def factors_of(model: AffineModel) -> FloatArray:
    """What the bolts of a model have of a tight one's stiffness, (bolts,)."""
    shell = model.system.shell
    bolts = outer_supports(shell)[bolted_edge(shell)]
    assert isinstance(bolts, Bolts)
    return np.asarray(bolts.factors)


def sigmas(jacobian: FloatArray, scale: float) -> FloatArray:
    """Standard deviations of fitted values; large where the data hardly see them."""
    if not jacobian.shape[1]:
        return np.zeros(0)
    information = jacobian.T @ jacobian
    floor = 1e-14 * np.trace(information) * np.eye(len(information))
    return np.asarray(scale * np.sqrt(np.diag(np.linalg.inv(information + floor))))


def turned_place(place: int, angles: FloatArray) -> int | None:
    """The candidate half a turn away, None where there is none."""
    apart = np.abs(np.angle(np.exp(1j * (angles - angles[place] - np.pi))))
    return int(apart.argmin()) if apart.min() < 1e-6 else None


def bolts_explained(misfit: Misfit, active: Sequence[int], point: Point, angles: FloatArray) -> tuple[Explanation, ...]:
    """The bolts found, then what the table does not rule out: some of them half a turn away."""
    s2 = scale2(point, len(active))
    factors, degrees = factors_of(misfit.model), np.degrees(angles) % 360.0
    bounds = loosening(factors)

    def explanation(at: Point, on: list[int]) -> Explanation:
        spread = np.minimum(sigmas(at.jacobian[:, on], np.sqrt(s2)), 1.0)
        found = [
            Found(place=c + 1, angle_deg=float(degrees[c]), value=float(factors[c] + at.x[c]), sigma=float(s))
            for c, s in zip(on, spread, strict=True)
        ]
        return Explanation(found=tuple(found), behind=float((at.chi2 - point.chi2) / s2))

    listed = []
    for choice in half_turns(len(active)):
        places = [turned_place(c, angles) if turn else c for c, turn in zip(active, choice, strict=True)]
        on = sorted(place for place in places if place is not None)
        if len(set(on)) < len(active) or on == sorted(active):
            continue
        x = np.zeros(len(point.x))
        x[[place for place in places if place is not None]] = point.x[list(active)]
        listed.append(explanation(fitted(misfit.at, misfit.at(x), on, bounds), on))
    return (explanation(point, list(active)), *likely(listed))


def masses_explained(misfit: Misfit, edge: str, best: Masses, candidates: int) -> tuple[Explanation, ...]:
    """The masses found, then the same with some of them half a turn away that the table does not rule out."""
    s2 = scale2(best.point, 2 * len(best.masses))

    def explanation(at: Masses) -> Explanation:
        by_mass, by_angle = np.split(sigmas(at.jacobian, np.sqrt(s2)), 2)
        degrees = np.degrees(at.angles) % 360.0
        found = [
            Found(
                place=round(degrees[k] / 360.0 * candidates) % candidates + 1,
                angle_deg=float(degrees[k]),
                value=float(at.masses[k]),
                sigma=float(by_mass[k]),
                angle_sigma_deg=float(np.degrees(by_angle[k])),
            )
            for k in np.argsort(degrees)
        ]
        return Explanation(found=tuple(found), behind=float((at.point.chi2 - best.point.chi2) / s2))

    listed = [
        explanation(refined(misfit, edge, best.angles + np.pi * np.array(choice), best.masses))
        for choice in half_turns(len(best.masses))
        if any(choice)
    ]
    return (explanation(best), *likely(listed))


def significant_masses(misfit: Misfit, edge: str, masses: Masses) -> Masses:
    """Without the masses that are not three standard deviations from nothing."""
    while len(masses.masses):
        spread = sigmas(masses.jacobian, np.sqrt(scale2(masses.point, 2 * len(masses.masses))))
        kept = masses.masses > 3.0 * spread[: len(masses.masses)]
        if kept.all():
            break
        masses = refined(misfit, edge, masses.angles[kept], masses.masses[kept])
    return masses


def half_turns(count: int) -> list[tuple[bool, ...]]:
    """Which of so many places are turned by half a turn: all choices, none of them first; none for too many."""
    return list(product((False, True), repeat=count)) if count <= TWINS else []


def likely(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Those within reach of the best, the likeliest first."""
    return sorted((e for e in explanations if e.behind < LIKELY), key=lambda e: e.behind)


def visible(point: Point, level: float, scale: float) -> FloatArray:
    """What each change alone must be to exceed the threshold, to first order, (changes,)."""
    lengths = np.linalg.norm(point.jacobian, axis=0)
    needed = threshold(level, len(lengths), len(point.values), 1)
    return np.asarray(scale * np.sqrt(needed) / np.where(lengths > 0.0, lengths, np.nan))


def groups_alike(jacobian: FloatArray, level: float = 0.999) -> tuple[tuple[int, ...], ...]:
    """Groups of places (numbers from 1) whose effects on the table are parallel, one per group of two or more."""
    norms = np.linalg.norm(jacobian, axis=0)
    J = jacobian / np.where(norms > 0.0, norms, 1.0)
    cosine = J.T @ J
    groups: list[tuple[int, ...]] = []
    waiting = list(range(len(norms)))
    while waiting:
        first = waiting[0]
        group = [c for c in waiting if cosine[first, c] > level or c == first]
        waiting = [c for c in waiting if c not in group]
        if len(group) > 1:
            groups.append(tuple(c + 1 for c in group))
    return tuple(groups)
