"""The objects on the virtual test bench: a casing and a blade whose models the updater does not have. SYNTHETIC.

The casing is that of data/studies/rig_test.toml with its true radius put in place of the survey's fit: harmonics up to
32, each with a trend along the axis. The blade is thicker at its root than at its tip, of another steel, and its root
gives way.
"""

from dataclasses import dataclass, replace

import numpy as np

import casingfem as cf
from casingfem.experiment.circle.lines import clear_rate
from casingfem.experiment.circle.pair import Pair, split_pair
from casingfem.experiment.rig.estimate import estimate
from casingfem.experiment.rig.excitation import Impact
from casingfem.experiment.rig.record import measured, record
from casingfem.experiment.rig.scan import Scan, Tone, Turning, scan
from casingfem.experiment.rig.structure import damping_spread
from casingfem.study import Study, load_shell_study
from casingfem.study.rig import RigTest, run_rig
from reports.studies.rig.synthetic import SEED as SURVEYED
from reports.studies.rig.synthetic import true_radius
from reports.tables import DATA

SEED = 20614
FS, SECONDS, TURNS, ORDERS = 2048.0, 20.0, 2.71, 16  # of the scans
BLADE_MODES = 14
COARSE, FEW = cf.ShellMesh(order=6, rows=1, around=24), 6  # quick: a bolt to each element; blocks of the record


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BladeTest:
    """Responses of a blade to a hammer at its tip, and the true model behind them."""

    frfs: cf.frf.FrfSet
    truth: cf.FrequencyTable


def casing_study(quick: bool) -> Study:
    """The study of the casing on the bench."""
    study = load_shell_study(DATA / "studies" / "rig_test.toml")
    radius = true_radius(np.random.default_rng(SURVEYED))
    shell = replace(study.shell, radius_defect=radius)
    if not quick:
        return replace(study, shell=shell)
    assert study.file.rig is not None
    assert study.file.rig.test is not None
    short = study.file.rig.test.model_copy(update={"blocks": FEW})
    file = study.file.model_copy(update={"rig": study.file.rig.model_copy(update={"test": short})})
    return replace(study, shell=replace(shell, mesh=COARSE), file=file)


def casing_test(quick: bool) -> RigTest:
    """The casing's test as the study describes it: two shakers, 36 laser spots, one circle scan."""
    return run_rig(casing_study(quick))


def scan_at(test: RigTest, snr_db: float | None, tones: list[float], seed: int = SEED) -> Scan:
    """A scan of the casing at other tones and noise: the first shaker, the study's circle, a rate that suits."""
    rate = clear_rate(tones, np.arange(-ORDERS, ORDERS + 1), TURNS, SECONDS, FS)
    if rate is None:
        raise cf.errors.InputError(
            f"no rate near {TURNS} turns/s keeps the lines of {len(tones)} tones apart in {SECONDS:g} s"
        )
    return scan(
        test.rig,
        Turning(mirror=rate),
        [Tone(tone) for tone in tones],
        circle=test.layout.circle,
        drive=0,
        fs=FS,
        seconds=SECONDS,
        seed=seed,
        snr_db=snr_db,
    )


def pair_from_scan(test: RigTest, n: int, snr_db: float) -> Pair:
    """A close pair with both members excited, from one scan at 13 tones across it."""
    members = np.flatnonzero(test.truth.n == n)[:2]
    freq = test.truth.freq_hz[members]
    beyond = 3.0 * float(np.max(freq * test.truth.zeta[members]))  # 1.5 half-power bandwidths
    tones = np.round(np.linspace(freq[0] - beyond, freq[1] + beyond, 13), 3)
    return split_pair(cf.circle.demodulate(scan_at(test, snr_db, tones.tolist()).record, ORDERS), n)


def true_blade() -> cf.Shell:
    """The blade of rig_blade.toml as it would be made: 3 % thicker at the root, the root in a slot that gives way."""
    return cf.Shell(
        chart=cf.Plate(length=0.110, width=0.040),
        thickness=5.05e-3,
        taper=cf.Taper(along=(1.03, 0.98)),
        material=cf.Material(E=207e9, nu=0.29, rho=7830.0),
        supports={"root": cf.ElasticEdge(k_face=2e13)},
        mesh=cf.ShellMesh(order=8, rows=4, around=2),
    )


def blade_test() -> BladeTest:
    """A hammer at a corner of the tip, 27 laser spots, eight taps; modes in the blade's plane stay unseen."""
    modes = cf.modes(true_blade(), BLADE_MODES)
    spots = [
        cf.rig.Place(at=(float(a), float(b)), direction="normal")
        for a in np.linspace(0.02, 0.11, 9)
        for b in (-0.019, 0.0, 0.019)
    ]
    rig = cf.rig.rig_of(
        modes,
        [cf.rig.Place(at=(0.108, 0.017), direction="normal"), *spots],
        zeta=damping_spread(0.003, 0.25, BLADE_MODES, seed=SEED),
    )
    test = record(
        rig,
        [Impact(peak=100.0, width=1.0 / 16000.0)],
        drives=[0],
        sensors=range(1, len(spots) + 1),
        fs=81920.0,
        block=131072,
        blocks=8,
        seed=SEED,
        quantity="mobility",
    )
    taken = measured(test, seed=SEED, snr_db=50.0, bits=24)
    found = estimate(taken, window="rectangular", overlap=0.0, band=(200.0, 0.98 * rig.freq[-1]))
    size = np.linalg.norm(rig.rows, axis=0)
    seen = size > 0.05 * size.max()
    truth = cf.FrequencyTable.from_arrays(
        freq_hz=rig.freq[seen], sigma_hz=1e-9 * rig.freq[seen], zeta=rig.zeta[seen], synthetic=True
    )
    return BladeTest(frfs=found.frfs, truth=truth)
