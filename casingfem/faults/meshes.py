"""Faults concerning meshes, generated and imported ones."""

MESHES = {
    "cyclic-axis": (
        "the sector turns about another axis than that of the wheel it belongs to",
        "give [rotation] and [cyclic] the same axis and point",
    ),
    "cyclic-diameters": (
        "the wheel has no such nodal diameters",
        "name some of 0 to half the number of sectors, or leave cyclic.nodal_diameters out",
    ),
    "cyclic-faces": (
        "the two faces of a sector do not match: nodes or facets of one, turned, do not lie on those of the other",
        "mesh one face as a copy of the other (periodic in the mesher), name both by faces, or raise the tolerance",
    ),
    "cyclic-mistuning": (
        "the blades' deviations are not one finite number above -1 for each sector",
        "give a relative frequency deviation for each blade, 0.01 for one percent",
    ),
    "cyclic-sectors": (
        "the number of sectors does not fit the angle between the faces",
        "count the sectors of the whole wheel; 360 degrees over their number is the angle of the mesh",
    ),
    "cyclic-support": (
        "a support of a sector does not repeat around the wheel",
        "give the nodes of both faces the same supports: along the axis, across it in both directions, or both",
    ),
    "mesh-around": (
        "there is no such number of elements",
        "give a whole number of at least 1, or leave mesh.around out",
    ),
    "mesh-aspect": (
        "cells are much longer than wide",
        "refine along their long side, or check the positions of the nodes",
    ),
    "mesh-attachment": (
        "a mass, spring or connection of a mesh cannot be put on its nodes, or not in this analysis",
        "change it in the model and export again; docs/structures.md lists what each can be",
    ),
    "mesh-branch": (
        "walls of a shell meet at an angle, and this analysis is limited to one wall",
        "compute the whole part without [cyclic], mesh the sector as a solid, or round the fold off with small cells",
    ),
    "mesh-coarse": (
        "the shapes bend more within an element than its polynomials can follow: frequencies are too high",
        "ask for more elements or a higher order, for fewer modes, or leave [mesh] out",
    ),
    "mesh-collapsed-cell": (
        "a cell has the same node twice, and is no linear brick or square that collapses to a solid or a triangle",
        "mesh without such cells, or with the wedges, pyramids and triangles that they collapse to",
    ),
    "mesh-distorted-cell": (
        "a cell is nearly folded somewhere",
        "remesh there; frequencies may still be good, compare with a finer mesh",
    ),
    "mesh-file": (
        "a mesh file is malformed, cut short, or has what this program does not read",
        "export it again whole, in one file, without what the message names",
    ),
    "mesh-floating-spring": (
        "a node without mass is connected to springs only, so that these springs have no effect",
        "give a support on it, such as the file's own SPC or set; leave it where a load or a contact pushes it",
    ),
    "mesh-include": (
        "a mesh file includes another one that is not there, or that includes itself",
        "put the included file beside the one that names it",
    ),
    "mesh-flat-cell": ("a cell has no volume or area", "delete it, or check whether its nodes were merged by mistake"),
    "mesh-flipped-shell": (
        "neighbouring shell cells are numbered in opposite senses",
        "orient the normals alike in the mesher",
    ),
    "mesh-fold": (
        "walls of a shell touch at a node back to back: one director cannot follow both",
        "delete cells that lie over each other, orient the normals alike there, or part the walls at the node",
    ),
    "mesh-format": (
        "the ending of a mesh file is not one of those known",
        "give .msh (Gmsh), .vtu, .inp (Abaqus, CalculiX), .bdf, .nas, .dat (Nastran), .cdb (Ansys), .unv (universal) "
        "or .med (Salome)",
    ),
    "mesh-group-empty": (
        "a group contains no node of a cell",
        "name a group on the part, or save the group's cells with the mesh",
    ),
    "mesh-group-no-cells": (
        "a material is given to a group without cells",
        "give it to a physical volume (for a shell: surface) or an element set",
    ),
    "mesh-group-no-facets": (
        "a foundation needs facets, and the group's nodes cover none on the boundary",
        "name a physical surface, or every node of the facets",
    ),
    "mesh-hanging-node": (
        "neighbouring cells do not share all nodes of their common facet",
        "remesh so that cells meet node to node",
    ),
    "mesh-inverted-cell": (
        "the nodes of a cell run round it the wrong way, its volume is negative",
        "reverse the cells' orientation in the mesher",
    ),
    "mesh-kink": (
        "neighbouring cells of a shell meet at an angle",
        "refine there if the surface is smooth: the angle decreases with the cell size; an intended corner needs no "
        "change",
    ),
    "mesh-last-line": (
        "the last line of a file has no end: its last number may be a part of one",
        "check whether the file is complete, and end it with a line break",
    ),
    "mesh-left-out": (
        "items of a mesh file with stiffness, mass or constraints are not taken over",
        "the body is computed without them; join parts in the mesher, give supports in the study",
    ),
    "mesh-linear-cells": (
        "linear cells lock: bending comes out too stiff",
        "use quadratic cells (order 2 in the mesher)",
    ),
    "mesh-loose-facets": (
        "triangles or squares of a group lie on no cell of the part",
        "they are left out, with the stiffness they may have as shells; save the group with the part it is on",
    ),
    "mesh-material-twice": (
        "a cell lies in two groups that each have a material",
        "give each cell one material: the groups must not overlap",
    ),
    "mesh-mechanism": (
        "parts of the body move against each other without strain: they share only an edge or a node",
        "join the parts over facets, or support each of them",
    ),
    "mesh-mixed-cells": (
        "a mesh mixes cells that do not fit: bricks of 27 nodes, or squares of nine, with other kinds",
        "mesh with linear kinds, or with quadratic ones of one node on an edge",
    ),
    "mesh-no-cells": (
        "a mesh file contains no volume or surface cells",
        "export the mesh, not the geometry alone, with its volumes",
    ),
    "mesh-no-group": (
        "a support or material names a group the mesh does not have",
        "name one of the groups listed, or add the physical group in the mesher",
    ),
    "mesh-not-finite": ("coordinates are nan or infinite", "repair the file's node block"),
    "mesh-not-shell": (
        "a shell needs quadrilaterals",
        "mesh the mid-surface with quadrilaterals, or use the mesh as a solid",
    ),
    "mesh-not-solid": ("a solid needs tetrahedra or hexahedra", "mesh the volume, or use the mesh as a shell"),
    "mesh-open-seam": (
        "coincident nodes are not joined: the body is slit there",
        "merge duplicate nodes in the mesher, read it with join = a distance in metres, or tie faces ([[solid.tie]])",
    ),
    "mesh-order": (
        "the order of the elements is not a whole number within reach",
        "give an order of 2 to 20, or leave mesh.order out",
    ),
    "mesh-orphan-nodes": ("nodes belong to no cell", "the nodes are ignored; check that no cell is missing"),
    "mesh-overlap": (
        "cells lie over each other: they have the same nodes, fold back beside a common edge, or share a solid's facet",
        "delete the cells that were meshed twice",
    ),
    "mesh-parts": (
        "the mesh falls into parts that do not touch",
        "tie their faces ([[solid.tie]], *TIE), join them in the mesher, or compute each part alone",
    ),
    "mesh-tie": (
        "two faces cannot be tied",
        "name two groups of facets that touch; tolerance is how far apart they may be, in metres",
    ),
    "mesh-tie-loose": (
        "nodes of a tied face are too far from the other one and are not tied",
        "let the smaller face follow the larger one, or give a larger tolerance in metres",
    ),
    "mesh-rows": (
        "the rows do not divide the first parameter",
        "give a whole number of at least 1, or breaks ascending from 0 to 1",
    ),
    "mesh-scale": (
        "the scale, units or joining distance of a mesh cannot be used",
        'give units = "mm-t-s" or scale = 1e-3 for millimetres, join = a distance in metres',
    ),
    "mesh-scrambled-cell": (
        "the nodes of a cell are in another order than the format's",
        "export again; check the order of the middle nodes",
    ),
    "sections-cells": (
        "a blade of sections cannot be divided into the cells asked for",
        "give whole numbers of cells along chord, span and thickness, such as [24, 20, 1]",
    ),
    "mesh-support": (
        "an imported mesh cannot have this kind of support",
        "use clamped, fixed (directions) or elastic with k_face alone",
    ),
    "mesh-thin-curved": (
        "thin curved walls of solid cells lock: frequencies come out too high",
        "use more cells along the curve, or mesh the mid-surface and compute a shell",
    ),
    "mesh-too-large": (
        "the mesh has more unknowns than a factorisation in memory can take",
        "use fewer elements; 1e5 unknowns are enough for a shell",
    ),
    "mesh-turned-shell": (
        "cells of a shell have their normals against a neighbour's, and were turned round",
        "check which side a pressure acts on and from which plies count, or orient the normals alike in the mesher",
    ),
    "mesh-units": (
        "the part is very large for its material",
        "if the file is in millimetres, read it with scale = 1e-3",
    ),
    "mesh-unsupported-cell": (
        "cells of a kind that is not supported",
        "use tetrahedra, bricks, wedges and pyramids for solids; quadrilaterals and triangles for shells",
    ),
    "structure-unknown": (
        "the object is not a structure, or not of the kind that this function needs",
        "give a cf.Shell, cf.Solid or cf.MeshShell, or a value with the members of cf.imported.MeshStructure; "
        "one with a rotation needs those of cf.imported.TurningStructure",
    ),
    "structure-chart": (
        "this needs a shell on a chart: an imported part has no fields, no bolts and no chart's edges",
        "model the part as a cf.Shell; modes, statics, reduction, rotation and updates take imported parts too",
    ),
    "matrix-dofs": (
        "the matrices do not name the node and direction of a row",
        "give --dofs, a table with the columns node, direction; or a .pch with EXTRN cards beside it; beside .mtx "
        "files a .dof file does; in arrays, dofs",
    ),
    "matrix-file": (
        "a file of matrices is malformed, cut short, or not of this kind",
        "write it again from the program it comes from; real, square matrices are read",
    ),
    "matrix-format": (
        "the files are not of a format of matrices, or not of one format",
        "give one .sti, .mat, .h5 or .npz, .op4 files, or the .mtx files of stiffness and mass, maybe beside bulk data "
        "(.pch, .bdf, .dat, .asm), or bulk data with DMIG cards alone",
    ),
    "matrix-names": (
        "the names of the matrices do not show which are stiffness and mass",
        "name the stiffness K... or ...STIF..., the mass M..., the damping B..., C... or ...DAMP..., structural "
        "damping K4... or ...DMPS..., one each",
    ),
    "matrix-size": (
        "matrices and dofs do not belong together",
        "give square matrices of one size, with one dof for each row",
    ),
}
