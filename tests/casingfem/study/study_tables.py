"""One table in a study of a casing, whose other tables are right: what load_study refuses of it."""

import re

import casingfem as cf
from tests.casingfem.study.study_texts import written
from tests.tables_in_files import placed, text_of

BASE = {
    "material": {"E": 210e9, "nu": 0.3, "rho": 7800.0}, "shell": {"thickness": 3e-3},
    "chart": {"kind": "frustum", "r_base": 0.5, "r_top": 0.45, "height": 0.25},
}  # fmt: skip
RIG = {"seed": 0, "zeta": 0.01, "drive": [{"height": 0.1}]}
TEST = {"kind": "exact", "band_hz": [10.0, 20.0], "resolution_hz": 1.0}
# the tables around each one; None is the place of the table itself
WITHIN = {
    "chart.piece[1]": {"chart": {"kind": "meridian", "start": [0.5, 0.0], "piece": [None]}},
    "cyclic": {"cyclic": None},
    "imperfection[1]": {"imperfection": [None]},
    "imperfection[1].harmonics[1]": {"imperfection": [{"of": "radius", "harmonics": [None]}]},
    "imperfection[1].random[1]": {"imperfection": [{"of": "radius", "seed": 0, "random": [None]}]},
    "mass[1]": {"mass": [None]},
    "reduce.output[1]": {"reduce": {"interface": "top", "output": [None]}},
    "rig.drive[1]": {"rig": RIG | {"drive": [None]}},
    "rig.scan": {"rig": RIG | {"scan": None}},
    "rig.sensor[1]": {"rig": RIG | {"sensor": [None]}},
    "rig.test": {"rig": RIG | {"test": None}},
    "rig.test.troubles": {"rig": RIG | {"test": TEST | {"snr_db": 60.0, "troubles": None}}},
    "shell.plies[1]": {"shell": {"thickness": 1e-3, "plies": [None]}},
    "solid.tie[1]": {"solid": {"mesh": "a.inp", "tie": [None]}},
    "stiffener[1]": {"stiffener": [None]},
    "strip[1]": {"strip": [None]},
    "support.base": {"support": {"base": None}},
    "support.base.loose[1]": {"support": {"base": {"kind": "bolts", "count": 1000, "k": 1e8, "loose": [None]}}},
    "update.parameter[1]": {"update": {"table": "a.csv", "parameter": [None]}},
}


def study_with(folder, path, table):
    """A study of a casing with this table."""
    whole = BASE | placed(WITHIN.get(path, {path: None}), table)
    return cf.load_study(written(folder, text_of(whole)))


def problems_at(folder, path, table):
    """Problems of a study with this table that are at the table or within it, each beginning with its key."""
    try:
        study_with(folder, path, table)
    except cf.study.StudyError as error:
        found = [problem.partition("study.toml: ")[2] for problem in error.problems]
        return [problem for problem in found if re.match(rf"{re.escape(path)}[.:\[]", problem)]
    return []
