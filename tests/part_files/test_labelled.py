"""What labelled matrices and node tables refuse, before anything is made of them."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.part_files import LabelledMatrices, NodeTable
from prs_model.part_files.text import whole_number

SOURCE = Path("part.xyz")


@pytest.mark.parametrize(
    "frame", [1.1 * np.eye(3), np.diag([1.0, 1.0, -1.0]), np.full((3, 3), np.nan)], ids=["scaled", "mirrored", "nan"]
)
def test_axes_that_are_no_frame(frame: np.ndarray) -> None:
    frames = np.array([np.eye(3), frame])
    with pytest.raises(prs.PartFileError, match=r"part\.xyz: the axes of node 12 are not right-handed"):
        NodeTable(SOURCE, np.array([11, 12]), np.zeros((2, 3)), frames)


def test_frames_of_another_shape() -> None:
    with pytest.raises(prs.PartFileError, match=r"frames are \(1, 3, 3\), expected \(2, 3, 3\)"):
        NodeTable(SOURCE, np.array([11, 12]), np.zeros((2, 3)), np.eye(3)[np.newaxis])


def test_components_must_be_integers() -> None:
    with pytest.raises(prs.PartFileError, match=r"a row's component is none of ux\.\.rz"):
        LabelledMatrices(SOURCE, np.eye(2), np.eye(2), np.array([1, 1]), np.array([0.0, 1.5]))


@pytest.mark.parametrize("text", ["1" * 5000, "-1", "1.0", "\u00b2", ""])
def test_no_whole_numbers(text: str) -> None:
    with pytest.raises(ValueError, match="expected a whole number"):
        whole_number(text)
