"""The campaigns: every report in full, what it proves, and the paths whose change asks for another run."""

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
        """What a reader types."""
        return " ".join(("python", "-m", f"reports.{self.name}", *self.flags))


CAMPAIGNS = (
    Campaign("modes.frustum", "errors of the reference frustum over meshes", STRUCTURE),
    Campaign("verification.cylinder", "650 frequencies of cylinders against 3-D elasticity", STRUCTURE),
    Campaign("verification.cylinder_exact", "those 650 computed anew, and what the shell's gap is made of", STRUCTURE),
    Campaign("verification.wall", "imperfect casings against themselves as three-dimensional solids", STRUCTURE),
    Campaign("modes.locking", "thin walls do not lock", STRUCTURE),
    Campaign("verification.static", "MacNeal and Harder's static set", STRUCTURE),
    Campaign("verification.rotation", "rotating beams, rings, drums", STRUCTURE),
    Campaign("verification.strips", "a stepped cylinder against an exact solution", STRUCTURE),
    Campaign("verification.blades", "plates and blades against independent solutions", STRUCTURE),
    Campaign("modes.loose_bolts", "casings on bolts: how frequencies settle", STRUCTURE),
    Campaign("modes.steel_ring", "a ring as a beam and as a strip of the shell", STRUCTURE),
    Campaign("modes.imported", "meshes of five formats; solids and quadrilaterals against references", STRUCTURE),
    Campaign(
        "modes.imported_relations",
        "200 imported parts under changes whose effect is exact",
        ("casingfem/structure/imported", "contact/model/bodies"),
    ),
    Campaign("modes.sturm", "1,000 random structures: modes returned are modes counted", STRUCTURE),
    Campaign("modes.mistuning", "restarts from the mean casing's modes", STRUCTURE),
    Campaign("modes.cyclic", "wheels of equal and mistuned sectors against their full models, time", STRUCTURE),
    Campaign("modes.ties", "blocks of meshes that do not match, tied, against one mesh", STRUCTURE),
    Campaign("modes.meridians", "meridians of several pieces against quadrilaterals and 3-D", STRUCTURE),
    Campaign("modes.corner", "a cylinder and a cone: chart, imported shell and solid, CalculiX", STRUCTURE),
    Campaign("modes.branching", "shells that branch: a published box, a T against bricks", STRUCTURE),
    Campaign("modes.cutouts", "a casing with a hole and a window: imported shell, CalculiX", STRUCTURE),
    Campaign("modes.stiffeners", "ring stiffeners against bricks of wall and rings", STRUCTURE),
    Campaign("speed.modal", "error against time over meshes and solvers", STRUCTURE),
    Campaign("speed.growth", "modes of ever finer meshes: time, memory, share of dgemm", STRUCTURE, ("--large",)),
    Campaign("speed.imports", "from a mesh file of 300,000 unknowns to a basis", STRUCTURE, ("--large",)),
    Campaign("speed.beside_calculix", "40 modes beside CalculiX: time and error in one run", STRUCTURE),
    Campaign("speed.solid_solvers", "large solids: memory and time of the solvers", STRUCTURE, ("--large",)),
    Campaign("robustness.broken", "broken models are refused or doubted by name", (*STRUCTURE, "casingfem/faults")),
    Campaign("verification", "every published and exact value: structures, simple contacts", (*STRUCTURE, "contact")),
    Campaign("contact.batches", "2,000 random lists of scenes equal the runs alone", (*RUBS, "contact/sweep")),
    Campaign("robustness.uff_mutations", "damaged universal files are read whole or refused", UFF),
    Campaign("robustness.file_mutations", "100,000 damaged files of 57 kinds end in no traceback, no hang", READERS),
    Campaign(
        "robustness.schema",
        "8,000 bad values of all keys end in no traceback, no hang, no stray warning",
        ("contact/scene", "contact/sweep", "casingfem/study", "casingfem/cli"),
    ),
    Campaign("robustness.stray_points", "stray points of surveys are found unasked", ("casingfem/structure/field",)),
    Campaign("updating.wrong_rows", "wrong rows of tables are named, the update is as without them", UPDATING),
    Campaign("updating.pairing", "doublets are paired with what was measured", UPDATING),
    Campaign("updating.identification", "modes of twenty SYNTHETIC tests against the truth", IDENTIFY),
    Campaign("updating.identification_times", "an identification takes less than is allowed", IDENTIFY),
    Campaign("updating.unkind", "modes of forty SYNTHETIC tests with everything that goes wrong in a hall", RIG),
    Campaign("updating.fan_blade", "the example script of an update", UPDATING),
    Campaign("updating.checks", "derivatives, cost, and models of the measured blade", UPDATING),
    Campaign("updating.twin", "200 noisy updates: intervals hold the truth", UPDATING),
    Campaign("updating.loose_bolt_search", "two loose bolts of 24 are found", UPDATING),
    Campaign("rig.measure", "from SYNTHETIC records to predictions", RIG),
    Campaign("contact.accuracy", "rods and bars against exact contact, a million steps", ("contact",)),
    Campaign("contact.rods", "two rods by every scheme", ("contact",)),
    Campaign("contact.rod_wall", "a rod on a wall by every scheme", ("contact",)),
    Campaign("contact.work_precision", "error against time of every scheme", ("contact",)),
    Campaign("contact.stability", "stiffness and mass ratios to 1e10, a million steps at rest", ("contact",)),
    Campaign("contact.cycles", "periodic motions before stops: published orbits, stability, times", CYCLES),
    Campaign("contact.random_orbits", "300 random bodies: runs and multipliers agree", CYCLES),
    Campaign("contact.sparse_body", "large sparse bodies as dense ones", ("contact",)),
    Campaign("contact.metamorphic", "400 random contact problems and their relatives agree", RUBS),
    Campaign("contact.targets", "every target of contact", ("contact",)),
    Campaign("contact.physics", "friction and patches", ("contact",)),
    Campaign("rub.interaction", "coincidences against runs", ("contact", "casingfem/modal")),
    Campaign("rub.interaction_map", "growth by poles against 2,501 runs", ("contact",)),
    Campaign("contact.rotating_beam", "a hinged beam in an eccentric circle", ("contact",)),
    Campaign("contact.hertz", "Hertz's pressure under a disc", ("contact",)),
    Campaign("rub.run_growth", "200 verdicts on growth against long runs at a tenth of the step", ("contact",)),
    Campaign("rub.beside", "tables of dangerous speeds of three machines beside runs of their own", ("contact",)),
    Campaign("rub.rotor37", "NASA rotor 37: frequencies beside CalculiX", STRUCTURE),
    Campaign("rub.agreement", "interactions, poles and runs at sixty speeds of three pairs", ("contact",)),
    Campaign("rub.turning", "bodies that turn: growth, impulse and ledger beside plain NumPy", RUBS),
    Campaign("rub.section_44", "the study's rubs", RUBS),
    Campaign("rub.wear", "abradable coatings", (*RUBS, "contact/record/wear.py")),
    Campaign("rub.jumps", "jumps of a rub over its speed: folds beside slow ramps", (*CYCLES, *RUBS)),
    Campaign("rub.bladed_disk", "unstable speeds of bladed disks", RUBS),
    Campaign("rub.convergence", "what a rub converges with", RUBS),
    Campaign("rub.checks", "rubs in three directions: bases, energy, time", RUBS),
    Campaign("rub.bases", "what the basis of a casing costs", (*RUBS, "casingfem/modal")),
    Campaign("speed.start_up", "what starting costs, and what it loads", ("casingfem", "contact")),
    Campaign("speed.first_use", "first runs of every scene, with nothing compiled yet", ("contact",)),
    Campaign("speed.waiting", "what a person waits for: each command, first and next", ("casingfem", "contact")),
    Campaign("mutants", "which of 120 small faults the tests see", ("casingfem", "contact", "tests"), DRAWN),
    Campaign("speed", "times of the main calls", ("casingfem", "contact")),
    Campaign("speed.sweeps", "times of sweeps", ("contact",)),
    Campaign("speed.tips", "microseconds a step of a rub by its tips", RUBS),
    Campaign("speed.tips_beside", "microseconds a step of tips, beside another checkout", RUBS),
    Campaign("robustness.diverging", "scenes that diverge stop with the cause named, mistyped ones are refused", RUBS),
    Campaign("robustness.sweep_kills", "sweeps under kill -9 lose nothing", ("contact/sweep",)),
    Campaign("robustness.set_kills", "sets under kill -9 are the old or the new", ("contact/io", "casingfem/cli")),
    Campaign("rig", "the chain of `make study`", ("casingfem", "contact")),
)  # fmt: skip
