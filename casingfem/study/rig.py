"""The test that [rig] of a study describes: probes, frequency responses, a circle scan, and the exact modes."""

from dataclasses import dataclass

import numpy as np

from casingfem.experiment.circle.scan import CircleScan, demodulate
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.estimate import estimate
from casingfem.experiment.rig.excitation import BurstRandom, Excitation, Impact, Random
from casingfem.experiment.rig.files import origin, truth
from casingfem.experiment.rig.record import BAND, measured, record
from casingfem.experiment.rig.rig import Rig, noisy
from casingfem.experiment.rig.scan import Scan, Tone, Turning, scan
from casingfem.experiment.rig.structure import Place, circle, damping_spread, rig_of
from casingfem.experiment.rig.troubles import TroubledTest, TroubledTruth, Troubles, troubled_frfs
from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import modes
from casingfem.structure.shell.assembly import assemble
from casingfem.study.load import Study
from casingfem.study.problems import StudyError
from casingfem.study.tables.rig import PlaceTable, ResponsesTable, RigTable, ScanTable, SensorTable

NOISE, SCAN, DAMPING = 1, 2, 3  # added to the seed, so that each random part is independent of the others


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """Roles of the probes: drives, sensors and the scan's circle."""

    drives: range
    sensors: range
    circle: range


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RigTest:
    """Result of a simulated test.

    Rig and layout, exact modes, responses, coherence, stored records, the scan and its waves.

    `troubles` has the exact data of a test with imperfections.
    """

    rig: Rig
    layout: Layout
    truth: FrequencyTable
    frfs: FrfSet | None
    coherence: FrfSet | None
    records: tuple[FrfSet, ...]
    scan: Scan | None
    waves: CircleScan | None
    troubles: TroubledTruth | None = None


def run_rig(study: Study) -> RigTest:
    """Test the study's structure on the virtual rig.

    Raises
    ------
    StudyError
        Without [rig], or if a part of it is impossible.
    """
    table = study.file.rig
    if table is None:
        raise study.error("rig", "nothing", "a table [rig]: seed, zeta, [[rig.drive]]")
    if table.test is not None and not table.sensor:
        raise study.error("rig.sensor", "nothing", "tables [[rig.sensor]] for [rig.test]")
    if table.scan is not None and table.scan.drive > len(table.drive):
        raise study.error("rig.scan.drive", str(table.scan.drive), f"1 to {len(table.drive)}, a [[rig.drive]]")
    try:
        return all_records(study, table)
    except ValueError as error:
        raise StudyError([f"{study.path}: rig: {line}" for line in str(error).splitlines()]) from error


def all_records(study: Study, table: RigTable) -> RigTest:
    """The rig and all its records."""
    places, layout = laid_out(study, table)
    system = None if study.shell.axisymmetric else assemble(study.shell)
    found = modes(study.shell, **study.file.modes.wanted, system=system)
    zeta = damping_spread(table.zeta, table.zeta_spread, len(found), seed=table.seed + DAMPING)
    rig = rig_of(found, places, zeta=zeta, system=system)
    card = origin(rig, f"study: {study.path.name}, sha256 {study.source['sha256']}, seed {table.seed}")
    made = None if table.scan is None else scanned(rig, table, table.scan, layout, card)
    troubled = None if table.test is None else troubled_test(rig, table, table.test, layout, card)
    frfs, coherence, records = (
        ((None, None, ()) if table.test is None else responses(rig, table, table.test, layout, card))
        if troubled is None
        else (troubled.frfs, troubled.coherence, ())
    )
    return RigTest(
        rig=rig,
        layout=layout,
        truth=truth(rig, layout.circle or circle_of(table, layout), card),
        frfs=frfs,
        coherence=coherence,
        records=records,
        scan=made,
        waves=None
        if made is None or table.scan is None
        else demodulate(made.record, table.scan.orders, runout=len(table.scan.runout)),
        troubles=None if troubled is None else troubled.truth,
    )


def laid_out(study: Study, table: RigTable) -> tuple[list[Place], Layout]:
    """All probes: drives, sensors, then the scan's circle."""
    closed = study.shell.chart.periodic
    drives = [place_of(study, f"drive[{k + 1}]", entry, closed) for k, entry in enumerate(table.drive)]
    sensors = [
        at for k, entry in enumerate(table.sensor) for at in sensors_of(study, f"sensor[{k + 1}]", entry, closed)
    ]
    spots: list[Place] = []
    if table.scan is not None:
        if not closed:
            raise study.error("rig.scan", "an open chart", "a closed casing: the spot moves around it")
        spots = circle(table.scan.height, table.scan.points or 2 * table.scan.orders + 3)
    first, second = len(drives), len(drives) + len(sensors)
    ranges = Layout(drives=range(first), sensors=range(first, second), circle=range(second, second + len(spots)))
    return [*drives, *sensors, *spots], ranges


def place_of(study: Study, key: str, table: PlaceTable, closed: bool) -> Place:
    """The place of a table."""
    if table.at is not None:
        return Place(at=(table.at[0], table.at[1]), direction=table.direction, mass=table.mass)
    if not closed:
        raise study.error(f"rig.{key}.height", "an open chart", "at = [a, b], parameters of the chart")
    assert table.height is not None  # the table has seen to it
    at = (table.height, float(np.radians(table.angle_deg)))
    return Place(at=at, direction=table.direction, mass=table.mass)


def sensors_of(study: Study, key: str, table: SensorTable, closed: bool) -> list[Place]:
    """One place, or a circle of them."""
    first = place_of(study, key, table, closed)
    if table.count == 1:
        return [first]
    if not closed:
        raise study.error(f"rig.{key}.count", str(table.count), "1 on an open chart")
    return circle(first.at[0], table.count, first_angle=first.at[1], direction=first.direction, mass=first.mass)


def circle_of(table: RigTable, layout: Layout) -> range:
    """The probes of the only [[rig.sensor]] that is a radial circle, which label the exact modes."""
    whole = len(table.sensor) == 1 and table.sensor[0].count > 2 and table.sensor[0].direction == "radial"
    return layout.sensors if whole else range(0)


def troubled_test(
    rig: Rig, table: RigTable, test: ResponsesTable, layout: Layout, card: tuple[str, ...]
) -> TroubledTest | None:
    """Frequency responses of a test with imperfections, None if the study has no troubles."""
    if test.troubles is None or test.snr_db is None:
        return None
    what = Troubles(snr_db=test.snr_db, **test.troubles.model_dump())
    drives, sensors = layout.drives, layout.sensors
    return troubled_frfs(
        rig, lines_of(test), what, sensors=sensors, drives=drives, seed=table.seed + NOISE, quantity=table.quantity,
        card=card,
    )  # fmt: skip


def lines_of(test: ResponsesTable) -> FloatArray:
    """Lines [Hz] of exact responses."""
    low, high = test.band_hz
    return np.asarray(low + test.resolution_hz * np.arange(int((high - low) / test.resolution_hz + 1e-9) + 1))


def responses(
    rig: Rig, table: RigTable, test: ResponsesTable, layout: Layout, card: tuple[str, ...]
) -> tuple[FrfSet, FrfSet | None, tuple[FrfSet, ...]]:
    """Frequency responses; their coherence if they come from records, and the records if they are stored."""
    low, high = test.band_hz
    if test.kind == "exact":
        frfs = rig.frfs(
            lines_of(test), sensors=layout.sensors, drives=layout.drives, quantity=table.quantity, card=card
        )
        return (frfs if test.snr_db is None else noisy(frfs, test.snr_db, seed=table.seed + NOISE)), None, ()
    force = excitation(test)
    block = int(2 ** np.ceil(np.log2(BAND * force.highest / test.resolution_hz)))
    clean = record(
        rig,
        [force] * len(layout.drives),
        drives=layout.drives,
        sensors=layout.sensors,
        fs=block * test.resolution_hz,
        block=block,
        blocks=test.blocks,
        seed=table.seed,
        quantity=table.quantity,
        card=card,
    )
    taken = measured(clean, seed=table.seed + NOISE, snr_db=test.snr_db, bits=test.bits)
    stationary = test.kind == "random"
    found = estimate(
        taken,
        window="hann" if stationary else "rectangular",
        overlap=0.5 if stationary else 0.0,
        estimator=test.estimator,
        band=(low, high),
    )
    return found.frfs, found.coherence, taken.functions() if test.keep_records else ()


def excitation(test: ResponsesTable) -> Excitation:
    """The force of a test by records: its band extends a tenth beyond that of the responses."""
    low, high = test.band_hz
    band = (round(0.9 * low, 6), round(1.1 * high, 6))
    if test.kind == "random":
        return Random(rms=test.force, band=band)
    if test.kind == "burst-random":
        return BurstRandom(rms=test.force, band=band, part=test.part)
    return Impact(peak=test.force, width=1.0 / high if test.width is None else test.width)


def scanned(rig: Rig, table: RigTable, entry: ScanTable, layout: Layout, card: tuple[str, ...]) -> Scan:
    """The circle scan."""
    turn = Turning(
        mirror=entry.mirror_hz,
        casing=entry.casing_hz,
        wander=entry.wander,
        speckle=entry.speckle,
        runout=tuple((pair[0], pair[1]) for pair in entry.runout),
    )
    drive = layout.drives[entry.drive - 1]
    in_space = entry.fixed_in == "space"
    return scan(
        rig,
        turn,
        [Tone(freq, entry.force) for freq in entry.tones_hz],
        circle=layout.circle,
        drive=None if in_space else drive,
        drive_circle=layout.circle if in_space else (),
        drive_angle=rig.probes[drive].angle,
        fs=entry.fs,
        seconds=entry.seconds,
        seed=table.seed + SCAN,
        snr_db=entry.snr_db,
        highest=entry.orders if in_space else None,
        card=card,
    )
