"""Locate loose bolts or added masses from the splits and shifts of many pairs at once.

One loose bolt at theta adds a vector along (cos 2 n theta, sin 2 n theta) to the split vector of a pair, so several n
distinguish places that one n does not. No frequency and no orientation can distinguish theta from theta + pi, since
rotation of the casing by half a turn gives the same table. Such images are listed with every result; shapes measured
around the rim decide between them (`shape_check.py`).
"""

from dataclasses import replace

import numpy as np

from casingfem.errors import ModelError
from casingfem.experiment.correlation.frequency_unit import refuse_unpaired
from casingfem.experiment.correlation.matches import modes_of, unpaired_words
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray
from casingfem.locate.explanations import (
    bolted_edge,
    bolts_explained,
    factors_of,
    groups_alike,
    loosening,
    masses_explained,
    significant_masses,
    visible,
)
from casingfem.locate.located import Localisation
from casingfem.locate.mass_places import refined, search_masses
from casingfem.locate.misfit import Misfit, half_split, widened
from casingfem.locate.sparse_search import scale2, search
from casingfem.modal.affine import AffineModel, affine_model, bolt_changes, mass_changes
from casingfem.modal.modes import count_below
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.shell import Shell, require_shell
from casingfem.structure.shell.variation import outer_supports
from casingfem.updating.calibration import calibrated, paired_baseline

AMONG = ("bolts", "mass")
TWO_PI = 2.0 * np.pi
EDGE = "top"  # where masses are searched for by default
PLACES = 48  # candidates for masses around an edge
LEAST = 0.1  # of a bolt's stiffness: bolts that have lost less are as they come
REDUCED = 2.2  # modes in the basis for each mode compared


def search_model(
    shell: Shell, table: FrequencyTable, *, among: str = "bolts", edge: str | None = None, places: int = PLACES
) -> tuple[AffineModel, FloatArray]:
    """The reduced model that `cf.locate` searches, made once for many tables.

    Parameters
    ----------
    shell
        The casing as designed.
    table
        The table with the highest frequency of all.
    among, edge
        As in `cf.locate`.
    places
        Number of candidate angles of a mass.

    Returns
    -------
    tuple[AffineModel, FloatArray]
        The argument `model` of `cf.locate`: the reduced model, and the angles [rad] of the candidates.

    Raises
    ------
    ModelError
        locate-among, locate-bolts or locate-edge.

    Examples
    --------
    >>> import casingfem as cf
    >>> steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = cf.Shell(
    ...     chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, material=steel,
    ...     mesh=cf.ShellMesh(order=5, rows=1, around=7), supports={"base": cf.Bolts(count=7, k=2e8)},
    ... )
    >>> table = cf.FrequencyTable.from_arrays(freq_hz=[500.0], sigma_hz=0.1)
    >>> model, angles = cf.search_model(casing, table)
    >>> angles.size
    7
    """
    if among not in AMONG:
        raise ModelError("locate-among", f"locate among {among!r}")
    edge = edge or (bolted_edge(shell) if among == "bolts" else EDGE)
    if edge not in shell.chart.edges or shell.chart.edges[edge][0] != 0 or not shell.chart.periodic:
        raise ModelError("locate-edge", f"edge: found {edge!r}, expected an edge that runs around a closed casing")
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

    Rows that pair with no mode of the best explanation are listed (`unpaired`), and the search is repeated without
    them. Rows of the baseline that pair with no mode of the casing as designed are also listed and left out.

    Parameters
    ----------
    shell
        The casing as designed: its bolts tight, without the mass.
    table
        Its current frequencies, with n, and orientations if known.
    baseline
        The table measured before; without it manufacturing deviations look like damage.
    among
        "bolts" or "mass".
    edge
        Edge to search; by default the bolted edge, or the top for masses.
    most
        Largest number of places.
    level
        Probability of a false alarm in a table with only noise.
    angle_sigma
        Standard deviation of n psi [rad], psi a measured orientation.
    model_error
        Relative error of the model in each frequency; without a baseline use the size of its splits.
    model
        Result of `cf.search_model`, for searches of many tables.

    Raises
    ------
    ModelError
        locate-among, locate-bolts, locate-edge, locate-unlabelled; locate-baseline if the baseline lacks pairs.
    InputError
        No row of the table pairs with a mode.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3,
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=7, rows=1, around=14), supports={"base": cf.Bolts(count=7, k=2e8)})
    >>> loose = cf.modes(cf.updating.with_value(casing, "support.base.bolts.2.k", 6e7), 6)
    >>> table = cf.FrequencyTable.from_arrays(freq_hz=loose.freq, sigma_hz=0.05, n=loose.nodal_diameters)
    >>> found = locate(casing, table, most=1)
    >>> [round(one.value, 2) for one in found.found]  # 0.3 of 2e8 N/m is left; without angles the bolts are alike
    [0.3]
    """
    require_shell(shell, "locate")
    check_labelled(table)
    designed, angles = model or search_model(shell, table, among=among, edge=edge)
    reduced, measured, left_out, c = designed, table, tuple[int, ...](), 0.0
    if baseline is not None:
        check_labelled(baseline)
        try:
            tight, pairing = paired_baseline(designed, baseline)
            left_out, c = modes_of(baseline, pairing.unpaired_rows), half_split(tight, baseline, pairing.matches)
            baseline = baseline.without(*left_out)
            reduced = calibrated(designed, baseline)
            table = with_baseline_noise(table, baseline, c)
        except ValueError as error:
            raise ModelError("locate-baseline", f"baseline: {error}") from None
    count = min(len(reduced.nominal), round(len(reduced.nominal) / REDUCED) + 4)
    misfit = Misfit(model=reduced, table=table, count=count, angle_sigma=angle_sigma, model_error=model_error)
    start = misfit.at(np.zeros(reduced.changes))
    if not len(start.values):
        refuse_unpaired(table, start.modes.freq, start.modes.nodal_diameters, misfit.reach)
    if among == "bolts":
        bounds = loosening(factors_of(reduced))
        active, point = search(misfit.at, bounds, most=most, level=level, least=LEAST)
        if baseline is not None and active:  # again, with the uncertainty of the couplings that these bolts show
            wider = widened(table, reduced, start.modes, point.modes, c, misfit.reach)
            misfit = replace(misfit, table=wider)
            active, point = search(misfit.at, bounds, most=most, level=level, least=LEAST)
        explained = bolts_explained(misfit, active, point, angles)
    else:
        edge = edge or EDGE
        masses = search_masses(misfit, edge, angles, most=most, level=level)
        if len(masses.masses):  # responses of the casing to masses at these angles
            changes = mass_changes(reduced.system, edge, np.concatenate([masses.angles, masses.angles + np.pi]))
            exact = affine_model(reduced.system, changes, len(reduced.nominal), reduced.nominal)
            misfit = replace(misfit, model=exact if baseline is None else calibrated(exact, baseline))
            masses = significant_masses(misfit, edge, refined(misfit, edge, masses.angles, masses.masses))
        point, explained = masses.point, masses_explained(misfit, edge, masses, len(angles))
    if 0 < len(point.lost) < len(table):
        unpaired = modes_of(table, point.lost)
        rest = measured.without(*unpaired)
        check_labelled(rest, unpaired)
        found = locate(
            shell, rest, baseline=baseline, among=among, edge=edge, most=most, level=level, angle_sigma=angle_sigma,
            model_error=model_error, model=(designed, angles),
        )  # fmt: skip
        return replace(found, unpaired=tuple(sorted({*unpaired, *found.unpaired})))
    free = len(explained[0].found) * (1 if among == "bolts" else 2)
    scale = float(np.sqrt(scale2(point, free)))
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
        unpaired=modes_of(table, point.lost),
        baseline_unpaired=left_out,
    )


def with_baseline_noise(table: FrequencyTable, baseline: FrequencyTable, c: float) -> FrequencyTable:
    """The table with the uncertainty of a baseline added to its sigma.

    It contains the noise of the baseline, and the effect of couplings between different n. Manufacturing makes these as
    large as half the relative splits, c: they move modes of another n at a distance D by (c f)^2/D, or by c f if
    closer.
    """
    noise = float(np.sqrt(np.mean((baseline.sigma_hz / baseline.freq_hz) ** 2)))
    apart = np.abs(table.freq_hz[:, None] - table.freq_hz)
    apart[table.n[:, None] == table.n] = np.inf
    own = c * table.freq_hz
    coupled = own**2 / np.maximum(apart.min(axis=1), own) if c else 0.0
    return replace(table, sigma_hz=np.sqrt(table.sigma_hz**2 + (noise * table.freq_hz) ** 2 + coupled**2))


def check_labelled(table: FrequencyTable, unpaired: tuple[int, ...] = ()) -> None:
    """Refuse a table without doublets that have n; `unpaired` are the mode numbers of its omitted rows."""
    if not any(len(group.rows) == 2 for group in table.groups()):
        why = "; ".join([f"{table.path}: found no doublet with nodal diameters", *unpaired_words(unpaired)])
        raise ModelError("locate-unlabelled", why)
