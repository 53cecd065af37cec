"""Bodies as triangles, and the same as glTF."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.reduction import SuperElement
from prs_model.reduction.stand_in import stand_in
from prs_model.report.glb import glb
from prs_model.report.scene import edges_of, scene_of


def test_edges_of_a_box_are_its_twelve() -> None:
    element = prs.load_machine("hexapod").parts["upper_1"]
    assert isinstance(element, SuperElement)
    surface = stand_in(element, thickness=1e-4)
    edges = edges_of(surface.points[:8], surface.triangles[:12])
    assert len(edges) == 12
    assert np.count_nonzero(np.ptp(surface.points[:8][edges], axis=1) > 1e-9) == 12  # along one axis each, no diagonals
    assert len(edges_of(surface.points[:8], surface.triangles[:11])) == 13  # a face left out bares its diagonal


def test_scene_has_every_body_where_it_stands() -> None:
    modes = prs.load_machine("head_3prs").modes(3, nutation=0.2)
    scene = scene_of(modes)
    assert [shape.name for shape in scene.shapes] == list(modes.system.elements)
    largest = np.max([np.linalg.norm(s.displacements, axis=2).max(axis=1) for s in scene.shapes], axis=0)
    assert largest == pytest.approx(np.ones(3))
    platform = next(shape for shape in scene.shapes if shape.name == "platform")
    nearest = np.linalg.norm(platform.points - scene.output, axis=1)
    tool = platform.displacements[:, np.argmin(nearest)]
    expected = (scene.axes @ modes.output_shapes[:3]).T
    cosines = np.sum(tool * expected, axis=1) / np.linalg.norm(tool, axis=1) / np.linalg.norm(expected, axis=1)
    assert cosines[:2] == pytest.approx([1.0, 1.0], abs=0.01)  # the third turns about the tool


def test_glb_is_read_by_others_as_it_was_meant(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    scene = scene_of(prs.load_machine("hexapod").modes(2))
    (tmp_path / "mode.glb").write_bytes(glb(scene, 1, "mode 2"))
    read = trimesh.load(tmp_path / "mode.glb")
    assert set(read.geometry) == {shape.name for shape in scene.shapes}
    low, high = np.array(read.bounds)
    ours = np.vstack([shape.points for shape in scene.shapes])
    assert low[[0, 1]] == pytest.approx(ours.min(axis=0)[[0, 2]], abs=1e-6)  # y is up there
    assert high[[0, 1]] == pytest.approx(ours.max(axis=0)[[0, 2]], abs=1e-6)


def test_glb_swings_by_the_mode(tmp_path: Path) -> None:
    import json
    import struct

    scene = scene_of(prs.load_machine("hexapod").modes(2))
    content = glb(scene, 1, "mode 2", amplitude=0.1)
    length = struct.unpack("<I", content[12:16])[0]
    document, numbers = json.loads(content[20 : 20 + length]), content[28 + length :]

    def read(number: int) -> np.ndarray:
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        return np.frombuffer(numbers, "<f4", view["byteLength"] // 4, view["byteOffset"])

    sampler = document["animations"][0]["samplers"][0]
    times, weights = read(sampler["input"]), read(sampler["output"])
    assert weights == pytest.approx(np.sin(2.0 * np.pi * times / times[-1]), abs=1e-6)
    assert len(document["animations"][0]["channels"]) == len(scene.shapes)
    for mesh, shape in zip(document["meshes"], scene.shapes, strict=True):
        moved = read(mesh["primitives"][0]["targets"][0]["POSITION"]).reshape(-1, 3)
        assert moved == pytest.approx(0.1 * scene.size * shape.displacements[1], abs=1e-7)
