"""Solids of one or several isotropic materials from a mesh of tetrahedra, in any format that meshio reads."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import Field, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError
from scipy.sparse import csr_array

from prs_model.arrays import IntArray
from prs_model.description.problems import did_you_mean
from prs_model.description.quantity import Density, Number, Pressure
from prs_model.description.schema import Section
from prs_model.description.units import SI, Dimension, Units
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.plugins import PartRequest, Reducer

from .elements.tetrahedra import Material, assemble, face_areas, outer_faces
from .meshes.keyword_deck import deck_files
from .meshes.mesh_file import TetrahedralMesh, read_mesh
from .meshes.mid_sides import check_mid_sides

logger = logging.getLogger("prs_model")


# lowest and highest value that a solid has, and steel's, in SI
PLAUSIBLE = {
    "E": (Dimension(force=1, length=-2), 1e6, 2e12, 2.1e11),
    "density": (Dimension(mass=1, length=-3), 10.0, 3e4, 7850.0),
}


class MaterialOptions(Section):
    """Isotropic elasticity: Young's modulus, Poisson's ratio, density."""

    E: Pressure
    nu: Number
    density: Density

    @model_validator(mode="after")
    def _of_a_solid(self, info: ValidationInfo) -> MaterialOptions:
        units: Units = (info.context or {}).get("units", SI)
        for name, (dimension, low, high, steel) in PLAUSIBLE.items():
            value, factor = float(getattr(self, name)), dimension.factor(units)
            if not low <= value <= high:
                unit = dimension.label(units)
                in_si = "" if factor == 1.0 else f" ({value:.4g} {dimension.label(SI)})"
                raise PydanticCustomError(
                    name,
                    f"found {name} = {value / factor:.4g} {unit}{in_si}, which no solid has; "
                    f"steel is {steel / factor:.4g} {unit}: check the units",
                )
        if not -1.0 < self.nu < 0.5:
            raise PydanticCustomError("nu", f"found nu = {self.nu:g}, expected more than -1 and less than 0.5")
        return self


class SolidOptions(Section):
    """One material for the whole part, or one for each named volume of the mesh."""

    material: MaterialOptions | None = None
    materials: dict[str, MaterialOptions] = Field(default={})

    @model_validator(mode="after")
    def _one_of_them(self) -> SolidOptions:
        if (self.material is None) == (not self.materials):
            found = "neither" if self.material is None else "both"
            raise PydanticCustomError("material", f"found {found}, expected 'material' or 'materials'")
        return self


class SolidReducer(Reducer[SolidOptions]):
    description: ClassVar[str] = "solid from a tetrahedral mesh (gmsh and others through meshio), ten-node elements"
    Options: ClassVar[type[Section]] = SolidOptions
    gives = "full"

    def read(self, part: PartRequest[SolidOptions]) -> FiniteElementModel:
        """Assemble the mesh; named groups of it become node sets, surfaces with their areas as weights."""
        return solid_model(read_mesh(part.path), part.options, Dimension(length=1).factor(part.file_units))

    def files(self, part: PartRequest[SolidOptions]) -> tuple[Path, ...]:
        return deck_files(part.path) if part.path.suffix.lower() == ".inp" else (part.path,)


def solid_model(mesh: TetrahedralMesh, options: SolidOptions, scale: float = 1.0) -> FiniteElementModel:
    """The finite-element model of a mesh whose lengths are `scale` m. Raises PartFileError, MissingExtraError."""
    if mesh.elements.shape[1] == 4:
        logger.warning(
            "%s: four-node tetrahedra are far too stiff in bending; mesh the part with ten-node ones", mesh.source
        )
    points = mesh.points * scale
    size = 3 * len(points)
    stiffness, mass = csr_array((size, size)), csr_array((size, size))
    for elements, material in _by_material(mesh, options):
        try:
            k, m = assemble(points, elements, material)
        except ValueError as error:
            raise PartFileError(mesh.source, str(error)) from error
        stiffness, mass = stiffness + k, mass + m
    nodes, skin = np.arange(len(points)), _skin(mesh)
    return FiniteElementModel(
        stiffness=stiffness,
        mass=mass,
        coordinates=points,
        dofs=np.column_stack([np.repeat(nodes, 3), np.tile(np.arange(3), len(points))]),
        node_ids=mesh.labels,
        node_sets={name: np.unique(cells) for name, cells in mesh.groups.items()},
        set_weights={
            name: face_areas(points, cells)[np.unique(cells)]
            for name, cells in mesh.groups.items()
            if name in mesh.surfaces
        },
        areas=face_areas(points, skin),
        triangles=skin[:, :3],
        mid_sides=skin[:, 3:],
        provenance={"elements": f"{len(mesh.elements)} tetrahedra of {mesh.elements.shape[1]} nodes"},
    )


def _skin(mesh: TetrahedralMesh) -> IntArray:
    try:
        if mesh.elements.shape[1] == 10:
            check_mid_sides(mesh.elements)
        return outer_faces(mesh.elements)
    except ValueError as error:
        raise PartFileError(mesh.source, str(error)) from error


def _by_material(mesh: TetrahedralMesh, options: SolidOptions) -> Iterator[tuple[IntArray, Material]]:
    """Elements with their material. Raises PartFileError for an unknown volume, or elements of none or of two."""
    if options.material is not None:
        yield mesh.elements, _material(options.material)
        return
    given = np.zeros(len(mesh.elements), dtype=int)
    for name, material in options.materials.items():
        if name not in mesh.volumes:
            known = ", ".join(mesh.volumes) or "none (the mesh names no volumes)"
            message = f"options.materials: found volume '{name}', expected one of {known}"
            raise PartFileError(mesh.source, message + did_you_mean(name, mesh.volumes))
        given[mesh.volumes[name]] += 1
        yield mesh.elements[mesh.volumes[name]], _material(material)
    if np.any(given != 1):
        missing, twice = np.count_nonzero(given == 0), np.count_nonzero(given > 1)
        raise PartFileError(
            mesh.source,
            f"options.materials: {missing} elements have no material and {twice} more than one, of {len(given)}",
        )


def _material(options: MaterialOptions) -> Material:
    return Material(float(options.E), float(options.nu), float(options.density))
