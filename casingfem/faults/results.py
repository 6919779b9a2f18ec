"""Faults concerning requested results and comparisons: modes, reduction, sensors, study and files."""

RESULTS = {
    "expansion-modes": (
        "the sensors cannot distinguish so many modes",
        "use fewer modes, other modes, or more sensors",
    ),
    "interaction-blade": (
        "a blade frequency is not above 0 Hz, or a nodal diameter exceeds half the number of blades",
        "give frequencies above 0 Hz and at least 1 blade; N blades allow nodal diameters from 0 to N/2",
    ),
    "interaction-casing": (
        "the casing has no elastic mode with nodal diameters",
        "use modes of a closed casing, or give frequencies for n >= 1",
    ),
    "interaction-speed": (
        "the range of speeds is invalid, or the rotating body is unknown",
        'give speed_hz = (first, last) with 0 <= first < last, and turning = "blade" or "casing"',
    ),
    "interface-axis": (
        "this axis does not define radial and tangential directions at the blade's tip",
        "for an imported part give an axis that does not touch the tip; for a chart leave axis out and give lean_deg "
        "in the scene",
    ),
    "interface-circle": (
        "the rim is not a plane circle about z, and contact needs one for its harmonics",
        "use an edge that runs around z, with the angle about z as the chart's second parameter",
    ),
    "interface-edge": (
        "contact cannot act at this place of the structure",
        "use a curved edge of a closed casing (Rim), or the root or tip of an open panel or blade (Tip); of an "
        "imported part use a group of facets that closes around the axis (Rim) or ends the blade (Tip)",
    ),
    "interface-harmonics": (
        "the rim's harmonics exceed what the mesh resolves",
        "reduce n_max, or use more elements around",
    ),
    "interface-held": (
        "the interface of the contact is fixed, so that contact forces have no effect",
        "use a free edge, or give the edge an elastic support",
    ),
    "interface-lines": (
        "a line of the rim does not exist, lies off the casing, or is given twice",
        "give each line once, within the bounds of the chart's first parameter; leave lines out to use the edge",
    ),
    "interface-nodes": (
        "the number of pieces of a blade's tip is out of range, or contact names unknown nodes",
        "use 1 to 100 pieces, for an imported part no more than its mesh resolves; give existing node numbers, each "
        "once",
    ),
    "law-stations": (
        "a value that varies from root to tip is neither a number nor a list of numbers",
        "give one number, or a list of 2 to 8 finite numbers at equally spaced stations, beginning at the root",
    ),
    "locate-among": (
        "the kind of defect to search for is unknown",
        'search among "bolts" or "mass"',
    ),
    "locate-baseline": (
        "the baseline table cannot be compared with the model",
        "give the table of the same casing, with n for its rows, or leave the baseline out",
    ),
    "locate-bolts": (
        "a search for loose bolts needs exactly one edge with bolts",
        "give exactly one edge a support by bolts, with or without a ring",
    ),
    "locate-edge": (
        "a search for masses or loose bolts needs an edge that runs around a closed casing",
        "use the edge base or top of a closed casing",
    ),
    "locate-unlabelled": (
        "the table has no pair of modes with nodal diameters, and the search needs the splits of such pairs",
        "give n for the rows of the table, and angle_deg where it was measured",
    ),
    "modes-band": (
        "the frequency band is invalid, or both a band and a count are given",
        "give either a count or band = (from, to) in Hz with 0 <= from < to",
    ),
    "modes-count": (
        "the number of modes is below 1, or larger than can be computed",
        "ask for at least 1 mode, and for far fewer than the mesh has unknowns",
    ),
    "modes-lobpcg": (
        "LOBPCG with multigrid did not find the modes, as can happen with thin walls; shift-invert was used instead",
        "no action is needed; `cf.modal.mesh_modes(solid, count, multigrid=False)` skips this attempt",
    ),
    "modes-memory": (
        "a factorisation needs more memory than is free",
        "use fewer elements or a computer with more memory; thick solids need no factorisation with "
        "`cf.modal.mesh_modes(solid, count, multigrid=True)`",
    ),
    "modes-method": (
        "the method is unknown, or does not apply to this structure",
        "leave method out, so that the program chooses it",
    ),
    "modes-harmonics": (
        "the task needs energies, which shapes of coupled harmonics do not give at bolts",
        'compute the modes with `method="shell"`',
    ),
    "modes-rigid": (
        "the mesh is so coarse that not all rigid-body modes of a thin body are resolved",
        "leave [mesh] out, or increase mesh.order or mesh.around",
    ),
    "modes-round-off": (
        "rounding errors of the stiffness exceed the gap between eigenvalues: the program cannot tell whether a mode "
        "is missing, and the frequencies may be wrong",
        "check units and proportions; model a rod or a wire as a beam; end the count or the band in a wider gap",
    ),
    "output-direction": (
        "the direction or component of an output is unknown, or not defined at this place",
        "use x, y, z, normal, radial or tangential for a displacement; for a strain of a shell use 11, 22 or 12, and "
        "a side from -1 to 1",
    ),
    "output-name": (
        "two outputs have the same name",
        "give each output its own name",
    ),
    "output-place": (
        "an output lies off the surface, or this kind of structure does not have such a place",
        "give parameters within the chart's bounds; for an imported part use a NodeDisplacement, for a solid also a "
        "NodeStrain or NodeStress",
    ),
    "reduce-axis": (
        "a casing rotates about another axis than that of its rim",
        "give rotation and rim the same axis; a casing on a chart rotates about z",
    ),
    "reduce-damping": (
        "the damping ratio is not between 0 and 1",
        "give zeta from 0 to below 1 (0.5 % as 0.005)",
    ),
    "reduce-method": (
        "the method of reduction is unknown",
        'use "free" or "craig-bampton"',
    ),
    "reduce-rigid": (
        "a structure that can move as a rigid body has no static compliance",
        "support it before the reduction",
    ),
    "reduce-steady": (
        "rotation deforms the part so much that its stiffness is known only near the speed of its modes",
        "run the basis only at these speeds; for others change rotation.speed_hz in the study and reduce again",
    ),
    "sensor-far": (
        "a sensor is not on the surface of this model",
        "check the unit (metres), the origin and the axes of the sensor positions; the axis of a casing is z",
    ),
    "sensor-twice": (
        "two channels measure the same motion, so that the mass matrix of the channels is not defined",
        "leave repeated channels out, or reduce the mass by SEREP",
    ),
    "study-file": (
        "the file cannot be read",
        "give the path of a text file in UTF-8",
    ),
    "study-implausible": (
        "a number is implausible for a structure or a material, probably because of its unit",
        'give the number in SI units; if it is intended, allow its check by name: [checks] allow = ["E"]',
    ),
    "study-key": (
        "a key is unknown, or excludes another key that is given",
        "remove or rename the key; `casingfem schema` lists all keys",
    ),
    "study-missing": (
        "a required key or table is missing",
        "add it; `casingfem schema` lists all keys",
    ),
    "study-toml": (
        "the file is not valid TOML",
        "correct the line named; write text in quotes, and each table once",
    ),
    "study-value": (
        "a value has the wrong type or is out of range",
        "give a value as expected there, in SI units",
    ),
    "table-columns": (
        "a frequency table has columns that are not used",
        "ignore this if they are remarks; otherwise name them mode, n, freq_hz, sigma_hz, angle_deg or zeta",
    ),
    "uff-bytes": (
        "the first line of a binary function states a wrong number of bytes",
        "no action is needed: the header states the size of the data, and the data are complete",
    ),
    "uff-empty": (
        "a data set of a universal file is empty: two lines -1 follow each other where a data set should begin",
        "check whether the export was complete: some programs lose the first binary function of a file",
    ),
    "uff-end": (
        "the last data set of the file has no closing -1, but contains all numbers that its header announces",
        "check whether the export was complete: data sets may be missing after this one",
    ),
    "uff-gap": (
        "a few numbers are missing in the numbering of nodes or elements, and the file states no count to check it",
        "compare with the program that wrote the file: lines may have been lost",
    ),
    "uff-local": (
        "nodes of the file refer to its own coordinate systems, which are not read",
        "export the geometry in global coordinates, or check that these systems equal the global one",
    ),
    "uff-shapes": (
        "the shapes of one file have values at different nodes, and the file states no count to check it",
        "compare with the program that wrote the file: lines may have been lost",
    ),
    "uff-unknown": (
        "the file has a data set with a number that this reader does not know",
        "check this number; the data set is skipped",
    ),
    "update-angles": (
        "angles of pairs cannot be fitted on an imported part; its frequencies, means and splits are fitted",
        "no action is needed; to fit the angles too, model the part as a cf.Shell",
    ),
}
