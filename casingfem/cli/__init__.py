"""The command line: `casingfem COMMAND FILE`. The only place that knows both packages."""

import click

from casingfem.cli.contact import contact, cycles, interactions, rub, stability
from casingfem.cli.correlate import correlate, locate
from casingfem.cli.doctor import doctor
from casingfem.cli.identify import identify, rig
from casingfem.cli.matrices import export_matrices, import_matrices
from casingfem.cli.new import example, new, watch
from casingfem.cli.schema import explain, schema
from casingfem.cli.study import campbell, modes, reduce, report, update
from casingfem.cli.sweep import mistune, sweep


@click.group(
    name="casingfem",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Exit codes: 0 done, 2 bad input, 3 the numerics failed, 130 stopped by Ctrl-C.",
)
@click.version_option(package_name="casingfem", prog_name="casingfem")
def main() -> None:
    """Modes, updating, reduction and rubbing of casings and blades with imperfections.

    STUDY and SCENE are TOML files; `casingfem schema KEY` explains their keys.
    """


STUDIES = (modes, campbell, identify, correlate, mistune, rig, update, locate, reduce, import_matrices, export_matrices)
SCENES = (contact, rub, stability, interactions, cycles, sweep)
for command in (*STUDIES, *SCENES, report, new, watch, schema, example, explain, doctor):
    main.add_command(command)
