"""Faults concerning requested results and comparisons: modes, reduction, sensors, study and files."""

RESULTS = {
    "expansion-modes": (
        "shapes at the sensors do not determine so many modes",
        "use fewer modes, modes that the sensors distinguish, or more sensors",
    ),
    "interaction-blade": (
        "a blade or bladed disk has no positive frequencies, or more nodal diameters than its blades allow",
        "give frequencies in Hz; a disk of N blades has nodal diameters 0 to N/2",
    ),
    "interaction-casing": (
        "a casing has no elastic pair with nodal diameters",
        "take modes of a closed casing, or give frequencies by n >= 1",
    ),
    "interaction-speed": (
        "there is no such range of speeds, or nothing that turns",
        'give speed_hz = (first, last) with 0 <= first < last, and turning "blade" or "casing"',
    ),
    "interface-axis": (
        "the directions of a tip's pieces cannot be taken from this axis",
        "give an axis beside the tip of an imported part; on a chart leave axis out, and give lean_deg in the scene",
    ),
    "interface-circle": (
        "contact describes a rim by harmonics about z, but this edge or line is not a plane circle about z",
        "name an edge that runs around z, by the angle that the chart's second parameter is",
    ),
    "interface-edge": (
        "the interface is not an edge for contact",
        "name a curved edge of a casing (Rim), or root or tip of an open panel or blade (Tip); of an imported part a "
        "group of facets that closes around the axis (Rim) or ends the blade (Tip)",
    ),
    "interface-harmonics": (
        "the rim's harmonics exceed what the mesh resolves",
        "reduce n_max, or ask for more elements around",
    ),
    "interface-held": ("the edge that contact should push is fixed", "name a free edge, or an elastic one"),
    "interface-lines": (
        "a rim's lines lie off the casing, or cannot be had in this reduction",
        "give places of the chart's first parameter within its bounds; leave lines out for the edge itself",
    ),
    "interface-nodes": (
        "a blade's tip is cut into no pieces, or into too many; or contact names nodes that are not there",
        "take 1 to 100 pieces, of an imported part no more than its mesh resolves; name nodes of its file, each once",
    ),
    "law-stations": (
        "a law from root to tip is neither a number nor a list of them",
        "give one number, or 2 to 8 finite values at equally spaced stations, the root's first",
    ),
    "locate-among": ("there are two kinds of places to search", "search among bolts or mass"),
    "locate-baseline": (
        "the baseline table has no row that can be compared with the model",
        "give the table of the same casing, with n, or leave the baseline out",
    ),
    "locate-bolts": (
        "loose bolts are searched for on the one edge that has bolts",
        "give one edge bolts, under a ring or not",
    ),
    "locate-edge": (
        "masses and bolts are searched for on an edge that runs around a closed casing",
        "name the edge, base or top, of a closed casing",
    ),
    "locate-unlabelled": (
        "splits of pairs show the places, and pairs need their nodal diameters",
        "give n for the rows of the table, and angle_deg where it was measured",
    ),
    "modes-band": (
        "the band of frequencies is invalid, or both a band and a count are given",
        "give band = (from, to) in Hz, 0 <= from < to, or a count, not both",
    ),
    "modes-count": (
        "the number of modes cannot be computed",
        "ask for at least 1 and far fewer than the mesh has unknowns",
    ),
    "modes-lobpcg": (
        "LOBPCG with multigrid did not find the modes, as on thin walls; shift-invert was used instead",
        "none is needed; `mesh_modes(solid, count, multigrid=False)` saves the attempt",
    ),
    "modes-memory": (
        "a factorisation needs more memory than is free",
        "take fewer elements or a larger machine; thick solids go without a factor, "
        "`mesh_modes(solid, count, multigrid=True)`",
    ),
    "modes-method": (
        "this method does not apply",
        "leave method out; harmonics need a casing on which nothing varies around",
    ),
    "modes-rigid": (
        "on a mesh this coarse a thin free body bends before it turns as a whole: the rotations are not resolved",
        "leave the mesh out, or raise mesh.order or mesh.around",
    ),
    "modes-round-off": (
        "round-off of the stiffness is larger than the gap of these eigenvalues: no count shows whether a mode is "
        "missing, and the frequencies may be wrong",
        "check units and proportions; a rod or a wire needs a beam; end the count or the band in a wider gap",
    ),
    "output-direction": (
        "an output asks for a direction or component that there is none of",
        "x, y, z, normal, radial, tangential for a displacement; 11, 22, 12 and a side of -1 to 1 for a strain",
    ),
    "output-name": ("two outputs have the same name", "give each its own"),
    "output-place": (
        "an output lies off the surface, or at a place that structures of this kind do not have",
        "give parameters within the chart's bounds; of imported parts a NodeDisplacement, of solids a NodeStress too",
    ),
    "reduce-axis": (
        "a casing turns about another axis than that of its rim",
        "give both the same axis; a casing on a chart turns about z",
    ),
    "reduce-damping": (
        "the damping ratio is not one of a vibrating mode",
        "give zeta from 0 to below 1 (half a per cent as 0.005)",
    ),
    "reduce-method": ("there is no such method of reduction", "use free or craig-bampton"),
    "reduce-rigid": ("a body that can move as a whole has no static compliance", "support it before reducing"),
    "reduce-steady": (
        "a part deforms so much as it turns that its stiffness over speed is known near the speed of its modes alone",
        "run the basis at speeds between those named; for others, set rotation.speed_hz of the study and reduce again",
    ),
    "sensor-far": (
        "a sensor is not on the wall of this model",
        "check the points' unit (metres), origin and axes; the axis of a casing is z",
    ),
    "sensor-twice": (
        "two channels measure the same motion, so that the mass at them is not defined",
        "leave repeated channels out, or reduce the mass by SEREP",
    ),
    "study-file": ("the file cannot be read", "give the path of a text file in UTF-8"),
    "study-implausible": (
        "a number is not plausible for a structure or material: its unit is probably wrong",
        'give the number in SI units; if it is intended, name its check: [checks] allow = ["E"]',
    ),
    "study-key": ("a key is unknown, or is beside one that excludes it", "`casingfem schema` lists all keys"),
    "study-missing": ("a key or table that the study needs is not there", "add it; `casingfem schema` lists all keys"),
    "study-toml": ("the file is not TOML", "correct the line named; write text in quotes and each table once"),
    "study-value": ("a value has the wrong type or lies out of range", "give what is expected there, in SI units"),
    "table-columns": (
        "a frequency table has columns that are not used",
        "ignore this if they are remarks; otherwise name them mode, n, freq_hz, sigma_hz, angle_deg or zeta",
    ),
    "uff-bytes": (
        "the first line of a binary function states another number of bytes than its data have",
        "no action is needed: the data end at the size that their header states, and are complete",
    ),
    "uff-empty": (
        "a set of a universal file is empty: two marks -1 follow each other where a set should begin",
        "check whether the export was complete: some programs lose the first binary function of a file",
    ),
    "uff-end": (
        "the last set of the file lacks its closing -1; every number that its header announces is there",
        "check whether the export was complete: sets may be missing after it",
    ),
    "uff-gap": (
        "sets of nodes and elements have no count, and here a few of their numbers are left out",
        "compare with the program that wrote the file: were lines lost?",
    ),
    "uff-local": (
        "the coordinates of nodes refer to coordinate systems of the file that are not read",
        "export the geometry in global coordinates, or see that these systems are the global one",
    ),
    "uff-shapes": (
        "sets of shapes have no count, and the shapes of one file have values at different nodes",
        "compare with the program that wrote the file: were lines lost?",
    ),
    "uff-unknown": (
        "the file has a set of a number that this reader does not know; it is skipped",
        "check the number",
    ),
    "update-angles": (
        "the angles of pairs are not fitted on an imported part: its frequencies, means and splits are",
        "no action is needed; model the part as a cf.Shell to fit its angles too",
    ),
}
