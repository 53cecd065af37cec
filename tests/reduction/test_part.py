"""Building parts: the store, its recipes, identical limbs, and parts that come already reduced."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite

import prs_model as prs
from prs_model.description.schema import Body, ReductionDefaults
from prs_model.reduction import build_part
from prs_model.reduction.request import part_name
from prs_reducers.solid import SolidReducer
from tests.meshes import STEEL, box, steel, write

STEEL_MM = {"units": "mm-N-tonne-s", "material": STEEL}
DEFAULTS = ReductionDefaults(method="craig-bampton", store="reduced", modes=2)


def body(**changes: object) -> Body:
    entries = {
        "frame": "rod_1",
        "reducer": "solid",
        "source": "rod.msh",
        "units": "mm-N-tonne-s",
        "options": {"material": STEEL},
        "interfaces": {"hinge": {"set": "x0"}, "tip": {"set": "x1"}},
    }
    return Body.model_validate(entries | changes)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(box((0.35, 0.05, 0.05), (5, 1, 1)), tmp_path / "rod.msh", scale=1000.0)
    return tmp_path


def stored(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "reduced").glob("*"))


def test_a_part_is_reduced_once_and_then_found(folder):
    first = build_part("rod_1", body(), DEFAULTS, folder, stem="rod")
    assert first.nodes == ("hinge", "tip")
    assert first.positions == pytest.approx(np.array([[0.0, 0.025, 0.025], [0.35, 0.025, 0.025]]))
    (name,) = stored(folder)
    assert name.startswith("rod-")
    (folder / "rod.msh").unlink()
    again = build_part("rod_1", body(), DEFAULTS, folder, stem="rod")
    assert np.array_equal(first.stiffness, again.stiffness)
    assert again.provenance["source"] == "rod.msh"


def test_identical_limbs_share_one_element(folder):
    one = build_part("rod_1", body(), DEFAULTS, folder, stem="rod")
    other = build_part("rod_2", body(frame="rod_2"), DEFAULTS, folder, stem="rod")
    assert one is other
    assert len(stored(folder)) == 1


def test_limbs_travel_with_their_own_joint(folder):
    def board(limb: int) -> Body:
        travel = {"joint": f"slide_{limb}", "along": (1.0, 0.0, 0.0), "stations": (0.1, 0.15, 0.2, 0.25)}
        rail = {"set": "z1", "box": {"x": (-0.05, 0.05)}, "travel": travel, "coupling": "averaged"}
        return body(frame=f"board_{limb}", interfaces={"seat": {"set": "x0"}, "rail": rail})

    one, other = (build_part(f"board_{limb}", board(limb), DEFAULTS, folder, stem="board") for limb in (1, 2))
    assert isinstance(one, prs.TravellingElement)
    assert (one.joint, other.joint) == ("slide_1", "slide_2")
    assert one.elements is other.elements
    assert len(stored(folder)) == 1


def test_a_changed_part_file_is_reduced_again(folder):
    first = build_part("rod", body(), DEFAULTS, folder)
    write(box((0.35, 0.06, 0.05), (5, 1, 1)), folder / "rod.msh", scale=1000.0)
    second = build_part("rod", body(), DEFAULTS, folder)
    assert second.mass_properties().mass == pytest.approx(1.2 * first.mass_properties().mass)
    assert len(stored(folder)) == 1


def test_a_changed_companion_makes_the_part_again(tmp_path):
    """The mass is in a file of its own; the source stays as it is."""
    model = steel(box((0.35, 0.05, 0.05), (3, 1, 1)))
    mmwrite(tmp_path / "k.mtx", model.stiffness, symmetry="symmetric")
    mmwrite(tmp_path / "m.mtx", model.mass, symmetry="symmetric")
    rows = np.column_stack([np.arange(model.size) + 1, model.dofs + 1, model.coordinates[model.dofs[:, 0]]])
    np.savetxt(
        tmp_path / "k_dofs.txt", rows, "%d %d %d %.12g %.12g %.12g", header="row node component x y z", comments=""
    )
    entries = {"reducer": "matrix_market", "source": "k.mtx", "units": "m-N-kg-s", "options": {"mass": "m.mtx"}}
    part = body(**entries, interfaces={"hinge": {"box": {"x": (-0.01, 0.01)}}})
    first = build_part("rod", part, DEFAULTS, tmp_path)
    mmwrite(tmp_path / "m.mtx", 2.0 * model.mass, symmetry="symmetric")
    second = build_part("rod", part, DEFAULTS, tmp_path)
    assert second.mass_properties().mass == pytest.approx(2.0 * first.mass_properties().mass)


def test_an_installed_package_stays_as_it_is(folder, tmp_path):
    installed = tmp_path / "site-packages" / "machine"
    installed.mkdir(parents=True)
    shutil.copy(folder / "rod.msh", installed)
    build_part("rod", body(), DEFAULTS, installed)
    assert sorted(path.name for path in installed.iterdir()) == ["rod.msh"]


def test_settings_decide_which_stored_element_is_used(folder):
    """Each change of the result has its own file; what does not matter has not."""
    build_part("rod", body(), DEFAULTS, folder)
    same = (body(frame="elsewhere"), body(modes=2), body(coupling="rigid", tie="joint"))
    for each in same:
        build_part("rod", each, DEFAULTS, folder)
    assert len(stored(folder)) == 1
    lighter = {"material": STEEL | {"density": {"value": 2700.0, "source": "assumed"}}}
    different = (body(modes=4), body(coupling="averaged"), body(options=lighter), body(units="m-N-kg-s"))
    for count, each in enumerate(different, start=2):
        build_part("rod", each, DEFAULTS, folder)
        assert len(stored(folder)) == count


def test_a_joint_loaded_part_is_stored_once_for_any_number_of_modes(folder):
    """Its modes depend on the joints, and are found when the machine is loaded."""
    defaults = ReductionDefaults(store="reduced")
    elements = [build_part("rod_1", body(modes=modes), defaults, folder, stem="rod") for modes in (2, 5)]
    assert elements[0] is elements[1]
    assert len(stored(folder)) == 1


def test_what_is_missing_is_explained(folder):
    with pytest.raises(prs.PartFileError, match=r"no\.msh: there is no such file; correct 'source'"):
        build_part("rod", body(source="no.msh"), ReductionDefaults(), folder)
    build_part("rod", body(), DEFAULTS, folder)
    (folder / "rod.msh").unlink()
    with pytest.raises(prs.PartFileError, match=r"differs in modes: 5, stored 2; put the part file there"):
        build_part("rod", body(modes=5), DEFAULTS, folder)
    (folder / "rebuild.py").touch()
    other = body(reducer="npz", source="no.npz", units=None, options={})
    with pytest.raises(prs.PartFileError, match=r"no such file \(relative to the machine's folder\); correct [\w.]+$"):
        build_part("rod", other, DEFAULTS, folder)
    with pytest.raises(prs.PartFileError, match=r"make the part file with: python .*rebuild\.py"):
        build_part("rod", body(modes=5), DEFAULTS, folder)
    package = folder / "machines" / "head"
    shutil.copytree(folder / "reduced", package / "reduced")
    for file in (package / "__init__.py", package.parent / "__init__.py", package / "rebuild.py"):
        file.touch()
    with pytest.raises(prs.PartFileError, match=r"python -m machines.head.rebuild"):
        build_part("rod", body(modes=5), DEFAULTS, package)


def test_what_else_lies_in_the_store_does_not_hide_what_is_missing(folder):
    element = build_part("rod", body(), DEFAULTS, folder)
    (folder / "reduced" / "rod-old.npz").write_bytes(b"junk")
    replace(element, provenance={"recipe": "no recipe"}).save(folder / "reduced" / "rod-x.npz")
    (folder / "rod.msh").unlink()
    with pytest.raises(prs.PartFileError, match=r"'rod-\w{12}.npz' there differs in modes: 5, stored 2; put the part"):
        build_part("rod", body(modes=5), DEFAULTS, folder)


def test_a_stored_element_of_another_recipe_is_refused(folder):
    build_part("rod", body(), DEFAULTS, folder)
    (first,) = stored(folder)
    build_part("rod", body(modes=4), DEFAULTS, folder)
    (second,) = set(stored(folder)) - {first}
    shutil.copy(folder / "reduced" / first, folder / "reduced" / second)
    with pytest.raises(prs.PartFileError, match=r"another recipe than its name says \(modes: 4, stored 2\); delete it"):
        build_part("rod", body(modes=4), DEFAULTS, folder)


def test_a_stored_element_deleted_meanwhile_is_written_again(folder):
    for _ in range(3):
        build_part("rod", body(), DEFAULTS, folder)
        (name,) = stored(folder)
        (folder / "reduced" / name).unlink()


def test_a_newer_reducer_makes_its_parts_again(folder, monkeypatch):
    build_part("rod", body(), DEFAULTS, folder)
    monkeypatch.setattr(SolidReducer, "version", 2)
    build_part("rod", body(), DEFAULTS, folder)
    assert len(stored(folder)) == 2


def test_a_damaged_or_tampered_store_is_noticed(folder):
    element = build_part("rod", body(), DEFAULTS, folder)
    path = folder / "reduced" / stored(folder)[0]
    heavier = element.mass.copy()
    heavier[0, 0] *= 2.0
    replace(element, mass=heavier).save(path)
    with pytest.raises(prs.PhysicsError, match="rod: three equal translational masses"):
        build_part("rod", body(), DEFAULTS, folder)
    path.write_bytes(b"nothing")
    with pytest.raises(prs.PartFileError, match="make it again from its source"):
        build_part("rod", body(), DEFAULTS, folder)


def test_reduced_parts_take_the_names_of_interfaces(folder):
    element = prs.reduce("solid", folder / "rod.msh", interfaces=body().interfaces, **STEEL_MM)
    element.save(folder / "rod.npz")
    entries = {"reducer": "npz", "source": "rod.npz", "units": None, "options": {}}
    named = {"lower": {"node": "hinge"}, "tip": {}}
    renamed = build_part("rod", body(**entries, interfaces=named), ReductionDefaults(), folder)
    assert renamed.nodes == ("lower", "tip")
    assert renamed.labels[0] == "lower.ux"
    cases = (
        ({"lower": {"node": "hing"}}, "interfaces.lower.node: found 'hing', .*did you mean 'hinge'"),
        ({"a": {"node": "tip"}, "b": {"node": "tip"}}, "node 'tip' is interface 'a' already"),
        ({"tip": {"node": "hinge"}}, "has the name of another retained node"),
        ({"tip": {"set": "x1"}}, "found node set 'x1', and the part has none; its nodes are hinge, tip"),
    )
    for interfaces, words in cases:
        with pytest.raises(prs.PartFileError, match=words):
            build_part("rod", body(**entries, interfaces=interfaces), ReductionDefaults(), folder)
    with pytest.raises(prs.PartFileError, match="takes SI only: leave 'units' out"):
        build_part("rod", body(**entries | {"units": "m-N-kg-s"}), ReductionDefaults(), folder)


def test_reduce_takes_plain_lists_and_arrays(folder):
    interfaces = {"hinge": {"set": "x0", "at": np.array([0.0, 0.0, 0.0])}, "tip": {"box": {"x": [0.3, 0.4]}}}
    held = {"clamped": ["y0"], "grounded": True, "modes": 0}
    element = prs.reduce("solid", folder / "rod.msh", interfaces=interfaces, **held, **STEEL_MM)
    assert element.positions[0] == pytest.approx(np.zeros(3))
    assert element.size == 12
    with pytest.raises(prs.DescriptionError, match=r"interfaces.hinge.st: found an unknown key.*did you mean 'set'"):
        prs.reduce("solid", folder / "rod.msh", interfaces={"hinge": {"st": "x0"}}, material=STEEL)
    with pytest.raises(prs.UnknownNameError, match="Did you mean 'solid'"):
        prs.reduce("sold", folder / "rod.msh")


def test_interfaces_in_short_are_those_in_full(folder):
    """A word is a set, a number a node and a list several of them; NumPy's numbers are numbers."""
    in_full = prs.reduce("solid", folder / "rod.msh", interfaces={"a": {"set": "x0"}}, **STEEL_MM)
    for given in ({"a": "x0"}, {"a": np.str_("x0")}):
        in_short = prs.reduce("solid", folder / "rod.msh", interfaces=given, **STEEL_MM)
        assert np.array_equal(in_full.stiffness, in_short.stiffness)
    assert prs.reduce("solid", folder / "rod.msh", interfaces=["x0", "x1"], **STEEL_MM).nodes == ("x0", "x1")
    frame = {"nodes": {"3": (0.0, 0.0, 0.0), "11": (0.1, 0.0, 0.0), "left": (0.2, 0.0, 0.0)}, "mass": 2.0}
    tip = {"tip": np.int64(3), "root": np.array([11, 3])[:1], "end": "left"}
    assert set(prs.reduce("rigid", options=frame, interfaces=tip).nodes) == {"tip", "root", "end"}


def test_nodes_in_short(folder):
    element = prs.reduce("solid", folder / "rod.msh", interfaces={"a": "x0", "b": "x1"}, **STEEL_MM)
    element.save(folder / "rod.npz")
    assert prs.reduce("npz", folder / "rod.npz", nodes=["a", "b"]).nodes == ("a", "b")
    assert prs.reduce("npz", folder / "rod.npz", nodes={"tip": "b"}).nodes == ("a", "tip")
    cases = (
        ({"nodes": {"tip": 1.5}}, r"interfaces.tip.node: found 1.5, expected a name or a whole number"),
        ({"nodes": {"tip": "b"}, "interfaces": {"tip": "a"}}, "interface 'tip' is given twice"),
        (
            {"interfaces": {"tip": {"node": 11, "nodes": [23]}}},
            r"tip: found a selection .* and node, expected only one",
        ),
        ({"interfaces": {"tip": {"box": {"x": [4, 3]}}}}, r"tip.box.x: found the bounds in falling order"),
        ({"interfaces": {"tip": {"set": "b"}}}, r"'b', which is a node of the part; did you mean {node: b}\?"),
        ({"interfaces": {"tip": "c"}}, r"tip: found 'c', which is neither a node set \(none\) nor a node \(a, b\)"),
    )
    for given, words in cases:
        with pytest.raises(prs.PrsError, match=words):
            prs.reduce("npz", folder / "rod.npz", **given)


def test_clamped_sets_ground_the_part_by_themselves(folder):
    one = prs.reduce("solid", folder / "rod.msh", interfaces={"a": "x1"}, clamped="x0", **STEEL_MM)
    other = prs.reduce("solid", folder / "rod.msh", interfaces={"a": "x1"}, clamped=["x0"], grounded=True, **STEEL_MM)
    assert one.grounded
    assert np.array_equal(one.stiffness, other.stiffness)


def test_a_source_for_a_reducer_that_reads_none_is_refused():
    with pytest.raises(prs.PartFileError, match=r"reducer 'rigid': found the source 'a.msh', expected none"):
        prs.reduce("rigid", "a.msh", mass=1.0, nodes={"a": (0.0, 0.0, 0.0)})


def test_a_part_is_called_by_its_file(folder):
    packed = folder / "rod_v2.free.msh.gz"
    assert part_name(packed) == "rod_v2.free"


def test_parts_without_a_file_are_made_once_and_said(caplog):
    options = {"mass": 2.0, "nodes": {"a": (0.0, 0.0, 0.0), "b": (0.3, 0.0, 0.0)}}
    with caplog.at_level("INFO", "prs_model"):
        one, other = (prs.reduce("rigid", options=options) for _ in range(2))
    assert one is other
    assert caplog.text.count("rigid: 2 kg") == 1
