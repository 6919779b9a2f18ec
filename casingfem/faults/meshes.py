"""Faults concerning meshes, generated and imported ones."""

MESHES = {
    "cyclic-axis": (
        "the sector rotates about another axis than that of [cyclic]",
        "give [rotation] and [cyclic] the same axis and point",
    ),
    "cyclic-diameters": (
        "the wheel does not have these nodal diameters",
        "give nodal diameters from 0 to half the number of sectors, or leave cyclic.nodal_diameters out",
    ),
    "cyclic-faces": (
        "the two faces of a sector do not match: nodes or facets of one, rotated by one sector, do not lie on those "
        "of the other",
        "mesh one face as a copy of the other (periodic in the mesher), name both in `faces`, or increase the "
        "tolerance",
    ),
    "cyclic-mistuning": (
        "the list of mistuning does not have one finite number above -1 for each sector",
        "give the relative deviation of frequency of each blade, 1 % as 0.01",
    ),
    "cyclic-sectors": (
        "the number of sectors does not fit the angle between the faces",
        "give the number of sectors of the whole wheel: the mesh must cover 360 degrees divided by it",
    ),
    "cyclic-support": (
        "a support is not the same in each sector",
        "give the nodes of both faces the same supports: along the axis, in both directions across it, or all three",
    ),
    "mesh-around": (
        "mesh.around is neither a number of elements nor, across an open chart, a list of breaks from 0 to 1",
        "give a whole number of at least 1, or leave mesh.around out",
    ),
    "mesh-aspect": (
        "cells are much longer than wide",
        "refine along their long side, or check the positions of the nodes",
    ),
    "mesh-attachment": (
        "a mass, spring or connection of a mesh cannot act on its nodes, or is not possible in this analysis",
        "change it in the model and export again; docs/structures.md lists what is possible",
    ),
    "mesh-branch": (
        "walls of a shell meet at an angle, which this analysis does not support",
        "compute the whole part without [cyclic], mesh the sector as a solid, or round the corner with small cells",
    ),
    "mesh-coarse": (
        "the shapes vary more within an element than its polynomials can follow: the frequencies are too high",
        "use more elements or a higher order, ask for fewer modes, or leave [mesh] out",
    ),
    "mesh-collapsed-cell": (
        "a cell contains a node twice, and is not a linear brick or quadrilateral that collapses to a solid or a "
        "triangle",
        "write such cells as wedges, pyramids or triangles",
    ),
    "mesh-distorted-cell": (
        "a cell is nearly folded somewhere",
        "remesh there; frequencies may still be good: compare with a finer mesh",
    ),
    "mesh-file": (
        "a mesh file is malformed or cut short, or contains something that this program does not read",
        "export the whole mesh again into one file, without the part that the message names",
    ),
    "mesh-floating-spring": (
        "a node without mass is connected to springs only, so that these springs have no effect",
        "support this node, for example by an SPC in the file; ignore this if a load or a contact acts on the node",
    ),
    "mesh-include": (
        "a mesh file includes a file that is missing, or that includes itself",
        "put the included file beside the file that names it, and remove circular includes",
    ),
    "mesh-flat-cell": (
        "a cell has no volume or area",
        "delete such cells, or check whether their nodes were merged by mistake",
    ),
    "mesh-flipped-shell": (
        "neighbouring shell cells have opposite normals",
        "orient all normals alike in the mesher",
    ),
    "mesh-fold": (
        "walls of a shell touch back to back at a node, so that one director cannot follow both",
        "delete cells that overlap, orient the normals alike, or separate the walls at this node",
    ),
    "mesh-format": (
        "the ending of the file name is not that of a known mesh format",
        "use .msh (Gmsh), .vtu, .inp (Abaqus, CalculiX), .bdf, .nas, .dat (Nastran), .cdb (Ansys), .unv (universal) "
        "or .med (Salome)",
    ),
    "mesh-group-empty": (
        "a group contains no node of a cell",
        "use a group on the part, or export the group's cells with the mesh",
    ),
    "mesh-group-no-cells": (
        "a group that must contain cells has none",
        "use a physical volume (for a shell: a physical surface) or an element set",
    ),
    "mesh-group-no-facets": (
        "a group that must contain facets has none: its nodes cover no facet of the boundary",
        "use a physical surface, or a set with every node of the facets",
    ),
    "mesh-hanging-node": (
        "neighbouring cells do not share all nodes of their common facet",
        "remesh so that neighbouring cells share all nodes of their common facet",
    ),
    "mesh-inverted-cell": (
        "the nodes of a cell are numbered in the wrong sense, so that its volume is negative",
        "reverse the orientation of these cells in the mesher",
    ),
    "mesh-kink": (
        "neighbouring cells of a shell meet at an angle",
        "if the surface is smooth there, refine: the angle decreases with the cell size; an intended corner needs no "
        "change",
    ),
    "mesh-last-line": (
        "the last line of a file has no line break, so that its last number may be incomplete",
        "check whether the file is complete, and add the line break",
    ),
    "mesh-left-out": (
        "a mesh file has items with stiffness, mass or constraints that are not read",
        "ignore this if the part does not need them; otherwise join parts in the mesher, and give supports in the "
        "study",
    ),
    "mesh-linear-cells": (
        "linear cells lock in bending: the part comes out too stiff",
        "use quadratic cells (order 2 in the mesher)",
    ),
    "mesh-loose-facets": (
        "triangles or quadrilaterals of a group belong to no cell of the part",
        "export the group with the part that it lies on; these facets are ignored, with the stiffness of any shells "
        "on them",
    ),
    "mesh-material-twice": (
        "a cell lies in two groups that each have a material",
        "give each cell one material, by groups that do not overlap",
    ),
    "mesh-mechanism": (
        "parts of the body move against each other without deformation: they share only an edge or a node",
        "join the parts over facets, or support each part",
    ),
    "mesh-mixed-cells": (
        "the mesh mixes cells that do not fit, such as bricks of 27 nodes or quadrilaterals of 9 nodes with others",
        "use linear cells only, or only quadratic cells with one middle node on each edge",
    ),
    "mesh-no-cells": (
        "a mesh file contains no volume or surface cells",
        "export the mesh with its cells, not only the geometry",
    ),
    "mesh-no-group": (
        "a support or material names a group that the mesh does not have",
        "use one of the groups listed, or define the physical group in the mesher",
    ),
    "mesh-not-finite": (
        "coordinates of nodes are nan or infinite",
        "correct the nodes in the file",
    ),
    "mesh-not-shell": (
        "a shell needs quadrilaterals or triangles",
        "mesh the mid-surface with quadrilaterals, or use the mesh as a solid",
    ),
    "mesh-not-solid": (
        "a solid needs tetrahedra, bricks, wedges or pyramids",
        "mesh the volume, or use the mesh as a shell",
    ),
    "mesh-open-seam": (
        "coincident nodes are not joined: the body has a slit there",
        "merge duplicate nodes in the mesher, read the mesh with join = a distance in metres, or tie the faces "
        "([[solid.tie]])",
    ),
    "mesh-order": (
        "the order of the elements is not a whole number from 2 to 20",
        "give an order from 2 to 20, or leave mesh.order out",
    ),
    "mesh-orphan-nodes": (
        "nodes belong to no cell",
        "check whether cells are missing; these nodes are ignored",
    ),
    "mesh-overlap": (
        "cells overlap: they have the same nodes, fold back at a common edge, or share a facet with two others",
        "delete the cells that were meshed twice",
    ),
    "mesh-parts": (
        "the mesh consists of parts that do not touch",
        "tie their faces ([[solid.tie]], *TIE), join them in the mesher, or compute each part alone",
    ),
    "mesh-tie": (
        "two faces cannot be tied: a group is missing or has no facets, or the gap between them is too wide",
        "name two groups of facets that touch; `tolerance` is the widest gap in metres",
    ),
    "mesh-tie-loose": (
        "nodes of a tied face are too far from the other face and are not tied",
        "let the smaller face be the follower, or increase the tolerance in metres",
    ),
    "mesh-rows": (
        "mesh.rows is neither a number of rows nor a list of breaks from 0 to 1",
        "give a whole number of at least 1, or breaks that ascend from 0 to 1",
    ),
    "mesh-scale": (
        "scale, units or join of a mesh are invalid",
        'for millimetres give units = "mm-t-s" or scale = 1e-3; give join as a distance in metres',
    ),
    "mesh-scrambled-cell": (
        "the nodes of a cell are not in the order of the file format",
        "export the mesh again; check the order of the middle nodes",
    ),
    "sections-cells": (
        "the numbers of cells of a blade of sections are invalid",
        "give whole numbers of cells along chord, span and thickness, such as [24, 20, 1]",
    ),
    "sections-disk": (
        "the disk under a blade of sections is invalid",
        "give a bore below the root section, lengths above 0, and a root thinner than the pitch",
    ),
    "mesh-support": (
        "this kind of support is not possible on an imported mesh",
        "use clamped, fixed (with directions) or elastic with k_face only",
    ),
    "mesh-thin-curved": (
        "solid cells on a thin curved wall lock: the frequencies are too high",
        "use more cells along the curve, or mesh the mid-surface and compute a shell",
    ),
    "mesh-too-large": (
        "the mesh has more unknowns than can be factorised in memory",
        "use fewer elements; 1e5 unknowns are enough for a shell",
    ),
    "mesh-turned-shell": (
        "cells of a shell had normals opposite to their neighbours', and were reversed",
        "check on which side a pressure acts and in which order plies count, or orient all normals alike in the mesher",
    ),
    "mesh-units": (
        "the part is implausibly large",
        "if the file is in millimetres, read it with scale = 1e-3",
    ),
    "mesh-unsupported-cell": (
        "the mesh has cells of a kind that is not supported",
        "use tetrahedra, bricks, wedges and pyramids for solids; quadrilaterals and triangles for shells",
    ),
    "structure-unknown": (
        "the object is not a structure, or not of a kind that this function accepts",
        "use a cf.Shell, cf.Solid or cf.MeshShell, or an object with the members of cf.imported.MeshStructure (if it "
        "rotates, of cf.imported.TurningStructure)",
    ),
    "structure-chart": (
        "this function needs a shell on a chart; an imported part has no fields, bolts or edges of a chart",
        "model the part as a cf.Shell; modes, statics, reduction, rotation and updating also accept imported parts",
    ),
    "matrix-dofs": (
        "the node and direction of each row of the matrices are not given",
        "give --dofs, a table with the columns node and direction, or a .pch file with EXTRN cards; with .mtx files "
        "a .dof file; in .npz, .mat or .h5 files an array dofs",
    ),
    "matrix-file": (
        "a file of matrices is malformed or cut short, or its matrices are not real and square",
        "export it again, with real, square matrices",
    ),
    "matrix-format": (
        "the files are not in a known format of matrices, or in several formats",
        "give one .sti, .mat, .h5 or .npz file, or .op4 files, or the .mtx files of stiffness and mass, with bulk data "
        "(.pch, .bdf, .dat, .asm) if needed; or bulk data with DMIG cards alone",
    ),
    "matrix-names": (
        "the names of the matrices do not show which are stiffness and mass",
        "name the stiffness K... or ...STIF..., the mass M..., the damping B..., C... or ...DAMP..., and the "
        "structural damping K4... or ...DMPS..., one matrix each",
    ),
    "matrix-size": (
        "the sizes of the matrices, or their dofs, do not match",
        "give square matrices of one size, with one dof for each row",
    ),
}
