"""Labelled matrices and a labelled mesh made one finite-element model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from prs_model.description.units import Dimension, Units
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import LabelledMatrices, full_model

from .labelled_mesh import LabelledMesh
from .mesh_agreement import check_against_mesh
from .solid_faces import area_shares, outer_surface


def meshed_model(
    matrices: LabelledMatrices, mesh: LabelledMesh, units: Units, provenance: Mapping[str, str]
) -> FiniteElementModel:
    """The model with the mesh's sets, areas and outer surface, in SI.

    Raises PartFileError when nodes lack coordinates, or rows of solids are none of such a mesh.
    """
    table, square = mesh.table, Dimension(length=2).factor(units)
    surface = outer_surface(mesh.solids, table.coordinates)
    weights = {
        name: sum((area_shares(*face, table.coordinates) for face in faces), np.zeros(len(surface.areas)))
        for name, faces in mesh.surfaces.items()
        if name not in mesh.node_sets
    }
    surfaces = {name: np.flatnonzero(shares) for name, shares in weights.items()}
    model = full_model(
        matrices,
        table,
        units,
        node_sets={**mesh.node_sets, **surfaces},
        triangles=surface.triangles if len(surface.triangles) else None,
        provenance={"source": str(matrices.source), **provenance},
    )
    check_against_mesh(model, mesh, matrices)
    return replace(
        model,
        mid_sides=surface.mid_sides,
        areas=surface.areas * square if len(surface.triangles) else None,
        set_weights={name: weights[name][nodes] * square for name, nodes in surfaces.items()},
    )
