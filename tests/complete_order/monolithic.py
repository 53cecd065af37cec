"""The slow obvious twin: one matrix of the whole assembly, solved densely."""

import numpy as np
from scipy.linalg import block_diag, eigh, null_space

from prs_model.arrays import FloatArray
from prs_model.complete_order.inverse import Joined


def monolithic_frequencies(joined: Joined, count: int) -> FloatArray:
    """The lowest frequencies [Hz] of the joined parts' matrices, the joints' springs added where they act."""
    bodies = joined.bodies.values()
    stiffness = block_diag(*(part.model.stiffness.toarray() for part in bodies))
    mass = block_diag(*(part.model.mass.toarray() for part in bodies))
    outputs = block_diag(*(part.outputs.toarray() for part in bodies))
    independent = np.linalg.pinv(joined.expansion) @ outputs
    stiffness += independent.T @ joined.springs @ independent
    allowed = null_space(outputs - joined.expansion @ independent, rcond=1e-9)
    if allowed.shape[1] < len(stiffness):
        stiffness, mass = (allowed.T @ matrix @ allowed for matrix in (stiffness, mass))
    values = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(values) / (2.0 * np.pi))
