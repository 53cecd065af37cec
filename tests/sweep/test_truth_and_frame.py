"""The readable truth at a pose, and its twin on the matrices of a frame."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.errors import PrsError
from prs_model.linear_algebra import lowest_modes, slowest_rate
from prs_model.sweep.in_frame import carried, is_possible, quantities_in_frame, reaches
from prs_model.sweep.reasons import reason_codes, sentences
from prs_model.sweep.request import QUANTITIES, Request
from prs_model.sweep.rounding import rounding
from prs_model.sweep.truth import at_pose, check_damping
from prs_model.synthesis.batch import assemble_many
from tests.sweep.stick import stick

BAND = (400.0, 1200.0)
POSES = np.array([[0.0, 0.0, 0.09, 0.0, 0.0, 0.0], [0.002, -0.001, 0.091, 0.04, 0.01, 0.03]])


@pytest.fixture(scope="module")
def hexapod():
    return load_machine("hexapod").replace({"damping": {"modal": 0.02}})


@pytest.fixture(scope="module")
def everything():
    return Request(quantities=tuple(QUANTITIES), band=BAND)


def _in_a_turned_frame(machine, request, kept):
    """The block of POSES from the lowest `kept` modes, in a frame that is any combination of them."""
    configurations = machine.kinematics.solve_batch(POSES)
    modes = [machine.assemble(configurations[i]).modes(kept) for i in range(len(POSES))]
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(kept, kept)))[0]
    frame = np.array([np.vstack([each.body_shapes(body) for body in machine.parts]) @ turn for each in modes])
    systems = assemble_many(machine.description, machine.parts, machine.joints, configurations)
    vectors, values = np.array([turn.T] * len(POSES)), np.array([each.eigenvalues for each in modes])
    held = carried(systems, frame, request)
    return quantities_in_frame(values, vectors, held, request, machine.description.file.damping)


def _truths(machine, request):
    configurations = machine.kinematics.solve_batch(POSES)
    return [at_pose(machine, configurations[i], request) for i in range(len(POSES))]


def test_the_two_ways_agree_to_rounding_when_no_mode_is_left_out(hexapod, everything):
    found = _in_a_turned_frame(hexapod, everything, 6)
    for i, truth in enumerate(_truths(hexapod, everything)):
        for name in ("frequency", "static_compliance", "kinetic_energy", "strain_energy", "flexibility_share"):
            np.testing.assert_allclose(
                found[name][i], truth[name][0], rtol=1e-9, atol=1e-12 * np.abs(truth[name]).max()
            )
        np.testing.assert_allclose(found["frf_peak"][i], truth["frf_peak"][0], rtol=1e-6)


def test_peaks_hold_without_the_upper_modes(hexapod):
    """The band ends at 0.7 of the first mode left out."""
    low = 0.7 * hexapod.modes(6).frequencies[5]
    request = Request(n_modes=2, quantities=("frf_peak",), band=(400.0, low))
    assert reaches(request, low / 0.69)
    assert not reaches(request, low / 0.71)
    found = _in_a_turned_frame(hexapod, request, 5)
    for i, truth in enumerate(_truths(hexapod, request)):
        np.testing.assert_allclose(found["frf_peak"][i], truth["frf_peak"][0], rtol=5e-3)


def test_the_peak_is_the_largest_of_a_fine_response(hexapod):
    request = Request(quantities=("frf_peak",), band=BAND)
    truth = _truths(hexapod, request)[1]
    fine = np.linspace(*BAND, 40_001)
    pose = dict(zip(hexapod.pose_names, POSES[1], strict=True))
    curves = np.abs(hexapod.modes(6, **pose).frf(fine))[:, range(3), range(3)]
    np.testing.assert_allclose(truth["frf_peak"][0], curves.max(axis=0), rtol=1e-5)
    np.testing.assert_allclose(truth["frf_peak_frequency"][0], fine[curves.argmax(axis=0)], atol=0.1)


def test_what_cannot_be_asked_is_told(hexapod):
    configuration = hexapod.configuration()
    with pytest.raises(PrsError, match="n_modes: found 7, expected at most 6"):
        at_pose(hexapod, configuration, Request(n_modes=7))
    with pytest.raises(PrsError, match="has no damping, without which peaks are infinite"):
        check_damping(load_machine("hexapod"), Request(quantities="frf_peak", band=BAND))
    joints = hexapod.replace({"damping": {"joints": {"P": {"viscous": 1e-5}}}})
    damping = joints.description.file.damping
    assert not is_possible(Request(quantities="frf_peak", band=BAND), damping)
    assert is_possible(Request(), damping)


def test_reasons_name_the_joint_and_the_side(hexapod):
    reach = hexapod.kinematics.reach
    tree = reach.tree
    limited = int(np.flatnonzero(np.isfinite(tree.upper) & np.isfinite(tree.lower))[0])
    q = np.tile(hexapod.configuration().q, (4, 1))
    q[1, limited], q[2, limited], q[3] = tree.upper[limited] + 1.0, tree.lower[limited] - 1.0, np.nan
    codes = reason_codes(reach, q)
    words = sentences(reach, codes)
    assert words[codes[0]] == "reachable"
    assert f"{tree.names[limited]} above its upper limit" in words[codes[1]]
    assert f"{tree.names[limited]} below its lower limit" in words[codes[2]]
    assert words[codes[3]] == "no configuration closes the loops"


def test_peaks_under_damping_of_joints_are_those_of_every_pose_in_full():
    """Joints that damp couple modes: there the sweep is the library's own response, pose by pose."""
    damping = {"modal": [0.02], "joints": {"P": {"loss_factor": 0.2}}}
    machine = load_machine("hexapod").replace({"damping": damping})
    quantities = ("frf_peak", "static_compliance", "identity")
    data = machine.sweep(x=[-0.001, 0.002, 0.5], n_modes=2, quantities=quantities, band=BAND)
    assert data["proof"].values.tolist() == [2, 2, 0]
    assert np.isnan(data["frf_peak"][2]).all()
    assert data["identity"].values.tolist()[2] == [0, 0]
    fine = np.linspace(*BAND, 8001)
    modes = machine.modes(6, x=0.002)
    curves = np.abs(modes.frf(fine))[:, range(3), range(3)]
    np.testing.assert_allclose(data["frf_peak"][1], curves.max(axis=0), rtol=1e-4)
    np.testing.assert_allclose(data["static_compliance"][1], modes.static_compliance(), rtol=1e-9, atol=1e-15)
    alone = np.abs(modes.frf(fine, 0.02))[:, range(3), range(3)].max(axis=0)
    assert (alone > 1.1 * curves.max(axis=0)).all()


@pytest.mark.parametrize("stiff", [1e2, 1e4, 1e7])
def test_the_estimate_of_rounding_grows_with_what_is_lost(stiff):
    """Two masses on a soft spring, a stiff one between them: in closed form, in more digits than the solver has."""
    mass, stiffness = np.diag([1.0, 2.0]), np.array([[1.0 + stiff, -stiff], [-stiff, stiff]])
    k, whole = np.longdouble(stiff), np.longdouble(stiffness[0, 0])
    b, c = 2 * whole + k, 2 * k * (whole - k)  # 2 lambda^2 - b lambda + .. with determinant c / 2
    root = (b + np.sqrt(b**2 - 4 * c)) / 4
    exact = np.array([c / (4 * root), root])
    values, shapes = lowest_modes(mass, stiffness, 2)
    rate = np.array(slowest_rate(mass, stiffness))
    bound = rounding(values, shapes, np.diag(mass), np.diag(stiffness), rate)
    errors = np.abs(np.sqrt(values / exact.astype(float)) - 1.0)
    assert (errors <= bound).all()
    assert 1e-16 * stiff < bound[0] < 1e-14 * stiff


def test_a_mode_that_is_free_has_no_relative_error(tmp_path):
    free = stick(tmp_path, held=False)
    block = at_pose(free, free.configuration(), Request(n_modes=8))
    assert np.isnan(block["bound"][0, :6]).all()
    assert (block["bound"][0, 6:] < 1e-9).all()
    np.testing.assert_allclose(free.sweep(n_modes=8)["bound"][6:], block["bound"][0, 6:], rtol=100.0)


def test_of_joints_as_far_beyond_their_limits_the_first_is_named(hexapod):
    """Whatever rounding does to struts that are alike."""
    reach = hexapod.kinematics.reach
    struts = [j for j, name in enumerate(reach.tree.names) if name.startswith("strut")]
    q = np.tile(hexapod.configuration().q, (20, 1))
    q[:, struts] = (
        reach.tree.upper[struts] + 0.01 + np.random.default_rng(5).normal(scale=1e-10, size=(20, len(struts)))
    )
    q[19, struts[2]] += 0.001
    codes = reason_codes(reach, q)
    assert set(codes[:19]) == {3 + 2 * struts[0]}
    assert codes[19] == 3 + 2 * struts[2]
    told = [reach.beyond_limits(np.zeros(6), each).joint for each in q]
    assert told == [reach.tree.names[struts[0]]] * 19 + [reach.tree.names[struts[2]]]
