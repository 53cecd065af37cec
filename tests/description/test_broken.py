"""Broken descriptions, each the small machine with one edit: one clear problem, with its file, line and entry."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from prs_model.cli import main
from prs_model.description import load_description
from prs_model.errors import DescriptionError

SMALL_MACHINE = Path(__file__).parent / "small_machine"
YAML, URDF = "machine.yaml", "gantry.urdf"


@dataclass(frozen=True)
class Broken:
    """`old` becomes `new` in `file`; the problem is told in `told_in`, on the line of `at`, at `entry`, in `words`."""

    name: str
    file: str
    old: str
    new: str
    entry: str
    words: tuple[str, ...]
    at: str = ""  # default: the line where the edit begins
    told_in: str = ""  # default: the same file


def yaml(name: str, old: str, new: str, entry: str, *words: str, at: str = "") -> Broken:
    return Broken(name, YAML, old, new, entry, words, at)


def urdf(name: str, old: str, new: str, entry: str, *words: str, at: str = "") -> Broken:
    return Broken(name, URDF, old, new, entry, words, at)


RAM = "      nodes: {slide: [0, 0, 100], tool: [0, 0, 0]}\n    interfaces: {slide: {}, tool: {}}"
Y_LIMIT = '<limit lower="-0.4" upper="0.4" effort="0" velocity="0"/>'
SOLID_BRIDGE = """    reducer: solid
    source: machine.yaml
    options: {material: {E: 2.1e5, nu: 0.3, density: 7.85e-6}}
"""

BRIDGE = """    reducer: rigid
    options:
      mass: 80
      inertia: {xx: 9.0e6, yy: 1.0e6, zz: 9.0e6}
      nodes: {seat_left: [0, -500, 0], seat_right: [0, 500, 0], beam: [0, 0, 0]}
"""
FOOT_INERTIA = '<inertia ixx="0.4" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.2"/>'
MATRIX_ROWS = ["[1e5,0,0,0,0,0]", "[0,0,0,0,0,0]", "[0,0,1e5,0,0,0]", "[0,0,0,1e9,0,0]", "[0,0,0,0,1e9,0]"]
Y_STIFFNESS = "{ux: {value: 8.0e5, source: catalogue, note: two carriages}, uz: 8.0e5, rx: 1.0e9, ry: 1.0e9, rz: 1.0e9}"


def matrix(*rows: str) -> str:
    return f"[{', '.join(rows)}]"


def interface(text: str) -> tuple[str, str]:
    """The edit that gives the ram's slide other contents."""
    return RAM, RAM.replace("slide: {}", f"slide: {text}")


SYNTAX = [
    yaml("tab", "    options:\n      mass: 900", "\toptions:\n      mass: 900", "", "tabs"),
    yaml("unclosed", "[-300, 300]", "[-300, 300", "", "not valid YAML"),
    yaml("duplicate key", "      mass: 80\n", "      mass: 80\n      mass: 81\n", "bodies.bridge.options.mass",
         "'mass' a second time", "first on line"),
    yaml("tag", "name: gantry", "name: !!python/name:os.system x", "name", "tag"),
    yaml("anchor", "*carriage", "*carrriage", "", "undefined alias 'carrriage'"),
]  # fmt: skip

SHAPE = [
    yaml("unknown unit", "length: mm", "length: mmm", "units.length", "found 'mmm'", "did you mean 'mm'"),
    yaml("unknown quantity of units", "force: N", "forse: N", "units.forse", "did you mean 'force'"),
    yaml("unknown key", "nut: 5.0e5", "nutt: 5.0e5", "joints.X.drive.nutt", "did you mean 'nut'"),
    yaml("unknown section", "closures:", "closure:", "closure", "did you mean 'closures'"),
    yaml("unknown option", "mass: 900", "masss: 900", "bodies.bed.options.masss", "did you mean 'mass'"),
    yaml("missing option", "      mass: 900\n", "", "bodies.bed.options.mass", "add 'mass'", at="    options:"),
    yaml("missing entry", "    frame: bed\n", "", "bodies.bed.frame", "found nothing", "add 'frame'", at="  bed:"),
    yaml("nan", "mass: 900", "mass: .nan", "bodies.bed.options.mass", "found nan", "(kg)"),
    yaml("words for a number", "mass: 900", "mass: heavy", "bodies.bed.options.mass", "found 'heavy'", "(kg)"),
    yaml("unit beside a number", "nut: 5.0e5", "nut: 500 N/um", "joints.X.drive.nut", "expected a number (N/mm)"),
    yaml("negative stiffness", "uz: 6.0e5", "uz: -6.0e5", "joints.X.interfaces[0].stiffness.uz",
         "zero or more (N/mm)"),
    yaml("two numbers for a point", "at: [100, 0, 0]", "at: [100, 0]", "joints.X.interfaces[0].at",
         "found 2 entries, expected 3"),
    yaml("unknown source", "source: measured", "source: guessed", "bodies.ram.options.mass", "'guessed'", "assumed"),
    yaml("number for text", "name: gantry", "name: 5", "name", "found 5, expected text", "quotes"),
    yaml("yes for true", "rigid: true", "rigid: yes", "joints.seat.rigid", "expected true or false"),
    yaml("damping in percent", "modal: 0.02", "modal: 2.5", "damping.modal", "found 2.5", "below 1, such as 0.025"),
    yaml("name of nothing", "name: gantry", "name: ''", "name", "found the name ''", "letters, digits"),
    yaml("name that cannot be seen", "name: gantry", r'name: "gan\ntry\0"', "name", r"'gan\ntry\x00'"),
    yaml("unknown drive", "kind: ball_screw", "kind: ballscrew", "joints.X.drive", "did you mean 'ball_screw'"),
]  # fmt: skip

NAMES = [
    yaml("unknown reducer", "bed\n    reducer: rigid", "bed\n    reducer: rigit", "bodies.bed.reducer",
         "did you mean 'rigid'"),
    yaml("unknown task", "kind: xyz", "kind: xzy", "task.kind", "did you mean 'xyz'"),
    yaml("tool frame", "  frame: ram\n  workspace", "  frame: rams\n  workspace", "task.frame",
         "did you mean 'ram'"),
    yaml("body frame", "frame: foot_<foot>", "frame: foott_<foot>", "bodies.foot.frame", "'foott_left'",
         "did you mean 'foot_left'"),
    yaml("body of a joint", "ram.slide]", "rum.slide]", "joints.ram.between[1]", "did you mean 'ram'"),
    yaml("interface of a joint", "ram.slide]", "ram.slid]", "joints.ram.between[1]", "did you mean 'slide'"),
    yaml("end without interface", "ram.slide]", "ram]", "joints.ram.between[1]", "'body.interface' or 'ground'"),
    yaml("closure", "bridge_at_right,", "bridge_at,", "closures.bridge.between[0]", "a link of the URDF"),
    yaml("URDF joint", "urdf: y", "urdf: w", "joints.ram.stages[0].urdf", "a joint of the URDF"),
    yaml("output", "node: ram.tool", "node: ram.tol", "output.node", "did you mean 'tool'"),
    yaml("output frame", "tool, frame: ram", "tool, frame: tool", "output.frame", "a link of the URDF"),
    yaml("URDF file", "urdf: gantry.urdf", "urdf: gantri.urdf", "urdf", "found 'gantri.urdf'"),
    yaml("symmetry group", "    per: foot\n    urdf", "    per: foots\n    urdf", "joints.X.per",
         "did you mean 'foot'"),
    yaml("placeholder", "x_<foot>\n    between", "x_<leg>\n    between", "joints.X.urdf", "placeholder <leg>"),
    yaml("placeholder without per", "ram.slide]", "ram.slide_<foot>]", "joints.ram.between[1]", "add 'per: foot'"),
    yaml("two of a name", "  ram:\n    between", "  X_left:\n    between", "joints.X_left", "rename"),
]  # fmt: skip

TASK = [
    yaml("pose coordinate", "pose: {x: 400, y: 0, z: 600}", "pose: {x: 400, y: 0, u: 600}", "task.reference.pose.u",
         "a pose coordinate (x, y, z)"),
    yaml("workspace falling", "[400, 700]", "[700, 400]", "task.workspace.z", "expected [low, high]"),
    yaml("outside the workspace", "z: 600}", "z: 900}", "task.reference.pose.z", "400 .. 700 mm"),
    yaml("joint beyond its limit", "z: -100", "z: 100", "task.reference.joints.z", "found 100 mm", "-300 .. 0 mm",
         "gantry.urdf:"),
    yaml("joint left out", "      y: 0\n", "", "task.reference.joints", "no value for y", at="joints:"),
    yaml("fixed joint given", "      y: 0\n", "      y: 0\n      seat_left: 0\n", "task.reference.joints.seat_left",
         "that moves"),
    yaml("two dampings", "modal: 0.02", "modal: 0.02, rayleigh: {alpha: 1, beta: 0}", "damping", "keep one"),
]  # fmt: skip

LAWS = [
    yaml("stiffness and compliance", "      - urdf: z\n", "      - urdf: z\n        rigid: true\n",
         "joints.ram.stages[1]", "found rigid and compliance", at="- urdf: z"),
    yaml("no law", "    rigid: true\n", "", "joints.seat", "none of them", "rigid, stiffness, compliance",
         at="  seat:"),
    yaml("stiffness on the free axis", "{ux: {value", "{uy: 1.0e5, ux: {value", "joints.ram.stages[0].stiffness.uy",
         "'y' is free along uy", "'drive'"),
    yaml("constrained axis missing", "uz: 8.0e5, ", "", "joints.ram.stages[0].stiffness.uz",
         "give a number or 'rigid'"),
    yaml("compliance missing", "rx: 0, ", "", "joints.ram.stages[1].compliance.rx", "0 for rigid"),
    yaml("matrix not symmetric", Y_STIFFNESS, matrix(*MATRIX_ROWS, "[0,0,7e5,0,0,1e9]"),
         "joints.ram.stages[0].stiffness", "[2][5] and [5][2]"),
    yaml("matrix of five rows", Y_STIFFNESS, matrix(*MATRIX_ROWS), "joints.ram.stages[0].stiffness",
         "found 5 entries, expected 6"),
    yaml("matrix not positive", Y_STIFFNESS, matrix(*MATRIX_ROWS, "[0,0,0,0,0,-1e9]"),
         "joints.ram.stages[0].stiffness", "negative eigenvalue"),
    yaml("matrix holds the free axis", Y_STIFFNESS,
         matrix(MATRIX_ROWS[0], "[0,1e5,0,0,0,0]", *MATRIX_ROWS[2:], "[0,0,0,0,0,1e9]"),
         "joints.ram.stages[0].stiffness", "row 1 (uy)"),
    yaml("drive without a joint", "    rigid: true\n",
         "    rigid: true\n    drive: {kind: constant, stiffness: 1}\n", "joints.seat.drive",
         "only on a URDF joint that moves"),
    yaml("drive of the wrong kind", "rz: 1.0e9}\n        drive: {kind: constant, stiffness",
         "rz: 1.0e9}\n        drive: {kind: constant, rotational_stiffness",
         "joints.ram.stages[0].drive.rotational_stiffness", "expected stiffness", "prismatic"),
    yaml("screw too short", "length: 1000", "length: 600", "joints.X.drive", "-0.05 .. 0.55 m"),
    yaml("two interfaces of a name", "name: back", "name: front", "joints.X.interfaces[1].name", "a second time"),
]  # fmt: skip

PARTS = [
    yaml("no source", BRIDGE, "    reducer: npz\n", "bodies.bridge.source", "add 'source'",
         at="  bridge:\n    frame"),
    yaml("source not needed", "frame: bed\n    reducer", "frame: bed\n    source: a.msh\n    reducer",
         "bodies.bed.source", "reads no file"),
    yaml("source not there", BRIDGE, "    reducer: npz\n    source: bridge.npz\n", "bodies.bridge.source",
         "expected a file in", at="bridge.npz"),
    yaml("option of a reducer without options", BRIDGE,
         "    reducer: npz\n    source: machine.yaml\n    options: {mass: 80}\n", "bodies.bridge.options.mass",
         "an unknown key, expected no entries", at="    options: {mass: 80}"),
    yaml("inconsistent units", BRIDGE, SOLID_BRIDGE + "    units: mm\n",
         "bodies.bridge.units", "length-force-mass-time", at="    units: mm"),
    yaml("no units", BRIDGE, SOLID_BRIDGE, "bodies.bridge.units", "the file does not say its units",
         at="  bridge:\n    frame: bridge"),
    yaml("units of a file in SI", BRIDGE, "    reducer: npz\n    source: machine.yaml\n    units: m-N-kg-s\n",
         "bodies.bridge.units", "are in SI: remove 'units'", at="    units: m-N-kg-s"),
    yaml("normal of no plane", *interface("{plane: {point: [0, 0, 0], normal: [0, 0, 0], tolerance: 1}}"),
         "bodies.ram.interfaces.slide.plane.normal", "expected a direction"),
    yaml("units of no file", "frame: bed\n    reducer", "frame: bed\n    units: mm\n    reducer", "bodies.bed.units",
         "found units, expected none"),
    yaml("modes of a rigid body", "frame: bed\n    reducer", "frame: bed\n    modes: 5\n    reducer",
         "bodies.bed.modes", "found modes, expected none"),
    yaml("inertia of no body", "zz: 2.0e5", "zz: 9.0e5", "bodies.foot.options.inertia", "principal moments"),
    yaml("clamped but free", "  ram:\n    frame", "  ram:\n    clamped: [foot]\n    frame", "bodies.ram.clamped",
         "add 'grounded: true'"),
    yaml("node and set", *interface("{set: a, node: b}"), "bodies.ram.interfaces.slide", "only one of them"),
    yaml("two members of a name", *interface("{members: [{name: a, set: a}, {name: a, set: b}]}"),
         "bodies.ram.interfaces.slide.members[1].name", "a second time"),
    yaml("member without nodes", *interface("{members: [{name: a}]}"), "bodies.ram.interfaces.slide.members[0]",
         "set, nodes, box, cylinder"),
    yaml("box inside out", *interface("{box: {x: [3, 1]}}"), "bodies.ram.interfaces.slide.box.x", "[low, high]"),
    yaml("travel with no joint",
         *interface("{travel: {joint: q, along: [0, 0, 1], stations: [-300, -200, -100, 0]}}"),
         "bodies.ram.interfaces.slide.travel.joint", "a joint of the URDF"),
    yaml("stations out of order",
         *interface("{travel: {joint: z, along: [0, 0, 1], stations: [-300, -100, -200, 0]}}"),
         "bodies.ram.interfaces.slide.travel.stations", "rising"),
    yaml("three stations", *interface("{travel: {joint: z, along: [0, 0, 1], stations: [-300, -100, 0]}}"),
         "bodies.ram.interfaces.slide.travel.stations", "found 3 entries, expected at least 4"),
    yaml("interface no member knows", "{below: {}",
         "{below: {members: [{name: front, set: a}, {name: rear, set: b}]}", "joints.X.interfaces[1].name",
         "found 'back'", "a member of foot_left.below", at="at: [-100"),
]  # fmt: skip

TREE = [
    urdf("not XML", '<link name="ram"/>', '<link name="ram">', "", "not valid XML", at="</robot>"),
    urdf("entity", '<?xml version="1.0"?>', '<?xml version="1.0"?>\n<!DOCTYPE a [<!ENTITY b "c">]>', "",
         "remove it"),
    urdf("no name", '<link name="saddle"/>', '<link name="saddle"/><link/>', "<link>", 'add name="..."'),
    urdf("two links of a name", '<link name="bridge_seat_left"/>', '<link name="bridge_seat_left"/><link name="ram"/>',
         "link 'ram'", "second time", "first on line"),
    urdf("unknown link", '<parent link="saddle"/>', '<parent link="sadle"/>', "joint 'z': parent",
         "did you mean 'saddle'"),
    urdf("two parents", '<child link="bridge_at_right"/>', '<child link="bridge"/>', "joint 'bridge_right'",
         "already is the child of joint 'bridge_left'", "add a closure", at='<joint name="bridge_right"'),
    urdf("two roots", '<link name="saddle"/>', '<link name="saddle"/><link name="table"/>', "<robot>", "bed, table",
         at="<robot"),
    urdf("unknown joint type", 'name="y" type="prismatic"', 'name="y" type="slider"', "joint 'y'", "'slider'"),
    urdf("floating joint", 'name="y" type="prismatic"', 'name="y" type="floating"', "joint 'y'", "three revolute"),
    urdf("zero axis", 'axis xyz="0 1 0"', 'axis xyz="0 0 0"', "joint 'y': axis", "zero axis"),
    urdf("no axis", '    <axis xyz="0 1 0"/>\n', "", "joint 'y'", "no <axis>", at='name="y"'),
    urdf("axis of two numbers", 'axis xyz="0 1 0"', 'axis xyz="0 1"', "joint 'y': axis: xyz",
         "three finite numbers"),
    urdf("no limit", f"    {Y_LIMIT}\n", "", "joint 'y'", "no <limit>", at='name="y"'),
    urdf("limits falling", 'lower="-0.4" upper="0.4"', 'lower="0.4" upper="-0.4"', "joint 'y': limit",
         "lower below upper"),
    urdf("negative mass", '<mass value="80"/>', '<mass value="-80"/>', "link 'bridge': mass", "above zero (kg)"),
    urdf("mass in words", '<mass value="80"/>', '<mass value="eighty"/>', "link 'bridge': mass", 'value="eighty"'),
    urdf("mass not a number", '<mass value="80"/>', '<mass value="nan"/>', "link 'bridge': mass", "finite"),
    urdf("mass as Python writes it", '<mass value="80"/>', '<mass value="8_0"/>', "link 'bridge': mass", "finite"),
    urdf("origin as Python writes it", 'xyz="0 0.5 0.7"', 'xyz="0 0.5 0_0.7"', "joint 'bridge_left': origin: xyz",
         "three finite numbers"),
    urdf("spaces around a name", 'name="y" type', 'name=" y" type', "joint ' y'", "remove them"),
    urdf("inertia of no body", FOOT_INERTIA, FOOT_INERTIA.replace('izz="0.2"', 'izz="0.9"'),
         "link 'foot_left': inertia", "sum of the other two"),
    urdf("inertia not positive", FOOT_INERTIA, FOOT_INERTIA.replace('ixy="0"', 'ixy="0.5"'),
         "link 'foot_left': inertia", "above zero"),
    urdf("millimetres", 'foot_left"/>\n    <origin xyz="0 -0.5 0"/>', 'foot_left"/>\n    <origin xyz="0 -500 0"/>',
         "joint 'x_left': origin: xyz", "looks like millimetres"),
    Broken("oblique axis", URDF, 'axis xyz="0 1 0"', 'axis xyz="0 1 1"', "joints.ram.stages[0].urdf",
           ("axis 0 0.7071 0.7071", "gantry.urdf:", "coordinate axis"), at="urdf: y", told_in=YAML),
]  # fmt: skip

ALL = [*SYNTAX, *SHAPE, *NAMES, *TASK, *LAWS, *PARTS, *TREE]


def edited_copy(folder: Path, *edits: Broken) -> Path:
    shutil.copytree(SMALL_MACHINE, folder, dirs_exist_ok=True)
    for edit in edits:
        path = folder / edit.file
        text = path.read_text()
        assert edit.old in text
        path.write_text(text.replace(edit.old, edit.new, 1))
    return folder


def line_in(folder: Path, case: Broken) -> int:
    """The line where the problem is to be told."""
    file = case.told_in or case.file
    text = (folder / file).read_text()
    return text.count("\n", 0, text.index(case.at) if case.at else first_difference(text, file)) + 1


def first_difference(text: str, file: str) -> int:
    pairs = zip(text, (SMALL_MACHINE / file).read_text(), strict=False)
    return next(index for index, (new, old) in enumerate(pairs) if new != old)


@pytest.mark.parametrize("case", ALL, ids=lambda case: case.name)
def test_one_clear_problem(case: Broken, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = edited_copy(tmp_path, case)

    with pytest.raises(DescriptionError) as caught:
        load_description(folder)

    assert len(caught.value.problems) == 1, str(caught.value)
    problem = caught.value.problems[0]
    assert (problem.file, problem.entry) == (case.told_in or case.file, case.entry)
    assert problem.line == line_in(folder, case)
    for words in case.words:
        assert words in problem.message

    assert main(["validate", str(folder)]) == 1
    assert capsys.readouterr().err == f"prs-model: {problem}\n"


def test_everything_wrong_is_told_at_once_in_file_order(tmp_path: Path) -> None:
    named = {case.name: case for case in ALL}
    wrong = [
        "unknown option",
        "tool frame",
        "workspace falling",
        "output",
        "constrained axis missing",
        "screw too short",
    ]
    cases = [named[name] for name in wrong]
    folder = edited_copy(tmp_path, *cases)

    with pytest.raises(DescriptionError) as caught:
        load_description(folder)

    problems = caught.value.problems
    assert {problem.entry for problem in problems} == {case.entry for case in cases}
    assert [problem.line for problem in problems] == sorted(problem.line or 0 for problem in problems)


def test_both_files_are_told_about_at_once(tmp_path: Path) -> None:
    named = {case.name: case for case in ALL}
    cases = [named[name] for name in ("unknown option", "workspace falling", "zero axis", "negative mass")]
    folder = edited_copy(tmp_path, *cases)

    with pytest.raises(DescriptionError) as caught:
        load_description(folder)

    assert [(p.file, p.entry) for p in caught.value.problems] == [
        (YAML, "task.workspace.z"),
        (YAML, "bodies.bed.options.masss"),
        (URDF, "link 'bridge': mass"),
        (URDF, "joint 'y': axis"),
    ]


def test_a_folder_in_place_of_the_file_is_named(tmp_path: Path) -> None:
    (tmp_path / YAML).mkdir()
    for path in (tmp_path, tmp_path / YAML):
        with pytest.raises(DescriptionError, match=r"machine\.yaml: is a folder, expected a file"):
            load_description(path)


def test_a_folder_without_a_machine_is_named(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError, match=r"expected a machine\.yaml or the folder of one"):
        load_description(tmp_path)
