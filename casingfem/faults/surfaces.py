"""Faults concerning surfaces and walls: charts, imperfections, surveys, thickness, strips, material."""

SURFACES = {
    "blade-shape": (
        "the sections of a blade have no chord somewhere, or close on themselves",
        "keep the chord above 0 and the camber below 2 pi rad from root to tip",
    ),
    "chart-angle": (
        "an open panel would overlap itself",
        "give the angle in radians, below 2 pi; a closed panel is a Cylinder",
    ),
    "chart-aspect": (
        "the surface is a thousand times longer than wide, or wider than long",
        "check the units of each length; a model of a rod or a wire needs no shell",
    ),
    "chart-axisymmetric": (
        "a chart that states it is axisymmetric changes around, or its second parameter is not the angle about z",
        "leave axisymmetric False; or turn one meridian about z, with the angle as second parameter",
    ),
    "chart-bounds": (
        "the chart's parameters do not run over finite ranges from low to high",
        "let `bounds` return ((from, to), (from, to)), each ascending",
    ),
    "chart-derivatives": (
        "the chart's derivatives are not those of its surface",
        "correct x1, x2, x11, x12, x22 in `surface`; compare them with differences of x",
    ),
    "chart-dimension": (
        "a length of the chart is not a positive finite number",
        "give lengths in metres, 500 mm as 0.5",
    ),
    "chart-edge": (
        "the chart names an edge that its parameter rectangle does not have",
        "let `edges` map names to (constant parameter: 0 or 1, end: 0 or 1)",
    ),
    "chart-fold": (
        "the surface shrinks to a line or a point, or folds: its tangents do not span a plane there",
        "leave a small hole at a pole, or change the chart or its radius field",
    ),
    "chart-near-closed": (
        "the two straight edges of a panel nearly touch but are not joined: the seam is open",
        "use a Cylinder for a closed casing, or a smaller angle",
    ),
    "chart-not-finite": (
        "the surface or its derivatives are not finite numbers somewhere",
        "correct the chart, or the radius field, there",
    ),
    "chart-open-seam": (
        "a chart declared periodic is not closed: its two ends lie at different places",
        "let the second parameter run once around, or state periodic = False",
    ),
    "chart-turn": (
        "the second parameter of a closed chart is an angle: fields, bolts and harmonics take it so",
        "let the second parameter run over 2 pi, 0 to 1 as 2 pi times it, or state periodic = False",
    ),
    "chart-twist": ("the twist is not a finite angle", "give the twist in radians, 30 degrees as 0.5236"),
    "chart-twist-units": (
        "the blade is twisted by more than half a turn",
        "give the twist in radians, 30 degrees as 0.5236 (study.toml: twist_deg in degrees)",
    ),
    "chart-units": (
        "the structure is very large or very small for a casing or a blade",
        "give lengths in metres, 500 mm as 0.5",
    ),
    "field-coefficients": (
        "the coefficients of a field are not finite numbers, or not of the shape its harmonics ask for",
        "give one finite number, or one row, for each harmonic",
    ),
    "field-harmonics": (
        "the harmonics of a field are not whole numbers from 0, each given once",
        "give p = 0, 1, 2, ... each once; the mean (p = 0) has no sine",
    ),
    "field-large": (
        "an imperfection is larger than real walls have: it changes the design",
        "give fields relative to the nominal value (0.4 % as 0.004); put the design itself into the chart",
    ),
    "field-mesh": (
        "the field has finer waves than the mesh can resolve",
        "leave out finer harmonics, or ask for more elements around",
    ),
    "field-no-radius": (
        "a radius defect is given for a flat surface, which has no radius",
        "use a Panel, or a thickness field",
    ),
    "field-not-finite": (
        "the field is nan or infinite somewhere on the surface",
        "correct the field there; a survey's fit must cover the whole surface",
    ),
    "field-range": (
        "a relative field takes away almost all of what it acts on, or multiplies it tenfold",
        "give fields relative to the nominal value (0.4 % as 0.004), between -0.9 and 9",
    ),
    "field-resolution": (
        "a pair of n nodal diameters is split by harmonic 2n of a defect, which the survey is too coarse to show",
        "survey points around with gaps below 90/n degrees on each ring, or trust the splits of fewer nodal diameters",
    ),
    "field-seed": (
        "a random field needs seeds that are whole numbers from 0",
        "give seed = 1, 2, ...; the same seed gives the same field",
    ),
    "field-spectrum": (
        "a spectrum is not a list of harmonics with a positive median and a higher 90th percentile each",
        "give p ascending from 1 and 0 < median <= high at each",
    ),
    "field-spline": (
        "a spline along the axis has no such ends, intervals or degree",
        "give z_low below z_high in metres, 1 interval or more, degree 2 or more; a natural spline is cubic",
    ),
    "material-density": ("the density is not a positive finite number", "give rho in kg/m^3 (steel 7800)"),
    "material-density-units": (
        "the density is not that of a solid",
        "give rho in kg/m^3 (steel 7800, not 7.8 or 7.8e-9)",
    ),
    "material-modulus": ("Young's modulus is not a positive finite number", "give E in Pa (steel 210e9)"),
    "material-poisson": (
        "Poisson's ratio lies outside what is stable",
        "give nu between -1 and 0.5, exclusive (steel 0.3)",
    ),
    "material-poisson-negative": (
        "the material widens when pulled",
        "give nu above 0 (steel 0.3) unless the material is auxetic",
    ),
    "material-units": (
        "the material's speed of sound is not that of a solid",
        "give E in Pa (steel 210e9) and rho in kg/m^3 (steel 7800)",
    ),
    "meridian-arc": ("an arc of no length or of more than a turn", "give two angles in radians, less than 2 pi apart"),
    "meridian-off-line": (
        "the pieces of a meridian need an element line where they meet, at both ends of each fillet",
        "leave mesh.rows out, or give breaks that include them",
    ),
    "meridian-pieces": (
        "the pieces of a meridian do not join: a corner without a fillet that fits, an arc that is too small",
        "give each arc a radius above half the distance of its ends, and each corner a fillet, of the wall thickness "
        "if the corner is sharp",
    ),
    "meridian-points": (
        "no smooth meridian goes through these points",
        'give two points or more from base to top; where walls meet at an angle take kind = "meridian" with a fillet',
    ),
    "meridian-axis": (
        "the meridian reaches the axis, where a chart of revolution ends in a pole",
        "stop short of the axis and leave a small hole",
    ),
    "shear-correction": (
        "the shear correction is none of 5/6, about 1, or the thin-shell limit",
        "leave it out; give 1e6 for a wall without shear",
    ),
    "shell-plies": (
        "a wall of layers cannot be as given",
        'give moduli and thicknesses above 0, wall = "linear", strips or groups without a material of their own',
    ),
    "shell-wall": (
        "the theory of the wall is unknown",
        "give curved (the metric through the wall), or linear (published shell theory)",
    ),
    "shell-free": (
        "the structure has no support: its first modes are rigid motions",
        "give [support.EDGE], unless the body is free",
    ),
    "shell-thick": (
        "the wall is thick for its curvature or size: shell theory is off by several per cent",
        "check the units of thickness (3 mm is 3e-3), or model it as a solid",
    ),
    "shell-thickness": (
        "the wall thickness is not a positive finite number",
        "give the thickness in metres, 3 mm as 3e-3",
    ),
    "shell-thickness-size": (
        "the wall is as thick as the structure is wide, or as its radius of curvature",
        "give the thickness in metres, 3 mm as 3e-3; fillets at least half the wall",
    ),
    "shell-thin": (
        "the wall is thinner than a hundred-thousandth of the size",
        "give the thickness in metres, 3 mm as 3e-3, not 3e-6",
    ),
    "stiffener-off-line": (
        "a stiffener is inside an element",
        "leave the mesh's rows to the program, or put a break of mesh.rows at the stiffener",
    ),
    "stiffener-place": (
        "a stiffener is at no place of its own between the edges of a closed casing",
        'give at in metres along the axis or meridian; on an edge a ring is a support, kind = "ring"',
    ),
    "strip-extent": (
        "the ends of a strip are not finite numbers in order",
        "give start below end, in metres along the axis",
    ),
    "strip-off-line": (
        "a strip ends inside an element, where its jump of thickness or material would be smeared",
        "leave the mesh's rows to the program, or put a break of mesh.rows at each end of the strip",
    ),
    "strip-outside": (
        "a strip reaches beyond the ends of the shell",
        "give start and end in metres within the chart's bounds",
    ),
    "strip-overlap": ("two strips claim the same part of the wall", "let one strip end where the next begins"),
    "survey-columns": (
        "a survey has columns that nobody uses",
        "nothing, if they are remarks; else name them theta_deg, theta_rad, x, y, z, radius or thickness (_m or _mm)",
    ),
    "survey-other": (
        "the survey is of another casing: its mean is not the nominal value, or its heights are not the shell's",
        "use the survey of this casing, in metres and degrees, or correct the nominal value",
    ),
    "survey-part": (
        "a survey covers less than half of the shell's height, or less than asked",
        'survey the rest, or state outside = "nearest", "zero" or "fit" beside the survey',
    ),
    "survey-outliers": (
        "a robust fit of a survey left stray points out",
        "examine the points named: chips, seams and slips of the probe are no shape, a dent is",
    ),
    "survey-stray": (
        "points of a survey contradict the surface through all others, and bend the fit",
        "examine the points named; robust = true sets them aside",
    ),
    "survey-passes": (
        "places of a survey measured twice differ beyond chance",
        "survey again, or keep the pass that is right: an offset, a turn or a change between them is no noise",
    ),
    "survey-eccentric": (
        "the surveyed part was beside the axis of the survey by more than it is out of round",
        "centred = true takes the points about the part's own axis; leave it where the part turns beside its axis",
    ),
    "survey-quantity": ("the survey is of another quantity", "let `of` name what was surveyed"),
    "survey-twice": (
        "several surveys of one quantity would add up, though each contains the whole defect",
        "write the points of all into one file; a warning names places where they disagree",
    ),
    "survey-table": (
        "the survey cannot be used as it is, or does not determine the fit asked for",
        "correct the line named, or fit fewer harmonics (n_max) and a lower degree",
    ),
    "taper-thickness": (
        "the law of the thickness leaves no wall somewhere",
        "keep the polynomial through the stations above 1e-6",
    ),
}
