"""Faults concerning edges and rotation: supports, bolts, rings, masses, loads, speeds."""

EDGES = {
    "bolt-count": (
        "the number of bolts is not a whole number from 1 to 1000",
        "give the number of bolts, 1 to 1000",
    ),
    "bolt-mesh": (
        "the number of elements around does not fit the bolts, so that equal bolts differ in stiffness and split "
        "pairs of modes",
        "remove mesh.around, or set it to a multiple of the number of bolts",
    ),
    "bolt-number": (
        "the number of a loose bolt does not exist",
        "give loose bolts by numbers from 1 to the number of bolts",
    ),
    "bolt-off-edge": (
        "a bolt with its contact patch does not lie on the edge",
        "change first_angle, spacing or width, or use fewer bolts",
    ),
    "bolt-overlap": (
        "the bolts do not fit side by side on the edge",
        "reduce the width or the number of bolts, or change their spacing",
    ),
    "bolt-stiffness": (
        "the stiffness of a bolt is 0, negative or not finite",
        "give k in N/m, as one number or [k_r, k_theta, k_z], and factors of 0 or more",
    ),
    "load-edge": (
        "a load acts on an unknown edge, or cannot act on this kind of structure",
        "name an edge of the chart, or use a load for this kind of structure",
    ),
    "load-none": (
        "no load is given: the static solution would be zero",
        "give at least one load",
    ),
    "load-idle": (
        "a force acts on a node without stiffness and mass in that direction",
        "add a spring or a mass there, or remove the force in this direction",
    ),
    "load-place": (
        "a point load lies off the surface, or at an unknown node",
        "give two parameters within the chart's bounds, or the number of a node of a cell",
    ),
    "load-ring": (
        "the weight of rings and point masses cannot be computed from gravity",
        "replace gravity: give their weight as an EdgeLoad or PointLoad, and the shell's own weight as a SurfaceLoad",
    ),
    "mass-edge": (
        "a mass is not an EdgeMass, or not on an edge of the chart",
        "name an edge of the chart, and give a list of EdgeMass",
    ),
    "mass-held": (
        "a mass on a clamped edge does not move and has no effect",
        "put it on another edge, support this edge by springs, or leave the mass out",
    ),
    "mass-value": (
        "a mass is negative or not finite, or its angle is not finite",
        "give the mass in kg, 0 or more, and the angle in rad",
    ),
    "ring-edge": (
        "a ring needs an edge that runs around and does not end on a fixed edge",
        "put the ring on an edge that runs around (base, top, root or tip), and do not fix the edges at its ends",
    ),
    "ring-offset": (
        "the offset of a ring's section or foot is not a pair of finite lengths",
        "give (radial, axial) in metres",
    ),
    "ring-section": (
        "a size of a ring's section is not a positive finite number",
        "give width and depth, or a diameter, in metres",
    ),
    "ring-support": (
        "the support of a ring is not elastic",
        "give the ring an elastic support, bolts or none; to clamp it, clamp the edge",
    ),
    "rotation-axis": (
        "the axis of rotation has no direction, or a number of it is not finite",
        "give direction and point of the axis as three finite numbers each; the direction must not be zero",
    ),
    "rotation-blade": (
        "the hub radius or the stagger is invalid, or given for a closed casing",
        "give a hub radius of 0 or more and a finite stagger, for an open chart only",
    ),
    "rotation-large": (
        "the centrifugal force bends or untwists the shell so much that linear statics is not valid",
        "reduce the speed, or stack the blade along its radius; such a state needs nonlinear statics",
    ),
    "rotation-none": (
        "the structure does not rotate",
        "give it a rotation: replace(structure, rotation=cf.Rotation(...))",
    ),
    "rotation-speed": (
        "the speed of rotation is not finite",
        "give a finite speed in rad/s: 2 pi times the speed in Hz",
    ),
    "rotation-unstable": (
        "spin softening exceeds the stiffness: the structure is unstable at this speed",
        "reduce the speed, stiffen the support, or check the hub radius and the axis",
    ),
    "rotation-update": (
        "a rotating part cannot be fitted to a test, because the derivatives neglect centrifugal stiffening",
        "fit the part at rest, then add its rotation",
    ),
    "springs-negative": (
        "the pattern of an elastic edge falls below -1 somewhere: a spring would have negative stiffness",
        "reduce the amplitudes of the pattern until their sum stays above -1",
    ),
    "static-loose": (
        "a rigid-body motion is not restrained, or the shell is so soft that rounding errors exceed its stiffness",
        "restrain each rigid-body motion that the loads drive; for balanced loads a soft elastic edge is enough",
    ),
    "support-edge": (
        "a support names an edge that the chart does not have",
        "use base and top of a casing, or root, tip, left and right of a panel or blade",
    ),
    "support-incomplete": (
        "the supports leave rigid-body motions free",
        "fix the free directions or add springs, unless these motions are intended",
    ),
    "support-kind": (
        "the object is not a support of a shell's edge",
        "use Clamped(), ShearDiaphragm(), ElasticEdge(...) or Bolts(...)",
    ),
    "support-no-springs": (
        "all stiffnesses of an elastic support are 0",
        "give at least one of k_r, k_theta, k_z, k_rot, k_face, or leave the support out",
    ),
    "support-soft": (
        "the springs are so soft that the structure is nearly free",
        "give k_r, k_theta, k_z in N/m per m and k_face in N/m^3 (a stiff embedding has about 1e13)",
    ),
    "support-springs": (
        "a spring stiffness is negative or not finite, or the name of a spring is unknown",
        "give k_r, k_theta, k_z [N/m per m], k_rot [N m/rad per m], k_face [N/m^3], each 0 or more",
    ),
    "symmetry-slanted": (
        "the surface does not meet a plane of symmetry at a right angle along this edge, as at the rim of a cone",
        "model the whole body, or use the support that is meant: clamped or shear-diaphragm",
    ),
}
