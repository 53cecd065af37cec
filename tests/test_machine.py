"""The public names, and what a machine takes for a pose."""

import pytest

import prs_model as prs


def test_every_public_name_is_there() -> None:
    assert all(getattr(prs, name) is not None for name in prs.__all__)
    with pytest.raises(AttributeError, match="no attribute 'Machin'"):
        prs.Machin  # noqa: B018


def test_poses_that_are_none() -> None:
    machine = prs.load_machine("hexapod")
    for value in ("a", [1, 2], None):
        with pytest.raises(prs.PrsError, match="for x, expected one number"):
            machine.configuration(x=value)
    with pytest.raises(prs.UnknownNameError, match="unknown pose coordinate 'count'"):
        machine.modes(count=3)
    assert len(machine.modes(3).frequencies) == 3


def test_the_workspace_is_in_si() -> None:
    bounds = prs.load_machine("head_3prs").workspace
    assert bounds["z"] == pytest.approx((1.175, 1.375))
    assert bounds["nutation"] == pytest.approx((0.0, 0.5235987756))
