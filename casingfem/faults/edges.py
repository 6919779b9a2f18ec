"""Faults concerning edges and rotation: supports, bolts, rings, masses, loads, speeds."""

EDGES = {
    "bolt-count": ("there is no such number of bolts", "give the number of bolts, 1 to 1000"),
    "bolt-mesh": (
        "the number of elements around does not fit the bolts, so that bolts differ in stiffness and split perfect "
        "pairs",
        "remove mesh.around, or set it to a multiple of the number of bolts",
    ),
    "bolt-number": ("a loose bolt is named that does not exist", "number the bolts from 1 to their count"),
    "bolt-off-edge": (
        "a bolt, with the patch it acts on, does not lie on the edge",
        "change first_angle, spacing or width, or use fewer bolts",
    ),
    "bolt-overlap": (
        "neighbouring bolts act on the same part of the edge",
        "give a smaller width, or a larger spacing",
    ),
    "bolt-stiffness": (
        "a bolt has no stiffness, or an impossible one",
        "give k in N/m, one number or [k_r, k_theta, k_z], and factors of 0 or more",
    ),
    "load-edge": ("a load names an edge that the chart does not have", "name one of the chart's edges"),
    "load-none": ("a static solution without loads is zero", "give at least one load"),
    "load-idle": (
        "a force acts on a node without stiffness and mass in that direction",
        "add a spring or a mass there, or remove the force in this direction",
    ),
    "load-place": (
        "a point load lies off the surface",
        "give the two parameters of the chart, as its `bounds` have them",
    ),
    "load-ring": (
        "the weight of rings and point masses is not modelled",
        "add it as an EdgeLoad or PointLoad, and give the shell's own weight as a SurfaceLoad",
    ),
    "mass-edge": ("masses are on the edges of the shell", "name an edge of the chart and give EdgeMass values"),
    "mass-held": (
        "a mass on a clamped edge does not move and changes no mode",
        "put it on another edge, support this one by springs, or leave it out",
    ),
    "mass-value": ("a mass that is negative or not finite, or at no angle", "give the mass in kg and the angle in rad"),
    "ring-edge": (
        "a ring's section is placed by radius and axis, and its ends are free",
        "put the ring on an edge that runs around (base, top, root or tip) and ends on no fixed one",
    ),
    "ring-offset": (
        "the place of a ring's section or foot is no pair of lengths",
        "give (radial, axial) in metres, or leave it out",
    ),
    "ring-section": (
        "a ring's section has a size that is not positive and finite",
        "give width and depth, or a diameter, in metres",
    ),
    "ring-support": (
        "the support of a ring must be springs: a fixed ring is a fixed edge",
        "give the ring an elastic support, bolts or none; to clamp it, clamp the edge",
    ),
    "rotation-axis": ("an axis of rotation without direction or place", "give two vectors of three finite numbers"),
    "rotation-blade": (
        "hub radius and stagger place a blade on its hub",
        "give a hub radius of 0 or more, on an open chart",
    ),
    "rotation-large": (
        "the centrifugal force bends or untwists the shell so much that linear statics no longer describe it",
        "lower the speed, or align the part with its radius; frequencies of such a state need nonlinear statics",
    ),
    "rotation-none": ("the structure does not rotate", "give it a Rotation: replace(structure, rotation=...)"),
    "rotation-speed": ("the speed of rotation is not finite", "give it in rad/s, 2 pi times turns a second"),
    "rotation-unstable": (
        "spin softening exceeds the stiffness: at this speed the shell is unstable",
        "reduce the speed, stiffen the support, or check the hub radius and the axis",
    ),
    "rotation-update": (
        "tests of rotating parts cannot be fitted: the derivatives neglect the centrifugal stiffening",
        "fit the part at rest, then give it its rotation",
    ),
    "springs-negative": (
        "the pattern of an elastic edge falls below -1 somewhere: a spring would push",
        "reduce the harmonics of its pattern until their sum stays above -1",
    ),
    "static-loose": (
        "a rigid motion is not restrained, or the shell is so soft that round-off hides its stiffness",
        "support every motion that the loads drive; if the loads balance, a soft elastic edge is enough",
    ),
    "support-edge": (
        "a support names an edge the chart does not have",
        "casings have base and top, panels and blades root, tip, left and right",
    ),
    "support-incomplete": (
        "the supports leave motions of the whole body free",
        "fix the free directions or add springs, unless the motion is intended",
    ),
    "support-kind": (
        "the object is not a support of a shell's edge",
        "use Clamped(), ShearDiaphragm(), ElasticEdge(...), Bolts(...)",
    ),
    "support-no-springs": (
        "an elastic support has no spring",
        "give at least one of k_r, k_theta, k_z, k_rot, k_face, or leave the support out",
    ),
    "support-soft": (
        "the springs are so soft that the structure floats",
        "give k_r, k_theta, k_z in N/m per m and k_face in N/m^3 (a stiff embedding has some 1e13)",
    ),
    "support-springs": (
        "a spring stiffness is negative or not finite, or no spring has this name",
        "give k_r, k_theta, k_z [N/m per m], k_rot [N m/rad per m], k_face [N/m^3] from 0",
    ),
    "symmetry-slanted": (
        "an edge of symmetry lies in a plane that the surface meets at a right angle; a cone's rim has none",
        "model the whole body, or choose the support that is meant: clamped or shear-diaphragm",
    ),
}
