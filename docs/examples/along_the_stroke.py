"""How the first three frequencies of the head change along its stroke, and what a softer drive does to them."""

import numpy as np

import prs_model as prs

machine = prs.load_machine("head_3prs")
softer = machine.replace({"joints.P.drive.nut": 1.0e5})  # N/mm, the unit of the machine's file

print("  z / mm    f1 .. f3 / Hz              with a softer nut")
for z in np.linspace(1.175, 1.375, 5):
    as_is, changed = (m.modes(3, z=z).frequencies for m in (machine, softer))
    print(f"{1e3 * z:8.0f}  " + "".join(f"{f:9.3f}" for f in as_is) + "  " + "".join(f"{f:9.3f}" for f in changed))
