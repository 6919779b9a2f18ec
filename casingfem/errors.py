"""What can be wrong with a model: every refusal and warning has a code, a cause and a remedy, and they stand here.

A message says what was found where; the remedy and the code come from the catalogue, so that a user can look a code
up and a program can react to it.
"""

import re
import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

CODE = re.compile(r"\[([a-z0-9-]+)\]$")


class Fault(NamedTuple):
    """One entry of the catalogue: why a model is refused or doubted, and what helps."""

    cause: str
    remedy: str


CATALOGUE: Mapping[str, Fault] = MappingProxyType(
    {
        "blade-shape": Fault(
            "the sections of a blade have no chord somewhere, or close on themselves",
            "keep the chord above 0 and the camber below 2 pi rad from root to tip",
        ),
        "bolt-count": Fault(
            "there is no such number of bolts",
            "give the number of bolts, 1 to 1000",
        ),
        "bolt-mesh": Fault(
            "elements around that do not follow the bolts see some bolts stiffer than others and split perfect pairs",
            "leave mesh.around out, or make it a multiple of the number of bolts",
        ),
        "bolt-number": Fault(
            "a loose bolt is named that does not exist",
            "number the bolts from 1 to their count",
        ),
        "bolt-off-edge": Fault(
            "a bolt, with the patch it acts on, does not lie on the edge",
            "change first_angle, spacing or width, or take fewer bolts",
        ),
        "bolt-overlap": Fault(
            "neighbouring bolts act on the same part of the edge",
            "give a smaller width, or a larger spacing",
        ),
        "bolt-stiffness": Fault(
            "a bolt without stiffness, or with an impossible one, holds nothing",
            "give k in N/m, one number or [k_r, k_theta, k_z], and factors of 0 or more",
        ),
        "chart-angle": Fault(
            "an open panel would overlap itself",
            "give the angle in radians, below 2 pi; a closed panel is a Cylinder",
        ),
        "chart-aspect": Fault(
            "the surface is a thousand times longer than wide, or wider than long",
            "check the units of each length; a model of a rod or a wire needs no shell",
        ),
        "chart-bounds": Fault(
            "the chart's parameters do not run over finite ranges from low to high",
            "let `bounds` return ((from, to), (from, to)), each ascending",
        ),
        "chart-derivatives": Fault(
            "the chart's derivatives are not those of its surface",
            "correct x1, x2, x11, x12, x22 in `surface`; compare them with differences of x",
        ),
        "chart-dimension": Fault(
            "a length of the chart is not a positive finite number",
            "give lengths in metres, 500 mm as 0.5",
        ),
        "chart-edge": Fault(
            "the chart names an edge that its parameter rectangle does not have",
            "let `edges` map names to (parameter held: 0 or 1, end: 0 or 1)",
        ),
        "chart-fold": Fault(
            "the surface shrinks to a line or a point, or folds: its tangents do not span a plane there",
            "leave a small hole at a pole, or change the chart or its radius field",
        ),
        "chart-near-closed": Fault(
            "the two straight edges of a panel nearly touch but are not joined: the seam is open",
            "use a Cylinder for a closed casing, or a smaller angle",
        ),
        "chart-not-finite": Fault(
            "the surface or its derivatives are not finite numbers somewhere",
            "correct the chart, or the radius field, there",
        ),
        "chart-open-seam": Fault(
            "a chart said to close on itself does not: its two ends lie at different places",
            "let the second parameter run once around, or say periodic = False",
        ),
        "chart-twist": Fault(
            "the twist is not a finite angle",
            "give the twist in radians, 30 degrees as 0.5236",
        ),
        "chart-twist-units": Fault(
            "the blade is twisted by more than half a turn",
            "give the twist in radians, 30 degrees as 0.5236 (study.toml: twist_deg in degrees)",
        ),
        "chart-units": Fault(
            "the structure is very large or very small for a casing or a blade",
            "give lengths in metres, 500 mm as 0.5",
        ),
        "expansion-modes": Fault(
            "shapes at the sensors do not determine so many modes",
            "use fewer modes, modes that the sensors tell apart, or more sensors",
        ),
        "field-coefficients": Fault(
            "the coefficients of a field are not finite numbers, or not of the shape its harmonics ask for",
            "give one finite number, or one row, for each harmonic",
        ),
        "field-harmonics": Fault(
            "the harmonics of a field are not whole numbers from 0, each given once",
            "give p = 0, 1, 2, ... each once; the mean (p = 0) has no sine",
        ),
        "field-large": Fault(
            "an imperfection is larger than any wall has: it changes the design",
            "give fields relative to the nominal value (.4 % as 0.004); put the design itself into the chart",
        ),
        "field-mesh": Fault(
            "the field has finer waves than the mesh can carry",
            "leave out finer harmonics, or ask for more elements around",
        ),
        "field-no-radius": Fault(
            "a flat surface has no radius to be defective",
            "use a Panel, or a thickness field",
        ),
        "field-not-finite": Fault(
            "the field is nan or infinite somewhere on the surface",
            "correct the field there; a survey's fit must cover the whole surface",
        ),
        "field-range": Fault(
            "a relative field takes away almost all of what it acts on, or multiplies it tenfold",
            "give fields relative to the nominal value (.4 % as 0.004), between -0.9 and 9",
        ),
        "field-resolution": Fault(
            "a pair of n nodal diameters is split by harmonic 2n of a defect, which the survey is too coarse to show",
            "survey more points around (more than 4n to a ring), or trust the splits of fewer nodal diameters only",
        ),
        "field-seed": Fault(
            "a random field needs seeds that are whole numbers from 0",
            "give seed = 1, 2, ...; the same seed gives the same field",
        ),
        "field-spectrum": Fault(
            "a spectrum is not a list of harmonics with a positive median and a higher 90th percentile each",
            "give p ascending from 1 and 0 < median <= high at each",
        ),
        "field-spline": Fault(
            "a spline along the axis has no such ends, intervals or degree",
            "give z_low below z_high in metres, 1 interval or more, degree 2 or more; a natural spline is cubic",
        ),
        "interface-edge": Fault(
            "the interface is not an edge that contact can see",
            "name a curved edge of a casing (Rim), or root or tip of an open panel or blade (Tip)",
        ),
        "interface-harmonics": Fault(
            "the rim's harmonics exceed what the mesh resolves",
            "reduce n_max, or ask for more elements around",
        ),
        "interface-held": Fault(
            "the edge that contact should push is held",
            "name a free edge, or an elastic one",
        ),
        "interface-lines": Fault(
            "a rim's lines lie off the casing, or cannot be had in this reduction",
            "give places of the chart's first parameter within its bounds; leave lines out for the edge itself",
        ),
        "interface-nodes": Fault(
            "a blade's tip is cut into no pieces, or into too many",
            "take 1 to 100 pieces",
        ),
        "law-stations": Fault(
            "a law from root to tip is neither a number nor a list of them",
            "give one number, or 2 to 8 finite values at equally spaced stations, the root's first",
        ),
        "interaction-blade": Fault(
            "a blade or bladed disk has no positive frequencies, or nodal diameters that its blades cannot carry",
            "give frequencies in Hz; a disk of N blades has nodal diameters 0 to N/2",
        ),
        "interaction-casing": Fault(
            "a casing has no elastic pair with nodal diameters",
            "take modes of a closed casing, or give frequencies by n >= 1",
        ),
        "interaction-speed": Fault(
            "there is no such range of speeds, or nothing that turns",
            'give speed_hz = (first, last) with 0 <= first < last, and turning "blade" or "casing"',
        ),
        "load-edge": Fault(
            "a load names an edge that the chart does not have",
            "name one of the chart's edges",
        ),
        "load-none": Fault(
            "a static solution without loads is zero",
            "give at least one load",
        ),
        "load-place": Fault(
            "a point load lies off the surface",
            "give the two parameters of the chart, as its `bounds` have them",
        ),
        "load-ring": Fault(
            "the weight of rings and point masses is not modelled",
            "add it as an EdgeLoad or PointLoad, and give the shell's own weight as a SurfaceLoad",
        ),
        "locate-among": Fault(
            "there are two kinds of places to look among",
            "look among bolts or mass",
        ),
        "locate-baseline": Fault(
            "the table measured before has nothing to set against the model",
            "give the table of the same casing, with n, or leave the baseline out",
        ),
        "locate-bolts": Fault(
            "loose bolts are looked for on the one edge that has bolts",
            "give one edge bolts, under a ring or not",
        ),
        "locate-edge": Fault(
            "masses and bolts are looked for on an edge that runs around a closed casing",
            "name the edge, base or top, of a closed casing",
        ),
        "locate-unlabelled": Fault(
            "places are told by the splits of pairs, which need their nodal diameters",
            "give n for the rows of the table, and angle_deg where it was measured",
        ),
        "mass-edge": Fault(
            "masses stand on the edges of the shell",
            "name an edge of the chart and give PointMass values",
        ),
        "mass-value": Fault(
            "a mass that is negative or not finite, or at no angle",
            "give the mass in kg and the angle in rad",
        ),
        "material-density": Fault(
            "the density is not a positive finite number",
            "give rho in kg/m^3 (steel 7800)",
        ),
        "material-density-units": Fault(
            "no solid is as light or as heavy",
            "give rho in kg/m^3 (steel 7800, not 7.8 or 7.8e-9)",
        ),
        "material-modulus": Fault(
            "Young's modulus is not a positive finite number",
            "give E in Pa (steel 210e9)",
        ),
        "material-poisson": Fault(
            "Poisson's ratio lies outside what is stable",
            "give nu between -1 and 0.5, exclusive (steel 0.3)",
        ),
        "material-poisson-negative": Fault(
            "the material widens when pulled",
            "give nu above 0 (steel 0.3) unless the material is auxetic",
        ),
        "material-units": Fault(
            "the material's speed of sound is not that of a solid",
            "give E in Pa (steel 210e9) and rho in kg/m^3 (steel 7800)",
        ),
        "meridian-arc": Fault(
            "an arc of no length or of more than a turn",
            "give two angles in radians, less than 2 pi apart",
        ),
        "meridian-axis": Fault(
            "the meridian reaches the axis, where a chart of revolution ends in a pole",
            "stop short of the axis and leave a small hole",
        ),
        "mesh-around": Fault(
            "there is no such number of elements",
            "give a whole number of at least 1, or leave mesh.around out",
        ),
        "mesh-aspect": Fault(
            "cells are much longer than wide",
            "refine along their long side, or see that no node is misplaced",
        ),
        "mesh-coarse": Fault(
            "the shapes bend more within an element than its polynomials carry: frequencies come out too high",
            "ask for more elements or a higher order, for fewer modes, or leave [mesh] out",
        ),
        "mesh-collapsed-cell": Fault(
            "a cell has the same node twice, as wedges written as bricks have",
            "mesh with tetrahedra or true bricks; wedges and pyramids are not supported",
        ),
        "mesh-distorted-cell": Fault(
            "a cell is nearly folded somewhere",
            "remesh there; frequencies may still be good, compare with a finer mesh",
        ),
        "mesh-file": Fault(
            "a mesh file is malformed, cut short, or has what this program does not read",
            "export it again as a flat mesh: one part, the basic coordinate system, no other files",
        ),
        "mesh-flat-cell": Fault(
            "a cell has no volume or area",
            "delete it, or see whether its nodes were merged by mistake",
        ),
        "mesh-flipped-shell": Fault(
            "neighbouring shell cells are numbered in opposite senses",
            "orient the normals alike in the mesher",
        ),
        "mesh-fold": Fault(
            "cells of a shell meet in a fold, which one director a node cannot follow",
            "mesh the part as a solid, or round the fold off with small cells",
        ),
        "mesh-format": Fault(
            "the ending of a mesh file is not one of those known",
            "give .msh (Gmsh), .vtu, .inp (Abaqus, CalculiX) or .bdf, .nas, .dat (Nastran)",
        ),
        "mesh-group-empty": Fault(
            "a group holds no node of a cell",
            "name a group on the part, or save the group's cells with the mesh",
        ),
        "mesh-group-no-cells": Fault(
            "a material is given to a group without cells",
            "give it to a physical volume (for a shell: surface) or an element set",
        ),
        "mesh-group-no-facets": Fault(
            "a foundation needs facets, and the group's nodes cover none on the boundary",
            "name a physical surface, or every node of the facets",
        ),
        "mesh-hanging-node": Fault(
            "neighbouring cells do not share all nodes of their common facet",
            "remesh so that cells meet node to node",
        ),
        "mesh-inverted-cell": Fault(
            "the nodes of a cell run round it the wrong way, its volume is negative",
            "reverse the cells' orientation in the mesher",
        ),
        "mesh-kink": Fault(
            "neighbouring cells of a shell meet at an angle",
            "refine there; on a smooth surface the angle falls with the size of the cells",
        ),
        "mesh-left-out": Fault(
            "springs, masses, ties or rigid links of a mesh file are not taken over",
            "the body is computed without them; join parts in the mesher, give supports in the study",
        ),
        "mesh-linear-cells": Fault(
            "linear cells lock: bending comes out too stiff",
            "use quadratic cells (order 2 in the mesher)",
        ),
        "mesh-loose-facets": Fault(
            "facets of a group lie on no cell of the part",
            "they are left out; save the group with the part it is on",
        ),
        "mesh-material-twice": Fault(
            "a cell lies in two groups that each have a material",
            "give each cell one material: the groups must not overlap",
        ),
        "mesh-mechanism": Fault(
            "parts of the body move against each other without strain: they hang together by an edge or a node only",
            "join the parts over facets, or support each of them",
        ),
        "mesh-mixed-cells": Fault(
            "a mesh has cells of several kinds",
            "mesh with one kind: all quadratic tetrahedra, or all bricks with the same middle nodes",
        ),
        "mesh-no-cells": Fault(
            "a mesh file holds no volume or surface cells",
            "export the mesh, not the geometry alone, with its volumes",
        ),
        "mesh-no-group": Fault(
            "a support or material names a group the mesh does not have",
            "name one of the groups listed, or add the physical group in the mesher",
        ),
        "mesh-not-finite": Fault(
            "coordinates are nan or infinite",
            "repair the file's node block",
        ),
        "mesh-not-shell": Fault(
            "a shell needs quadrilaterals",
            "mesh the mid-surface with quadrilaterals, or use the mesh as a solid",
        ),
        "mesh-not-solid": Fault(
            "a solid needs tetrahedra or hexahedra",
            "mesh the volume, or use the mesh as a shell",
        ),
        "mesh-open-seam": Fault(
            "coincident nodes are not joined: the body is slit there",
            "merge duplicate nodes in the mesher, or read the mesh with join = a distance in metres",
        ),
        "mesh-order": Fault(
            "the order of the elements is not a whole number within reach",
            "give an order of 2 to 20, or leave mesh.order out",
        ),
        "mesh-orphan-nodes": Fault(
            "nodes belong to no cell",
            "they are left out; see that no cell is missing",
        ),
        "mesh-overlap": Fault(
            "more than two cells share a facet: cells lie over each other, or shells meet in a T",
            "delete duplicate cells; shells that branch are not supported, mesh them as solids",
        ),
        "mesh-parts": Fault(
            "the mesh falls into parts that do not touch",
            "join them in the mesher, or compute each part alone",
        ),
        "mesh-rows": Fault(
            "the rows do not divide the first parameter",
            "give a whole number of at least 1, or breaks ascending from 0 to 1",
        ),
        "mesh-scale": Fault(
            "the scale or joining distance of a mesh is not a usable number",
            "give scale = 1e-3 for millimetres, join = a distance in metres",
        ),
        "mesh-scrambled-cell": Fault(
            "the nodes of a cell are in another order than the format's",
            "export again; check the order of the middle nodes",
        ),
        "mesh-support": Fault(
            "an imported mesh cannot have this kind of support",
            "use clamped, fixed (directions) or elastic with k_face alone",
        ),
        "mesh-thin-curved": Fault(
            "thin curved walls of solid cells lock: frequencies come out too high",
            "use more cells along the curve, or mesh the mid-surface and compute a shell",
        ),
        "mesh-too-large": Fault(
            "the mesh has more unknowns than a factorisation in memory can take",
            "take fewer elements; 1e5 unknowns are plenty for a shell",
        ),
        "mesh-units": Fault(
            "the part is very large for its material",
            "if the file is in millimetres, read it with scale = 1e-3",
        ),
        "mesh-unsupported-cell": Fault(
            "cells of a kind that is not supported",
            "use tetrahedra or bricks for solids, quadrilaterals for shells",
        ),
        "modes-band": Fault(
            "a band of frequencies is no band, or a count stands beside it",
            "give band = (from, to) in Hz, 0 <= from < to, or a count, not both",
        ),
        "modes-count": Fault(
            "no such number of modes can be computed",
            "ask for at least 1 and far fewer than the mesh has unknowns",
        ),
        "modes-lobpcg": Fault(
            "LOBPCG with multigrid did not find the modes, as on thin walls; shift-invert was used instead",
            "none is needed; `mesh_modes(solid, count, multigrid=False)` saves the attempt",
        ),
        "modes-method": Fault(
            "this method does not apply",
            "leave method out; harmonics need a casing on which nothing varies around",
        ),
        "modes-rigid": Fault(
            "on a mesh this coarse a thin free body bends before it turns as a whole: the rotations are not resolved",
            "leave the mesh out, or raise mesh.order or mesh.around",
        ),
        "output-direction": Fault(
            "an output asks for a direction or component that there is none of",
            "x, y, z, normal, radial, tangential for a displacement; 11, 22, 12 and a side of -1 to 1 for a strain",
        ),
        "output-name": Fault(
            "two outputs have the same name",
            "give each its own",
        ),
        "output-place": Fault(
            "an output lies off the surface",
            "give parameters within the chart's bounds",
        ),
        "reduce-damping": Fault(
            "the damping ratio is not one of a vibrating mode",
            "give zeta from 0 to below 1 (half a per cent as 0.005)",
        ),
        "reduce-method": Fault(
            "there is no such method of reduction",
            "use free or craig-bampton",
        ),
        "reduce-rigid": Fault(
            "a body that can move as a whole has no static compliance",
            "support it before reducing",
        ),
        "ring-edge": Fault(
            "a ring's section is placed by radius and axis, and its ends are free",
            "put the ring on an edge that runs around (base, top, root or tip) and ends on no held one",
        ),
        "ring-offset": Fault(
            "the place of a ring's section or foot is no pair of lengths",
            "give (radial, axial) in metres, or leave it out",
        ),
        "ring-section": Fault(
            "a ring's section has a size that is not positive and finite",
            "give width and depth, or a diameter, in metres",
        ),
        "ring-support": Fault(
            "what holds a ring must be springs: a held ring is a held edge",
            "give the ring an elastic support, bolts or none; to clamp it, clamp the edge",
        ),
        "rotation-axis": Fault(
            "an axis of rotation without direction or place",
            "give two vectors of three finite numbers",
        ),
        "rotation-blade": Fault(
            "hub radius and stagger place a blade on its hub",
            "give a hub radius of 0 or more, on an open chart",
        ),
        "rotation-large": Fault(
            "the centrifugal force bends or untwists the shell so much that linear statics no longer describe it",
            "lower the speed, or align the part with its radius; frequencies of such a state need nonlinear statics",
        ),
        "rotation-none": Fault(
            "the shell does not rotate",
            "give it a Rotation: replace(shell, rotation=...)",
        ),
        "rotation-ring": Fault(
            "the centrifugal force of rings and point masses on an edge is not modelled",
            "take them off, or make a ring a thick Strip of the shell",
        ),
        "rotation-speed": Fault(
            "the speed of rotation is not finite",
            "give it in rad/s, 2 pi times turns a second",
        ),
        "rotation-unstable": Fault(
            "spin softening exceeds the stiffness: at this speed the shell leaves its shape",
            "lower the speed, stiffen the support, or see that the hub radius and the axis are meant",
        ),
        "rotation-update": Fault(
            "tests of rotating parts are not fitted: the derivatives leave the centrifugal stiffening out",
            "fit the part at rest, then give it its rotation",
        ),
        "sensor-far": Fault(
            "a sensor does not stand on the wall of this model",
            "check the points' unit (metres), origin and axes; the axis of a casing is z",
        ),
        "sensor-twice": Fault(
            "two channels measure the same motion, so that the mass at them is not defined",
            "leave repeated channels out, or reduce the mass by SEREP",
        ),
        "shear-correction": Fault(
            "the shear correction is none of 5/6, about 1, or the thin-shell limit",
            "leave it at 5/6; give 1e6 for a wall without shear",
        ),
        "shell-free": Fault(
            "nothing holds the structure: its first modes are rigid motions",
            "give [support.EDGE], unless a free body is meant",
        ),
        "shell-thick": Fault(
            "the wall is thick for its curvature or size: shell theory is off by several per cent",
            "check the units of thickness (3 mm is 3e-3), or model it as a solid",
        ),
        "shell-thickness": Fault(
            "the wall thickness is not a positive finite number",
            "give the thickness in metres, 3 mm as 3e-3",
        ),
        "shell-thickness-size": Fault(
            "the wall is as thick as the structure is wide, or as its radius of curvature",
            "give the thickness in metres, 3 mm as 3e-3",
        ),
        "shell-thin": Fault(
            "the wall is thinner than a hundred-thousandth of the size",
            "give the thickness in metres, 3 mm as 3e-3, not 3e-6",
        ),
        "springs-negative": Fault(
            "the pattern of an elastic edge falls below -1 somewhere: a spring would push",
            "reduce the harmonics of its pattern until their sum stays above -1",
        ),
        "static-loose": Fault(
            "a rigid motion is not held, or the shell is so soft that round-off hides its stiffness",
            "hold every motion that the loads drive; where they balance, a soft elastic edge is enough",
        ),
        "strip-extent": Fault(
            "the ends of a strip are not finite numbers in order",
            "give start below end, in metres along the axis",
        ),
        "strip-off-line": Fault(
            "a strip ends inside an element, where its jump of thickness or material would be smeared",
            "leave the mesh's rows to the program, or put a break of mesh.rows at each end of the strip",
        ),
        "strip-outside": Fault(
            "a strip reaches beyond the ends of the shell",
            "give start and end in metres within the chart's bounds",
        ),
        "strip-overlap": Fault(
            "two strips claim the same part of the wall",
            "let one strip end where the next begins",
        ),
        "study-file": Fault(
            "the file cannot be read",
            "give the path of a text file in UTF-8",
        ),
        "study-key": Fault(
            "a key is unknown, or stands beside one that excludes it",
            "`casingfem schema` lists all keys",
        ),
        "study-missing": Fault(
            "a key or table that the study needs is not there",
            "add it; `casingfem schema` lists all keys",
        ),
        "study-toml": Fault(
            "the file is not TOML",
            "correct the line named; text stands in quotes, each table once",
        ),
        "study-value": Fault(
            "a value has the wrong type or lies out of range",
            "give what is expected there, in SI units",
        ),
        "support-edge": Fault(
            "a support names an edge the chart does not have",
            "casings have base and top, panels and blades root, tip, left and right",
        ),
        "support-incomplete": Fault(
            "the supports leave motions of the whole body free",
            "hold or spring the missing directions, unless the motion is meant",
        ),
        "support-kind": Fault(
            "this is no support of a shell's edge",
            "use Clamped(), ShearDiaphragm(), ElasticEdge(...), Bolts(...)",
        ),
        "support-no-springs": Fault(
            "an elastic support without any spring holds nothing",
            "give at least one of k_r, k_theta, k_z, k_rot, k_face, or leave the support out",
        ),
        "support-soft": Fault(
            "the springs are so soft that the structure floats",
            "give k_r, k_theta, k_z in N/m per m and k_face in N/m^3 (a stiff embedding has some 1e13)",
        ),
        "support-springs": Fault(
            "a spring stiffness is negative or not finite, or no spring has this name",
            "give k_r, k_theta, k_z [N/m per m], k_rot [N m/rad per m], k_face [N/m^3] from 0",
        ),
        "survey-other": Fault(
            "the survey is of another casing: its mean is not the nominal value, or its heights are not the shell's",
            "use the survey of this casing, in metres and degrees, or correct the nominal value",
        ),
        "survey-outliers": Fault(
            "a robust fit of a survey left stray points out",
            "look at the points named: chips, seams and slips of the probe are no shape, a dent is",
        ),
        "survey-quantity": Fault(
            "the survey is of another quantity",
            "let `of` name what was surveyed",
        ),
        "survey-table": Fault(
            "the survey cannot be used as it stands, or does not carry the fit asked for",
            "correct the line named, or fit fewer harmonics (n_max) and a lower degree",
        ),
        "symmetry-slanted": Fault(
            "an edge of symmetry lies in a plane that the surface meets at a right angle; a cone's rim has none",
            "model the whole body, or choose the support that is meant: clamped or shear-diaphragm",
        ),
        "taper-thickness": Fault(
            "the law of the thickness leaves no wall somewhere",
            "keep the polynomial through the stations above 0",
        ),
        "uff-gap": Fault(
            "sets of nodes and elements hold no count, and here a few of their numbers are left out",
            "compare with the program that wrote the file: were lines lost?",
        ),
        "uff-local": Fault(
            "the coordinates of nodes refer to coordinate systems of the file that are not read",
            "export the geometry in global coordinates, or see that these systems are the global one",
        ),
        "uff-shapes": Fault(
            "sets of shapes hold no count, and the shapes of one file have values at different nodes",
            "compare with the program that wrote the file: were lines lost?",
        ),
        "uff-unknown": Fault(
            "the file has a set of a number that this reader does not know; it is skipped",
            "look whether the number is the one meant",
        ),
    }
)


class ModelError(ValueError):
    """A model that is refused: `code` names the fault in the catalogue, the message ends with remedy and code.

    >>> str(ModelError("shell-thickness", "shell.thickness must be above 0, found -3.0"))
    'shell.thickness must be above 0, found -3.0: give the thickness in metres, 3 mm as 3e-3 [shell-thickness]'
    """

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


class ModelWarning(UserWarning):
    """A model that is computed although its result may mislead; same form as `ModelError`."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(sentence(code, message))


def doubt(code: str, message: str, *, stacklevel: int = 3) -> None:
    """Warn of a catalogued fault that does not stop the computation."""
    warnings.warn(ModelWarning(code, message), stacklevel=stacklevel)


def sentence(code: str, message: str) -> str:
    """What was found, what helps, and the code."""
    return f"{message}: {CATALOGUE[code].remedy} [{code}]"


def coded(code: str, message: str) -> str:
    """A message that says itself what helps, with its code; one that ends with a code keeps that.

    >>> coded("study-value", "material.nu: found 0.7, expected less than 0.5")
    'material.nu: found 0.7, expected less than 0.5 [study-value]'
    """
    return message if code_of(message) else f"{message} [{code}]"


def code_of(message: str) -> str:
    """The code at the end of a message, "" if there is none.

    >>> code_of("a wall of -3 m [shell-thickness]"), code_of("no code here")
    ('shell-thickness', '')
    """
    found = CODE.search(message)
    return found[1] if found and found[1] in CATALOGUE else ""
