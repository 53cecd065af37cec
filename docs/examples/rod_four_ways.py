"""The rod of head_3prs four ways: solid, a Nastran export of the solid, beams, and lumped masses on springs."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import prs_model as prs

E, NU, DENSITY = 2.1e5, 0.3, 7.85e-6  # N/mm^2, kg/mm^3: the units of the machine's file
STEEL = {"E": E, "nu": NU, "density": DENSITY}
G, KAPPA = E / 2.6, 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU)

# the drawing: machines/prs_machines/head_3prs/parts.py, in mm; z runs from the R joint to the S joint
NECK, SHOULDER, WIDE, BALL, TIP = (40.0, 86.0), 44.0, 100.0, 26.0, 350.0
END = TIP - BALL  # the ball's surface is held, so nothing bends inside it


def sides(z):
    """Sides of the rod's section along x and y: the neck, then a flat bar that widens up to z = 100, then tapers.

    The neck goes on to z = 60, but bears little of a bar less than half as thick: that piece is a mass only.
    """
    bar = np.interp(z, (44.0, WIDE, 338.0), (16.8, 16.4, 14.8)), np.interp(z, (44.0, WIDE, 338.0), (86.0, 140.0, 50.0))
    return NECK if z < SHOULDER else (float(bar[0]), float(bar[1]))


def box(x, y, length, z):
    """Mass, place on the axis and principal inertia of a block."""
    mass = DENSITY * x * y * length
    return mass, z, mass / 12.0 * np.array([y**2 + length**2, x**2 + length**2, x**2 + y**2])


def ring(outer, inner, length, y):
    """Mass, place and inertia about the rod's hinge of a ring about the y axis, y from the origin."""
    mass = DENSITY * np.pi * (outer**2 - inner**2) * length
    across = mass / 12.0 * (3.0 * (outer**2 + inner**2) + length**2) + mass * y**2
    return mass, 0.0, np.array([across, mass / 2.0 * (outer**2 + inner**2), across])


def ball():
    mass = DENSITY * 4.0 / 3.0 * np.pi * BALL**3
    return mass, TIP, np.full(3, 0.4 * mass * BALL**2)


def hub(*more):
    """The hub with its two journals, bored through, and more that is rigid with it."""
    return [ring(34.0, 12.0, 86.0, 0.0), ring(24.0, 12.0, 32.0, 59.0), ring(24.0, 12.0, 32.0, -59.0), *more]


def together(blocks):
    """Blocks on the axis as one mass of the reducers `beam` and `lumped`."""
    mass = sum(m for m, _, _ in blocks)
    centre = sum(m * z for m, z, _ in blocks) / mass
    inertia = sum(own + m * (z - centre) ** 2 * np.array([1.0, 1.0, 0.0]) for m, z, own in blocks)
    return {
        "mass": mass,
        "centre": [0.0, 0.0, centre],
        "inertia": dict(zip(("xx", "yy", "zz"), inertia.tolist(), strict=True)),
    }


def inside_hub():
    """The part of the neck inside the hub, to be taken off."""
    mass, z, inertia = box(*NECK, 34.0, 17.0)
    return -mass, z, -inertia


def collar():
    """The neck round the bar, from z = 44 to 60, but for the bar inside it."""
    x, y = sides(52.0)
    return box(NECK[0] - x, min(NECK[1], y), 16.0, 52.0)


def beam_rod():
    """Neck and tapered bar as beams; the hub and the ball are masses, the ball's radius is rigid."""

    def rectangle(z):
        return {"kind": "rectangle", "y": sides(z)[0], "z": sides(z)[1], "material": STEEL}

    options = {
        "nodes": {"hinge": [0, 0, 0], "shoulder": [0, 0, SHOULDER], "wide": [0, 0, WIDE], "tip": [0, 0, TIP]},
        "sections": {
            "neck": rectangle(0.0),
            "low": rectangle(SHOULDER),
            "wide": rectangle(WIDE),
            "thin": rectangle(END),
        },
        "members": [
            {"between": ["hinge", "shoulder"], "section": "neck", "up": [0, 1, 0]},
            {"between": ["shoulder", "wide"], "section": "low", "taper_to": "wide", "up": [0, 1, 0], "elements": 4},
            {
                "between": ["wide", "tip"],
                "section": "wide",
                "taper_to": "thin",
                "up": [0, 1, 0],
                "offsets": [[0, 0, 0], [0, 0, -BALL]],
                "elements": 16,
            },
        ],
        "masses": {"hinge": together(hub(inside_hub(), collar())), "tip": together([ball()])},
    }
    return rod(reducer="beam", options=options, interfaces={"hinge": {"node": "hinge"}, "tip": {"node": "tip"}})


def lumped_rod(pieces=15):
    """Slices of the rod on the ends of equal pieces; between two, a spring with a piece's stiffness at its middle.

    There a spring needs no terms off the diagonal: EI/h against bending, GJ/h against torsion, EA/h along the axis and
    1 / (h^3/12EI + h/kGA) across it make it as stiff as the beam, exactly where the section is constant.
    """
    h = END / pieces
    names = ["hinge", *(f"slice_{i}" for i in range(1, pieces)), "tip"]
    places = [*(h * i for i in range(pieces)), TIP]
    slices = [[box(*sides(h * i), h, h * i)] for i in range(1, pieces)]
    first, last = box(*sides(h / 4.0), h / 2.0, h / 4.0), box(*sides(END - h / 4.0), h / 2.0, END - h / 4.0)
    blocks = [hub(inside_hub(), first), *slices, [last, ball()]]
    springs = [
        {"between": [names[i], names[i + 1]], "at": [0, 0, h * (i + 0.5)], "stiffness": piece(*sides(h * (i + 0.5)), h)}
        for i in range(pieces)
    ]
    options = {
        "nodes": {name: [0, 0, z] for name, z in zip(names, places, strict=True)},
        "masses": {name: together(each) for name, each in zip(names, blocks, strict=True)},
        "springs": springs,
    }
    return rod(reducer="lumped", options=options, interfaces={"hinge": {}, "tip": {}})


def piece(x, y, h):
    """Stiffness of a piece h long between its ends, at its middle; torsion of a flat section as x^3 y / 3."""
    area, about_x, about_y = x * y, x * y**3 / 12.0, x**3 * y / 12.0
    shear = h / (KAPPA * G * area)
    return {
        "ux": 1.0 / (h**3 / (12.0 * E * about_y) + shear),
        "uy": 1.0 / (h**3 / (12.0 * E * about_x) + shear),
        "uz": E * area / h,
        "rx": E * about_x / h,
        "ry": E * about_y / h,
        "rz": G * x**3 * y / 3.0 * (1.0 - 0.63 * x / y) / h,
    }


def exported_rod(element, file, units="mm-N-tonne-s"):
    """The solid's own super-element, written for Nastran and read back; its nodes are its interfaces."""
    prs.export(element, file, units=units)
    return rod(reducer="nastran", source=str(file), units=units, interfaces={"hinge": {}, "tip": {}})


def rod(**entries):
    """The whole entry of the rods in machine.yaml."""
    return {"per": "limb", "frame": "rod_<limb>", **entries}


EXPLAINED = """
exported  the same matrices, to the digits of the file
beam      up to 1.5 % stiffer: plane sections in a wide, short bar, and a hub that is rigid. What matters is where the
          neck is clamped in the hub (in its middle, as here) and where it ends (where the bar begins)
lumped    fifteen pieces, each as stiff as a beam of the section in its middle; with fewer, the step from neck to bar
          would be lost"""


def main():
    head = prs.load_machine("head_3prs").replace({"reduction.method": "craig-bampton"})
    solid = head.parts["rod_1"]
    with TemporaryDirectory() as folder:
        ways = {"exported": exported_rod(solid, Path(folder) / "rod.op4"), "beam": beam_rod(), "lumped": lumped_rod()}
        heads = {"solid": head} | {name: head.replace({"bodies.rod": entry}) for name, entry in ways.items()}
        modes = {name: machine.modes(8).frequencies for name, machine in heads.items()}
    print("frequencies of the head / Hz with its rods as")
    print("mode" + "".join(f"{name:>12}" for name in modes) + "    differences from solid")
    for k, row in enumerate(zip(*modes.values(), strict=True), start=1):
        off = "".join(f"{value / row[0] - 1.0:+9.2%}" for value in row[1:])
        print(f"{k:4}" + "".join(f"{value:12.3f}" for value in row) + "  " + off)
    print(EXPLAINED)


if __name__ == "__main__":
    main()
