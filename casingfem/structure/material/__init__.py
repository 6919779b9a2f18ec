"""Material of a wall: isotropic, linear elastic."""

from casingfem.structure.material.isotropic import Material, plane_stress

__all__ = ["Material", "plane_stress"]
