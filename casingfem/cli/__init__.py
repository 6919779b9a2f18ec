"""The command line: `casingfem COMMAND FILE`. Only this package imports both casingfem and contact."""

import click

from casingfem.cli.chance import chance
from casingfem.cli.compile import compile_loops
from casingfem.cli.contact import contact, cycles, interactions, rub, stability
from casingfem.cli.correlate import correlate, locate
from casingfem.cli.doctor import doctor
from casingfem.cli.frf import frf
from casingfem.cli.identify import identify, rig
from casingfem.cli.matrices import export_matrices, import_matrices
from casingfem.cli.new import example, new, watch
from casingfem.cli.recover import recover
from casingfem.cli.response import response
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


# commands that change nothing on the disk unless --out names a folder, and those that write without it
READING = (
    modes, campbell, response, frf, identify, correlate, mistune, rig, update, locate, import_matrices, export_matrices,
    contact, rub, stability, interactions, cycles, sweep, chance, schema, explain, doctor,
)  # fmt: skip
WRITING = (reduce, report, new, example, watch, recover, compile_loops)
for command in (*READING, *WRITING):
    main.add_command(command)
