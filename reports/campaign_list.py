"""The campaigns: every report in full, what it proves, and the paths whose change asks for another run."""

from dataclasses import dataclass

STRUCTURE = ("casingfem/structure", "casingfem/modal")
RUBS = ("contact/model", "contact/scheme", "contact/loop", "contact/solver")
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
    Campaign("frustum_convergence", "errors of the reference frustum over meshes", STRUCTURE),
    Campaign("cylinder", "650 frequencies of cylinders against 3-D elasticity", STRUCTURE),
    Campaign("cylinder_exact", "those 650 computed anew, and what the shell's gap is made of", STRUCTURE),
    Campaign("locking", "thin walls do not lock", STRUCTURE),
    Campaign("verify_static", "MacNeal and Harder's static set", STRUCTURE),
    Campaign("verify_rotation", "rotating beams, rings, drums", STRUCTURE),
    Campaign("verify_strips", "a stepped cylinder against an exact solution", STRUCTURE),
    Campaign("verify_blades", "plates and blades against independent solutions", STRUCTURE),
    Campaign("loose_bolts", "casings on bolts: how frequencies settle", STRUCTURE),
    Campaign("steel_ring", "a ring as a beam and as a strip of the shell", STRUCTURE),
    Campaign("imported", "meshes of five formats; solids and quadrilaterals against references", STRUCTURE),
    Campaign("sturm", "1,000 random structures: modes returned are modes counted", STRUCTURE),
    Campaign("mistuning", "restarts from the mean casing's modes", STRUCTURE),
    Campaign("modal_speed", "error against time over meshes and solvers", STRUCTURE),
    Campaign("solid_solvers", "large solids: memory and time of the solvers", STRUCTURE, ("--large",)),
    Campaign("broken_models", "broken models are refused or doubted by name", (*STRUCTURE, "casingfem/faults")),
    Campaign("verification", "every published and exact value: structures, simple contacts", (*STRUCTURE, "contact")),
    Campaign("uff_mutations", "mutated universal files are read whole or refused", ("casingfem/experiment/uff",)),
    Campaign("pairing", "doublets are paired with what was measured", UPDATING),
    Campaign("identification", "modes of twenty SYNTHETIC tests against the truth", IDENTIFY),
    Campaign("model_updating", "the example script of an update", UPDATING),
    Campaign("update_checks", "derivatives, cost, and models of the measured blade", UPDATING),
    Campaign("update_twin", "200 noisy updates: intervals hold the truth", UPDATING),
    Campaign("loose_bolt_search", "two loose bolts of 24 are found", UPDATING),
    Campaign("rig_measure", "from SYNTHETIC records to predictions", RIG),
    Campaign("contact_accuracy", "rods and bars against exact contact, a million steps", ("contact",)),
    Campaign("rods", "two rods by every scheme", ("contact",)),
    Campaign("rod_wall", "a rod on a wall by every scheme", ("contact",)),
    Campaign("work_precision", "error against time of every scheme", ("contact",)),
    Campaign("stability", "stiffness and mass ratios to 1e10, a million steps at rest", ("contact",)),
    Campaign("sparse_body", "large sparse bodies as dense ones", ("contact",)),
    Campaign("contact_targets", "every target of contact", ("contact",)),
    Campaign("contact_physics", "friction and patches", ("contact",)),
    Campaign("interaction", "coincidences against runs", ("contact", "casingfem/modal")),
    Campaign("interaction_map", "growth by poles against 2,501 runs", ("contact",)),
    Campaign("rotating_beam", "a hinged beam in an eccentric circle", ("contact",)),
    Campaign("hertz", "Hertz's pressure under a disc", ("contact",)),
    Campaign("section_44", "the study's rubs", RUBS),
    Campaign("wear", "abradable coatings", (*RUBS, "contact/record/wear.py")),
    Campaign("bladed_disk", "unstable speeds of bladed disks", RUBS),
    Campaign("rub_convergence", "what a rub converges with", RUBS),
    Campaign("rub_checks", "rubs in three directions: bases, energy, time", RUBS),
    Campaign("bases", "what the basis of a casing costs", (*RUBS, "casingfem/modal")),
    Campaign("start_up", "what starting costs, and what it loads", ("casingfem", "contact")),
    Campaign("first_use", "first runs of every scene, with nothing compiled yet", ("contact",)),
    Campaign("mutants", "which of 120 small faults the tests see", ("casingfem", "contact", "tests"), DRAWN),
    Campaign("speed", "times of the main calls", ("casingfem", "contact")),
    Campaign("sweep_speed", "times of sweeps", ("contact",)),
    Campaign("sweep_kills", "sweeps under kill -9 lose nothing", ("contact/sweep",)),
    Campaign("rig", "the chain of `make study`", ("casingfem", "contact")),
)  # fmt: skip
