from __future__ import annotations

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.kinematics import Kinematics


@pytest.fixture(scope="session")
def head() -> Kinematics:
    return load_machine("head_3prs").kinematics


@pytest.fixture(scope="session")
def hexapod() -> Kinematics:
    return load_machine("hexapod").kinematics


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20)
