"""The campaigns: every report in full, its subject, and the paths whose change requires another run."""

from dataclasses import dataclass

STRUCTURE = ("casingfem/structure", "casingfem/modal")
UFF = ("casingfem/experiment/uff",)
READERS = ("contact/io", "contact/scene", "casingfem/io", "casingfem/experiment", "casingfem/structure/imported")
RUBS = ("contact/model", "contact/scheme", "contact/loop", "contact/solver")
CYCLES = ("contact/cycles", "contact/loop/phase.py", "contact/model/bodies")
UPDATING = ("casingfem/updating", "casingfem/modal", "casingfem/experiment/correlation")
IDENTIFY = ("casingfem/experiment/identify", "casingfem/experiment/frf")
RIG = (*IDENTIFY, "casingfem/experiment/rig", "casingfem/experiment/circle", "casingfem/updating")
DRAWN = ("--seed", "20261", "--count", "120")


@dataclass(frozen=True, slots=True)
class Campaign:
    """`python -m reports.NAME FLAGS`: run again when `subject` has changed."""

    name: str
    proves: str
    subject: tuple[str, ...]
    flags: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command as a reader types it."""
        return " ".join(("python", "-m", f"reports.{self.name}", *self.flags))


CAMPAIGNS = (
    Campaign("verification.modes.frustum", "errors of the reference frustum over meshes", STRUCTURE),
    Campaign("verification.cylinder", "650 frequencies of cylinders against 3-D elasticity", STRUCTURE),
    Campaign("verification.cylinder_exact", "those 650 computed anew, and what the shell's gap is made of", STRUCTURE),
    Campaign("verification.wall", "imperfect casings against themselves as three-dimensional solids", STRUCTURE),
    Campaign("verification.modes.around", "elements around an imperfect frustum: error, forbidden splits", STRUCTURE),
    Campaign("verification.modes.locking", "thin walls do not lock", STRUCTURE),
    Campaign("verification.static", "MacNeal and Harder's static set", STRUCTURE),
    Campaign("verification.rotation", "rotating beams, rings, drums", STRUCTURE),
    Campaign("verification.strips", "a stepped cylinder against an exact solution", STRUCTURE),
    Campaign("verification.blades", "plates and blades against independent solutions", STRUCTURE),
    Campaign("verification.modes.loose_bolts", "casings on bolts: how frequencies settle", STRUCTURE),
    Campaign("verification.modes.steel_ring", "a ring as a beam and as a strip of the shell", STRUCTURE),
    Campaign(
        "verification.modes.imported", "meshes of five formats; solids and quadrilaterals against references", STRUCTURE
    ),
    Campaign(
        "verification.modes.imported_relations",
        "200 imported parts under changes whose effect is exact",
        ("casingfem/structure/imported", "contact/model/bodies"),
    ),
    Campaign("verification.modes.sturm", "1,000 random structures: modes returned are modes counted", STRUCTURE),
    Campaign(
        "verification.chance",
        "splits of 100,000 casings against full solutions; dangerous speeds, intervals, a rare event",
        (*STRUCTURE, "casingfem/chance"),
    ),
    Campaign("benchmarks.mistuning", "draws of random casings from one perfect casing: error, time", STRUCTURE),
    Campaign(
        "verification.modes.cyclic", "wheels of equal and mistuned sectors against their full models, time", STRUCTURE
    ),
    Campaign("verification.modes.ties", "blocks of meshes that do not match, tied, against one mesh", STRUCTURE),
    Campaign("verification.modes.meridians", "meridians of several pieces against quadrilaterals and 3-D", STRUCTURE),
    Campaign(
        "verification.modes.corner", "a cylinder and a cone: chart, imported shell and solid, CalculiX", STRUCTURE
    ),
    Campaign(
        "verification.outside", "published values, measurements, other programs in one table",
        (*STRUCTURE, "contact/cycles"),
    ),
    Campaign("verification.modes.branching", "shells that branch: a published box, a T against bricks", STRUCTURE),
    Campaign("verification.modes.cutouts", "a casing with a hole and a window: imported shell, CalculiX", STRUCTURE),
    Campaign("verification.modes.stiffeners", "ring stiffeners against bricks of wall and rings", STRUCTURE),
    Campaign("benchmarks.modal", "error against time over meshes and solvers", STRUCTURE),
    Campaign("benchmarks.growth", "modes of ever finer meshes: time, memory, share of dgemm", STRUCTURE, ("--large",)),
    Campaign("benchmarks.imports", "from a mesh file of 300,000 unknowns to a basis", STRUCTURE, ("--large",)),
    Campaign("benchmarks.beside_calculix", "40 modes beside CalculiX: time and error in one run", STRUCTURE),
    Campaign("benchmarks.solid_solvers", "large solids: memory and time of the solvers", STRUCTURE, ("--large",)),
    Campaign(
        "verification.robustness.broken",
        "broken models are refused or doubted by name",
        (*STRUCTURE, "casingfem/faults"),
    ),
    Campaign("verification", "every published and exact value: structures, simple contacts", (*STRUCTURE, "contact")),
    Campaign(
        "verification.schemes.batches", "2,000 random lists of scenes equal the runs alone", (*RUBS, "contact/sweep")
    ),
    Campaign("verification.robustness.uff_mutations", "damaged universal files are read whole or refused", UFF),
    Campaign(
        "verification.robustness.file_mutations",
        "100,000 damaged files of 57 kinds end in no traceback, no hang",
        READERS,
    ),
    Campaign(
        "verification.robustness.schema",
        "8,000 bad values of all keys end in no traceback, no hang, no stray warning",
        ("contact/scene", "contact/sweep", "casingfem/study", "casingfem/cli"),
    ),
    Campaign(
        "verification.robustness.stray_points",
        "stray points of surveys are found unasked",
        ("casingfem/structure/field",),
    ),
    Campaign(
        "verification.updating.wrong_rows", "wrong rows of tables are named, the update is as without them", UPDATING
    ),
    Campaign("verification.updating.pairing", "doublets are paired with what was measured", UPDATING),
    Campaign("verification.updating.identification", "modes of twenty SYNTHETIC tests against the truth", IDENTIFY),
    Campaign("benchmarks.identification_times", "an identification takes less than is allowed", IDENTIFY),
    Campaign(
        "verification.updating.unkind", "modes of forty SYNTHETIC tests with everything that goes wrong in a hall", RIG
    ),
    Campaign("studies.fan_blade", "the example script of an update", UPDATING),
    Campaign("verification.updating.checks", "derivatives, cost, and models of the measured blade", UPDATING),
    Campaign("verification.updating.twin", "200 noisy updates: intervals hold the truth", UPDATING),
    Campaign("verification.updating.loose_bolt_search", "two loose bolts of 24 are found", UPDATING),
    Campaign("studies.rig.measure", "from SYNTHETIC records to predictions", RIG),
    Campaign("verification.schemes.accuracy", "rods and bars against exact contact, a million steps", ("contact",)),
    Campaign("verification.schemes.rods", "two rods by every scheme", ("contact",)),
    Campaign("verification.schemes.rod_wall", "a rod on a wall by every scheme", ("contact",)),
    Campaign("benchmarks.work_precision", "error against time of every scheme", ("contact",)),
    Campaign("benchmarks.work_precision_cycles", "error against time of shooting and harmonic balance", CYCLES),
    Campaign(
        "verification.schemes.stability", "stiffness and mass ratios to 1e10, a million steps at rest", ("contact",)
    ),
    Campaign(
        "verification.schemes.cycles", "periodic motions before stops: published orbits, stability, times", CYCLES
    ),
    Campaign("verification.schemes.random_orbits", "300 random bodies: runs and multipliers agree", CYCLES),
    Campaign("verification.schemes.sparse_body", "large sparse bodies as dense ones", ("contact",)),
    Campaign("verification.schemes.metamorphic", "400 random contact problems and their relatives agree", RUBS),
    Campaign("verification.schemes.targets", "every target of contact", ("contact",)),
    Campaign("benchmarks.physics", "friction and patches", ("contact",)),
    Campaign("verification.rubs.interaction", "coincidences against runs", ("contact", "casingfem/modal")),
    Campaign("verification.rubs.interaction_map", "growth by poles against 2,501 runs", ("contact",)),
    Campaign("verification.schemes.rotating_beam", "a hinged beam in an eccentric circle", ("contact",)),
    Campaign("verification.schemes.hertz", "Hertz's pressure under a disc", ("contact",)),
    Campaign(
        "verification.rubs.run_growth", "200 verdicts on growth against long runs at a tenth of the step", ("contact",)
    ),
    Campaign("verification.rubs.speeds_between", "verdicts over speed against many more runs", ("contact",)),
    Campaign("verification.rubs.growth_intervals", "intervals of growth beside poles of closed contact", ("contact",)),
    Campaign(
        "verification.rubs.beside",
        "tables of dangerous speeds of three machines beside runs of their own",
        ("contact",),
    ),
    Campaign("verification.modes.nasa_rotors", "blades of NASA rotors 37 and 67 beside CalculiX", STRUCTURE),
    Campaign(
        "verification.rubs.agreement", "interactions, poles and runs at sixty speeds of three pairs", ("contact",)
    ),
    Campaign("verification.rubs.turning", "bodies that turn: growth, impulse and ledger beside plain NumPy", RUBS),
    Campaign("studies.blade_off", "fifteen seconds after a blade is lost", (*RUBS, "contact/model/rotor")),
    Campaign("studies.rotors", "convergence of NASA rotors 37 and 67", (*STRUCTURE, *RUBS)),
    Campaign("studies.section_44", "the study's rubs", RUBS),
    Campaign("studies.wear", "abradable coatings", (*RUBS, "contact/record/wear.py")),
    Campaign("studies.jumps", "jumps of a rub over its speed: folds beside slow ramps", (*CYCLES, *RUBS)),
    Campaign("verification.rubs.bladed_disk", "unstable speeds of bladed disks", RUBS),
    Campaign("verification.rubs.convergence", "what a rub converges with", RUBS),
    Campaign("verification.rubs.checks", "rubs in three directions: bases, energy, time", RUBS),
    Campaign("verification.rubs.bases", "what the basis of a casing costs", (*RUBS, "casingfem/modal")),
    Campaign("benchmarks.start_up", "what starting costs, and what it loads", ("casingfem", "contact")),
    Campaign("benchmarks.first_use", "first runs of every scene, with nothing compiled yet", ("contact",)),
    Campaign("benchmarks.waiting", "what a person waits for: each command, first and next", ("casingfem", "contact")),
    Campaign("tools.mutants", "which of 120 small faults the tests see", ("casingfem", "contact", "tests"), DRAWN),
    Campaign("benchmarks", "times of the main calls", ("casingfem", "contact")),
    Campaign("benchmarks.sweeps", "times of sweeps", ("contact",)),
    Campaign("benchmarks.tips", "microseconds a step of a rub by its tips", RUBS),
    Campaign("benchmarks.tips_beside", "microseconds a step of tips, beside another checkout", RUBS),
    Campaign(
        "verification.robustness.diverging",
        "scenes that diverge stop with the cause named, mistyped ones are refused",
        RUBS,
    ),
    Campaign("verification.robustness.sweep_kills", "sweeps under kill -9 lose nothing", ("contact/sweep",)),
    Campaign(
        "verification.robustness.set_kills",
        "sets under kill -9 are the old or the new",
        ("contact/io", "casingfem/cli"),
    ),
    Campaign(
        "verification.robustness.chance_kills",
        "chances under kill -9 give the same tables",
        ("casingfem/chance", "contact/sweep"),
    ),
    Campaign(
        "benchmarks.chance_rubs", "time of 10,000 rubs of random casings", ("casingfem/chance", "contact"), ("--whole",)
    ),
    Campaign("studies.rig", "the chain of `make study`", ("casingfem", "contact")),
)  # fmt: skip
