"""The same update on a coarser mesh, whose solution is the start on the given mesh.

Most steps of an update lead to the neighbourhood of its solution, where a coarse model with the right frequencies at
the start is as good. Its errors are therefore taken from the measured frequencies (space mapping: Bandler et al., IEEE
Trans. Microw. Theory Tech. 42, 1994, 2536),

    f' = f f_coarse(x0)/f_fine(x0)   for each row that pairs in both models at the start x0.

The coarse solution and its second-order terms only replace the start: the given mesh is solved until its own steps end.
"""

from dataclasses import replace

from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.variation import coarse_mesh
from casingfem.updating.problem import Problem, State


def coarse_problem(problem: Problem) -> Problem | None:
    """Set up the problem on a coarse mesh, with corrected frequencies; None if that would not save time.

    Shapes are fitted on the given mesh alone, and perfect casings need no mesh around.

    Raises
    ------
    ValueError
        If the coarse model has no solution at the start.
    """
    if not isinstance(problem.shell, Shell) or problem.shapes is not None:
        return None
    mesh = coarse_mesh(problem.shell)
    if mesh is None:
        return None
    fine = problem.state(problem.start)
    if fine.solution is None:
        return None
    shell = replace(problem.shell, mesh=mesh)
    small = Problem(shell, problem.table, problem.vary, problem.count, problem.reach)
    small.prior = problem.prior
    start = small.state(small.start)
    small.table = corrected(problem.table, fine, start)
    small.begin_at(small.start, start)
    return small


def corrected(table: FrequencyTable, fine: State, coarse: State) -> FrequencyTable:
    """The table with the errors of the coarse model in its frequencies; rows that do not pair stay as they are."""
    of_row = [
        {row: mode for match in state.pairing.matches for row, mode in zip(match.rows, match.modes, strict=True)}
        for state in (fine, coarse)
    ]
    freq = table.freq_hz.copy()
    for row in of_row[0].keys() & of_row[1].keys():
        freq[row] *= coarse.modes.freq[of_row[1][row]] / fine.modes.freq[of_row[0][row]]
    return replace(table, freq_hz=freq)
