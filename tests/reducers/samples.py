"""A part in every format: real exports where there are some, else a steel block or the kit's plain part."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
from scipy.sparse import csr_array

from prs_model import plugins
from prs_model.description.units import Units
from prs_model.testing import Sample
from prs_model.testing.element import plain_element
from prs_reducers.ansys import load_full
from prs_reducers.meshes.mesh_file import TetrahedralMesh
from tests.meshes import STEEL, box, steel, write
from tests.reducers.decks import BAR_MASS, write_bar
from tests.reducers.writers.ansys import FOOT, ROTOR, back, listing, market, places_of
from tests.reducers.writers.extdb import write_extdb
from tests.reducers.writers.openfast import flex
from tests.reducers.writers.samcef import DECK, fortran, matrices, table
from tests.superelements import DATA, reference

BLOCK, COARSE, FINE = (0.12, 0.04, 0.03), (2, 1, 1), (3, 1, 1)  # m, cells
MASS = STEEL["density"] * float(np.prod(BLOCK))
MM = "mm-N-tonne-s"
SIDES = {"base": {"set": "x0"}, "tip": {"set": "x1"}}
PLAIN = {"base": {"node": 11}, "tip": {"node": 23}}

ONCE = "a mode's stiffness, mass between a mode and a node, a rotary inertia: such a number stands there once"
ANY_NUMBER = {"*: another digit*": ONCE, "*: a bit flipped*": ONCE}
UNCOUNTED = {"*: a line missing*": "the format does not say how many entries there are, and zeros have none"}
SHAPE = "another shape of a mesh is a mesh: a coordinate stands there once, and a deck does not count its elements"
ANY_SHAPE = {f"*: {damage}*": SHAPE for damage in ("another digit", "a bit flipped", "a line missing")}
ANY_SET = {"*.inp: another digit*": "which nodes a set names, nothing else says"}
ANY_ORDER = {"*_mass.mtx: *lines swapped*": "in array format the line alone says which entry a number is"}
HELD = "a part that is held has no rigid motion to check, and each number on the diagonal stands there once"


def block(cells: tuple[int, int, int] = COARSE) -> TetrahedralMesh:
    return box(BLOCK, cells)


def among_others(export: Callable[[Path, TetrahedralMesh], Sample], folder: Path) -> Sample:
    """A coarse block, beside a fine one whose companions could be taken for its own."""
    (folder / "fine").mkdir()
    other = export(folder / "fine", block(FINE))
    return replace(export(folder, block()), others={file.name: file for file in other.files()[1:]})


def npz(folder: Path) -> Sample:
    plain_element().save(folder / "part.npz")
    return Sample("npz", folder / "part.npz", interfaces=PLAIN, mass=3.5)


def gmsh(folder: Path) -> Sample:
    path = write(block(), folder / "part.msh", 1e3)
    return Sample("solid", path, MM, {"material": STEEL}, SIDES, mass=MASS)


def gmsh_text(folder: Path) -> Sample:
    """The same mesh as text, its shape hardly protected."""
    sample = gmsh(folder)
    meshio.write(sample.path, meshio.read(sample.path), file_format="gmsh22", binary=False)
    return replace(sample, unseen=ANY_SHAPE)


def gmsh_41(folder: Path) -> Sample:
    """A bracket as gmsh writes it today, text of version 4.1."""
    bores = {"foot": {"set": "IF1"}, "head": {"set": "IF2"}}
    volume = 1e-9 * reference("calculix/solver_frequencies_hz")["CAD_volume_mm3"]
    return Sample(
        "solid",
        DATA / "calculix" / "bracket.msh",
        MM,
        {"material": STEEL},
        bores,
        mass=STEEL["density"] * volume,
        accuracy=1e-3,
        unseen=ANY_SHAPE | {"*: units m-N-kg-s": "a bracket of 100 m is as sound as one of 100 mm; its mass is said"},
    )


def solid_deck(folder: Path) -> Sample:
    path = deck(block(), folder / "part.inp")
    return Sample("solid", path, MM, {"material": STEEL}, SIDES, mass=MASS, unseen=ANY_SHAPE)


def calculix(folder: Path) -> Sample:
    return among_others(_calculix, folder)


def _calculix(folder: Path, mesh: TetrahedralMesh) -> Sample:
    """Upper triangles, column by column, in the digits of CalculiX; all in mm, N, tonne."""
    model = steel(mesh)
    deck(mesh, folder / "part.inp")
    columns, rows = np.nonzero(np.tril(np.abs(model.stiffness.toarray()) + np.abs(model.mass.toarray())))
    for suffix, matrix in ((".sti", model.stiffness), (".mas", model.mass)):
        values = matrix.toarray()[rows, columns] * 1e-3
        lines = (f"{r + 1} {c + 1}  {v:.13e}" for r, c, v in zip(rows, columns, values, strict=True))
        (folder / f"part{suffix}").write_text("\n".join(lines) + "\n")
    (folder / "part.dof").write_text("".join(f"{node + 1}.{axis + 1}\n" for node, axis in model.dofs))
    return Sample("calculix", folder / "part.sti", MM, {}, SIDES, mass=MASS, unseen=ANY_SET)


def abaqus(folder: Path) -> Sample:
    return among_others(_abaqus, folder)


def _abaqus(folder: Path, mesh: TetrahedralMesh) -> Sample:
    """Coordinate form, both triangles, as *MATRIX OUTPUT writes it."""
    model = steel(mesh)
    deck(mesh, folder / "part.inp")
    for name, matrix in (("STIF1", model.stiffness), ("MASS1", model.mass)):
        (folder / f"part_{name}.mtx").write_text("".join(entries(matrix, 1e-3)))
    return Sample("abaqus", folder / "part_STIF1.mtx", MM, {"mesh": "part.inp"}, SIDES, mass=MASS, unseen=ANY_SET)


def abaqus_beams(folder: Path) -> Sample:
    """Rows with labels, rotations among them, which the mass file may leave out."""
    return Sample("abaqus", write_bar(folder), "m-N-kg-s", {}, SIDES, mass=BAR_MASS, unseen=ANY_NUMBER | UNCOUNTED)


def matrix_market(folder: Path) -> Sample:
    """As this program writes it: the table has the matrices' SHA-256, so no number can change unseen."""
    return written("matrix_market", folder / "part.mtx", {})


def matrix_market_of_others(folder: Path) -> Sample:
    """As another program writes it: one triangle, nothing said twice."""
    sample = matrix_market(folder)
    table = folder / "part_dofs.txt"
    table.write_text("".join(line for line in table.read_text().splitlines(keepends=True) if "sha256" not in line))
    return replace(sample, unseen=ANY_NUMBER | ANY_ORDER)


def dmig(folder: Path) -> Sample:
    return written("nastran", folder / "part.pch", {})


def dmig_of_others(folder: Path) -> Sample:
    """Without our comments, as Nastran writes it."""
    sample = dmig(folder)
    lines = sample.path.read_text().splitlines(keepends=True)
    sample.path.write_text("".join(line for line in lines if not line.startswith("$")))
    return replace(sample, unseen=ANY_NUMBER | UNCOUNTED)


def op4(folder: Path) -> Sample:
    return written("nastran", folder / "part.op4", {})


def written(reducer: str, path: Path, unseen: dict[str, str]) -> Sample:
    """The plain part as the reducer itself writes it."""
    plugins.reducer(reducer).write(plain_element(), path, Units.parse(MM))
    return Sample(reducer, path, MM, {}, PLAIN, mass=3.5, unseen=unseen)


def extdb(folder: Path) -> Sample:
    """DMIGOP2 as it is documented, without coordinates of its own for units: lengths in m."""
    path = write_extdb(folder / "part.op2", plain_element())
    return Sample("nastran", path, "m-N-kg-s", {}, PLAIN, mass=3.5, unseen=ANY_NUMBER)


def samcef(folder: Path) -> Sample:
    """Two dense matrices, a table of rows, and coordinates and units from a BACON deck."""
    stiffness, mass = matrices()
    (folder / "k.txt").write_text(fortran(stiffness))
    (folder / "m.txt").write_text(fortran(mass))
    (folder / "dofs.txt").write_text(table(places=False))
    (folder / "part.dat").write_text(DECK)
    options = {"mass": "m.txt", "dofs": "dofs.txt", "deck": "part.dat"}
    return Sample("samcef", folder / "k.txt", MM, options, PLAIN, mass=4.0, unseen=ANY_NUMBER)


def openfast(folder: Path) -> Sample:
    """ExtPtfm text of a clamped substructure with one mode of 3 Hz."""
    (folder / "part.dat").write_text(flex())
    unseen = {"*: another digit*": HELD, "*: a bit flipped*": HELD}
    top = {"top": {"node": "interface"}}
    return Sample(
        "openfast", folder / "part.dat", interfaces=top, grounded=True, fixed=(3.0,), accuracy=1e-6, unseen=unseen
    )


def ansys_export(folder: Path) -> Sample:
    return among_others(_ansys_export, folder)


def _ansys_export(folder: Path, mesh: TetrahedralMesh) -> Sample:
    """APDL's *EXPORT of both matrices as MMF, the nodes of their rows, and a list of nodes with decimal commas."""
    model = steel(mesh)
    labels = np.arange(1, len(model.coordinates) + 1)
    (folder / "k.txt").write_text(market(model.stiffness.toarray()))
    (folder / "m.txt").write_text(market(model.mass.toarray()))
    (folder / "map.txt").write_text(back(labels))
    (folder / "nodes.txt").write_text(listing(labels, model.coordinates))
    options = {"mass": "m.txt", "map": "map.txt", "coordinates": "nodes.txt"}
    ends = {
        name: {"plane": {"point": (x, 0.0, 0.0), "normal": (1, 0, 0), "tolerance": 1e-6}}
        for name, x in (("base", 0.0), ("tip", BLOCK[0]))
    }
    return Sample("ansys", folder / "k.txt", "m-N-kg-s", options, ends, mass=MASS)


def ansys_full(folder: Path) -> Sample:
    """The public .full file, with the coordinates that its stiffness tells (see `places_of`)."""
    source = shutil.copy(ROTOR, folder / "part.full")
    nodes, points = places_of(load_full(Path(source)))
    (folder / "nodes.txt").write_text(listing(nodes, points))
    free = (reference("ansys/sparse.full")["freq_hz_first"][6],)
    return Sample("ansys", source, "m-N-kg-s", {"coordinates": "nodes.txt"}, FOOT, free=free)


def rigid(folder: Path) -> Sample:
    options = {"mass": 2.0, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}, "nodes": {"tip": (0.0, 0.0, 0.1)}}
    return Sample("rigid", options=options, interfaces={"tip": {}}, mass=2.0)


def lumped(folder: Path) -> Sample:
    """Two masses on a spring: omega^2 = k (1/m1 + 1/m2)."""
    options = {
        "nodes": {"a": (0.0, 0.0, 0.0), "b": (0.3, 0.0, 0.0)},
        "masses": {"a": {"mass": 2.0}, "b": {"mass": 3.0}},
        "springs": ({"between": ("a", "b"), "axial": 1e6},),
    }
    free = (float(np.sqrt(1e6 * (1.0 / 2.0 + 1.0 / 3.0)) / (2.0 * np.pi)),)
    return Sample("lumped", options=options, mass=5.0, free=free)


def beam(folder: Path) -> Sample:
    """A bar of the block's size; its mass is exact."""
    length, width, height = BLOCK
    options = {
        "nodes": {"base": (0.0, 0.0, 0.0), "tip": (length, 0.0, 0.0)},
        "sections": {"bar": {"kind": "rectangle", "y": width, "z": height, "material": STEEL}},
        "members": ({"between": ("base", "tip"), "section": "bar", "elements": 6, "up": (0, 0, 1)},),
    }
    return Sample("beam", options=options, interfaces={"base": {"node": "base"}, "tip": {"node": "tip"}}, mass=MASS)


def outboard(folder: Path) -> Sample:
    grids = {f"g{grid}": {"node": grid} for grid in (3, 11, 19, 27)}
    data = DATA / "nastran_extseout"
    others = {f"outboard{suffix}": data / f"inboard{suffix}" for suffix in (".asm", ".pch")}
    return Sample("nastran", data / "outboard.op4", MM, {}, grids, mass=1590.3838, others=others)


def nas2cam(folder: Path) -> Sample:
    grids = {f"g{grid}": {"node": grid} for grid in (3, 11, 19, 27)}
    source = DATA / "nastran_extseout" / "nas2cam.op2"
    return Sample("nastran", source, MM, {"superelement": 101}, grids, mass=1590.3838)


def bracket(folder: Path) -> Sample:
    bores = {
        name: {"cylinder": {"point": point, "axis": axis, "radius": 0.01, "tolerance": 1e-4}}
        for name, point, axis in (("foot", (0.04, 0.03, 0.0), (0, 0, 1)), ("head", (0.088, 0.03, 0.05), (1, 0, 0)))
    }
    return Sample("calculix", DATA / "calculix" / "full_free.sti.gz", MM, {}, bores, mass=0.89038919)


def rotor(folder: Path) -> Sample:
    source = DATA / "abaqus" / "rotorDiscTestSTIF1.mtx"
    ends = {
        name: {"plane": {"point": (0.0, 0.0, z), "normal": (0, 0, 1), "tolerance": 1e-6}}
        for name, z in (("left", 0.0), ("right", 0.5))
    }
    return Sample("abaqus", source, "m-N-kg-s", {"mesh": "rotorDiscTest.inp"}, ends)


def subdyn(folder: Path) -> Sample:
    source = DATA / "openfast" / "FASTSum_5MW_OC3Mnpl.SD.sum.yaml"
    free = tuple(reference("openfast/SubDyn_OC3Mnpl")["GY_recomputed"])
    return Sample("openfast", source, interfaces={"tower": {"node": "interface"}}, grounded=True, free=free)


def extptfm(folder: Path) -> Sample:
    """Three translations only, so nothing is named to take hold of them; the gate and the figures see it all."""
    source = DATA / "openfast" / "FASTIn_ExtPtfm_SubSef.dat"
    unseen = {"*: another digit*": HELD, "*: a bit flipped*": HELD}
    return Sample("openfast", source, options={"components": ("ux", "uy", "uz")}, grounded=True, unseen=unseen)


OWN: tuple[Callable[[Path], Sample], ...] = (
    npz, gmsh, gmsh_text, solid_deck, calculix, abaqus, abaqus_beams, matrix_market, matrix_market_of_others,
    dmig, dmig_of_others, op4, extdb, samcef, openfast, ansys_export,
)  # fmt: skip
REAL: tuple[Callable[[Path], Sample], ...] = (outboard, nas2cam, ansys_full, subdyn, extptfm)
WITHOUT_FILE: tuple[Callable[[Path], Sample], ...] = (rigid, lumped, beam)
BIG: tuple[Callable[[Path], Sample], ...] = (bracket, rotor, gmsh_41)


def entries(matrix: csr_array, factor: float) -> Iterable[str]:
    full = matrix.tocoo()
    rows, columns = full.coords
    for row, column, value in zip(rows, columns, full.data, strict=True):
        yield f"{row + 1} {column + 1}  {value * factor:.15e}\n"


def deck(mesh: TetrahedralMesh, path: Path) -> Path:
    """A deck in mm with the sides as node sets; nodes are numbered from 1 in the mesh's order."""
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{i}, {x:.9g}, {y:.9g}, {z:.9g}" for i, (x, y, z) in enumerate(mesh.points * 1e3, start=1)]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=ALL"]
    lines += [f"{i}, {', '.join(str(node + 1) for node in nodes)}" for i, nodes in enumerate(mesh.elements, start=1)]
    for name in sorted(mesh.surfaces):
        nodes = [str(node + 1) for node in np.unique(mesh.groups[name])]
        lines += [f"*NSET, NSET={name}", *(", ".join(nodes[at : at + 16]) for at in range(0, len(nodes), 16))]
    path.write_text("\n".join(lines) + "\n")
    return path
