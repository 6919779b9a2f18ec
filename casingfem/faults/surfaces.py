"""Faults concerning surfaces and walls: charts, imperfections, surveys, thickness, strips, material."""

SURFACES = {
    "blade-shape": (
        "the chord of a blade is not above 0 everywhere, or its camber closes a section on itself",
        "keep the chord above 0 and the camber below 2 pi rad from root to tip",
    ),
    "chart-angle": (
        "the angle of an open panel is 2 pi or more, so that the panel would overlap itself",
        "give an angle in radians below 2 pi; for a closed casing use a Cylinder",
    ),
    "chart-aspect": (
        "the surface is more than a thousand times longer than wide, or wider than long",
        "check the units of each length; model a rod or a wire as a beam, not as a shell",
    ),
    "chart-axisymmetric": (
        "a chart that is declared axisymmetric varies around, is not periodic, or has a second parameter that is not "
        "the angle about z",
        "set axisymmetric = False, or rotate one meridian about z, with the angle as second parameter",
    ),
    "chart-bounds": (
        "the ranges of the chart's parameters are not finite, or do not ascend",
        "return ((from, to), (from, to)) from `bounds`, each finite and ascending",
    ),
    "chart-derivatives": (
        "the derivatives that the chart returns are not those of its surface",
        "correct x1, x2, x11, x12, x22 in `surface`; compare them with finite differences of x",
    ),
    "chart-dimension": (
        "a length of the chart is not a positive finite number",
        "give lengths in metres, 500 mm as 0.5",
    ),
    "chart-edge": (
        "an edge of the chart is not a side of its parameter rectangle",
        "map each name in `edges` to (constant parameter: 0 or 1, end: 0 or 1)",
    ),
    "chart-fold": (
        "the surface folds, or shrinks to a line or a point: its two tangents are parallel or zero there",
        "leave a small hole at a pole, or correct the chart or its radius field",
    ),
    "chart-near-closed": (
        "the two straight edges of a panel nearly touch, but they are not joined",
        "use a Cylinder for a closed casing, or a smaller angle for a panel",
    ),
    "chart-not-finite": (
        "the surface or its derivatives are nan or infinite somewhere",
        "correct the chart or its radius field until all values are finite",
    ),
    "chart-open-seam": (
        "a chart is declared periodic, but its two ends lie at different places",
        "let the second parameter run once around the axis, or set periodic = False",
    ),
    "chart-turn": (
        "the second parameter of a periodic chart is not an angle over 2 pi, which fields, bolts and harmonics need",
        "scale the second parameter to a range of 2 pi, or set periodic = False",
    ),
    "chart-twist": (
        "the twist is not a finite angle",
        "give the twist in radians, 30 degrees as 0.5236",
    ),
    "chart-twist-units": (
        "the blade is twisted by more than half a turn",
        "give the twist in radians, 30 degrees as 0.5236 (study.toml: twist_deg in degrees)",
    ),
    "chart-units": (
        "the structure is very large or very small for a casing or a blade",
        "give lengths in metres, 500 mm as 0.5",
    ),
    "field-coefficients": (
        "the coefficients of a field are not finite numbers, or their number does not fit the harmonics",
        "give one finite number, or one row of finite numbers, for each harmonic",
    ),
    "field-harmonics": (
        "the harmonics of a field are not whole numbers from 0, each given once",
        "give harmonics p = 0, 1, 2, ..., each once; give the mean (p = 0) by cos only",
    ),
    "field-large": (
        "an imperfection is larger than the deviations of real casings",
        "give fields relative to the nominal value (0.4 % as 0.004); describe an intended shape by the chart",
    ),
    "field-mesh": (
        "a field has shorter waves than the mesh can resolve",
        "leave out the highest harmonics, or use more elements around (mesh.around)",
    ),
    "field-no-radius": (
        "a radius defect is given for a flat surface, which has no radius",
        "use a Panel, or give a thickness field",
    ),
    "field-not-finite": (
        "the field is nan or infinite somewhere on the surface",
        "give a field with finite values on the whole surface",
    ),
    "field-range": (
        "a relative field reaches -0.9 or less, or more than 9, somewhere",
        "give fields relative to the nominal value (0.4 % as 0.004), between -0.9 and 9",
    ),
    "field-resolution": (
        "harmonic 2n of a defect splits the pair with n nodal diameters, and the survey does not resolve this harmonic",
        "measure each ring with gaps below 90/n degrees, or use only the splits of pairs with fewer nodal diameters",
    ),
    "field-seed": (
        "a seed of a random field is not a whole number of 0 or more",
        "give seed = 1, 2, ...; the same seed gives the same field",
    ),
    "field-spectrum": (
        "a spectrum does not have lists of equal length, harmonics that ascend from 1, and 0 < median <= high",
        "give ascending harmonics p from 1, and 0 < median <= high for each",
    ),
    "field-spline": (
        "the ends, the number of intervals or the degree of a spline along the axis are invalid",
        "give z_low below z_high in metres, 1 interval or more, and degree 2 or more (3 for a natural spline)",
    ),
    "material-density": (
        "the density is not a positive finite number",
        "give rho in kg/m^3 (steel 7800)",
    ),
    "material-density-units": (
        "the density is not that of a solid",
        "give rho in kg/m^3 (steel 7800, not 7.8 or 7.8e-9)",
    ),
    "material-modulus": (
        "Young's modulus is not a positive finite number",
        "give E in Pa (steel 210e9)",
    ),
    "material-poisson": (
        "Poisson's ratio is not between -1 and 0.5",
        "give nu above -1 and below 0.5 (steel 0.3)",
    ),
    "material-poisson-negative": (
        "Poisson's ratio is negative: the material widens when it is stretched",
        "give nu above 0 (steel 0.3) unless the material is auxetic",
    ),
    "material-units": (
        "the material's speed of sound is not that of a solid",
        "give E in Pa (steel 210e9) and rho in kg/m^3 (steel 7800)",
    ),
    "meridian-arc": (
        "an arc of the meridian has no length, or covers a full turn or more",
        "give start and end as two different angles in radians, less than 2 pi apart",
    ),
    "meridian-off-line": (
        "two pieces of a meridian meet inside an element",
        "leave mesh.rows out, or give breaks that include the ends of all pieces and fillets",
    ),
    "meridian-pieces": (
        "the pieces of a meridian do not join: a corner has no fillet that fits, or an arc does not reach its end",
        "give each arc a radius above half the distance of its ends, and each corner a fillet (the wall thickness if "
        "the corner is sharp)",
    ),
    "meridian-points": (
        "the points of a meridian are too few, coincide, or form a corner",
        'give at least two different points from base to top; for a meridian with corners use kind = "meridian" with '
        "a fillet",
    ),
    "meridian-axis": (
        "the meridian reaches the axis, where the surface has a pole",
        "end the meridian before the axis, so that a small hole remains",
    ),
    "shear-correction": (
        "the shear correction is below 0.5, or between 1 and 10",
        "leave it out; for a wall without shear deformation give 1e6",
    ),
    "shell-plies": (
        "a layer of the wall is invalid, or the wall has features that layers do not allow",
        'give moduli and thicknesses above 0, set wall = "linear", and give strips and groups no material',
    ),
    "shell-wall": (
        "the wall theory is unknown",
        'use "curved" (exact metric through the wall) or "linear" (published shell theory)',
    ),
    "shell-free": (
        "the structure has no support: its first modes are rigid-body modes",
        "add a table [support.EDGE], unless the structure is meant to be free",
    ),
    "shell-thick": (
        "the wall is thick for its curvature or size: shell theory errs by several per cent",
        "check the unit of the thickness (3 mm is 3e-3), or model the part as a solid",
    ),
    "shell-thickness": (
        "the wall thickness is not a positive finite number",
        "give the thickness in metres, 3 mm as 3e-3",
    ),
    "shell-thickness-size": (
        "the wall is as thick as the structure is wide, or as its radius of curvature",
        "give the thickness in metres, 3 mm as 3e-3, and fillets of at least half the wall thickness",
    ),
    "shell-thin": (
        "the wall is thinner than a hundred-thousandth of the structure's size",
        "give the thickness in metres, 3 mm as 3e-3, not 3e-6",
    ),
    "stiffener-off-line": (
        "a stiffener lies inside an element",
        "leave mesh.rows out, or put a break of mesh.rows at the stiffener",
    ),
    "stiffener-place": (
        "a stiffener is not between the edges of a closed casing, or two stiffeners are at one place",
        'give `at` in metres between the edges, different for each; for a ring on an edge use a support, kind = "ring"',
    ),
    "strip-extent": (
        "start and end of a strip are not finite, or start is not below end",
        "give start below end, in metres along the axis",
    ),
    "strip-off-line": (
        "a strip ends inside an element, which would smear its step of thickness or material",
        "leave mesh.rows out, or put a break of mesh.rows at each end of the strip",
    ),
    "strip-outside": (
        "a strip extends beyond the ends of the shell",
        "give start and end in metres within the chart's bounds",
    ),
    "strip-overlap": (
        "two strips cover the same part of the wall",
        "end one strip where the next begins",
    ),
    "survey-columns": (
        "a survey has columns that are not used",
        "ignore this if they are remarks; otherwise name them theta_deg, theta_rad, x, y, z, radius or thickness (_m "
        "or _mm)",
    ),
    "survey-other": (
        "the survey is of another casing: its mean differs from the nominal value, or its heights from the shell's",
        "use the survey of this casing, in metres and degrees, or correct the nominal value",
    ),
    "survey-part": (
        "a survey covers too small a part of the shell's height",
        'survey the rest, or set outside = "nearest", "zero" or "fit" for the heights without points',
    ),
    "survey-outliers": (
        "a robust fit left out outliers of a survey",
        "check these places on the casing: dust and slips of the probe are errors, a dent belongs to the shape "
        "(robust = false keeps it)",
    ),
    "survey-stray": (
        "points of a survey contradict the surface through the other points, and distort the fit",
        "check these places on the casing; robust = true leaves the points out of the fit",
    ),
    "survey-passes": (
        "repeated measurements of a survey differ by more than random errors explain",
        "measure again, or keep only the correct pass: an offset or a rotation between passes is not noise",
    ),
    "survey-eccentric": (
        "the surveyed part was off the axis of the survey by more than its out-of-roundness",
        "set centred = true to use the part's own axis, unless it is eccentric to its axis of rotation in service too",
    ),
    "survey-quantity": (
        "the survey is of another quantity than the imperfection",
        "use it for the quantity that was surveyed (in a study: imperfection.of)",
    ),
    "survey-twice": (
        "several surveys of one quantity would be added, although each contains the whole deviation",
        "write the points of all surveys into one file; a warning names the places where they disagree",
    ),
    "survey-table": (
        "the survey cannot be read, or its points do not determine the requested fit",
        "correct the line named, or fit fewer harmonics (n_max) or a lower degree",
    ),
    "taper-thickness": (
        "the polynomial through the stations of a taper falls to 0 or below",
        "change the stations until the polynomial through them stays above 1e-6",
    ),
}
