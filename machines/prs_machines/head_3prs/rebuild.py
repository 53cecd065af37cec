"""Rebuild the parts of head_3prs: ``python -m prs_machines.head_3prs.rebuild [--size 1.5] [--only rod slider]``.

Each part is meshed (`parts.py`) into ``mesh/``, reduced as machine.yaml says and once more as the paper does, stored
in ``reduced/``, and its mass, centre and inertia are written into the URDF. ``mesh/`` is not shipped, ``reduced/`` is.
"""

from __future__ import annotations

import argparse
import logging
import re
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from prs_model import plugins
from prs_model.description import MachineDescription, load_description
from prs_model.description.schema import Body, ReductionDefaults
from prs_model.description.units import Units
from prs_model.errors import PrsError
from prs_model.finite_elements.mass import MassProperties
from prs_model.reduction import build_part
from prs_model.reduction.storage import whole

from .parts import PARTS

FOLDER = Path(__file__).parent
PAPER = ReductionDefaults(method="craig-bampton", coupling="rigid", tie="joint", modes=3)

logger = logging.getLogger("prs_model")


def rebuild(stems: Iterable[str], size: float = 1.0, folder: Path = FOLDER) -> None:
    """Mesh, reduce and store these parts, and write their inertia into the URDF.

    size: factor on all element lengths. Raises MissingExtraError without gmsh, PrsError when a part fails its checks.
    """
    description = load_description(folder)
    for stem in stems:
        instances = [name for name in description.bodies if description.stems[name] == stem]
        body = description.bodies[instances[0]]
        source = folder / "mesh" / f"{stem}.msh"
        _mesh(stem, source, size)
        _reduce(stem, instances[0], description)
        inertia = _mass_properties(stem, source, body)
        write_inertia(description.urdf_path, [description.bodies[name].frame for name in instances], inertia)
        logger.info("%s: %.2f kg", stem, inertia.mass)


def _mesh(stem: str, source: Path, size: float) -> None:
    start = time.perf_counter()
    mesh = PARTS[stem](size)
    mesh.write(source, stem)
    figures = stem, len(mesh.tets), mesh.points.size, time.perf_counter() - start
    logger.info("%s: %d elements, %d degrees of freedom, meshed in %.1f s", *figures)


def _reduce(stem: str, name: str, description: MachineDescription) -> None:
    """Build the part anew in a store of its own, then put it in the place of what the store held of it."""
    start = time.perf_counter()
    reduction, folder = description.file.reduction, description.folder
    store = folder / (reduction.store or "reduced")
    store.mkdir(exist_ok=True)
    with TemporaryDirectory(dir=store, prefix=".new-") as fresh:
        for each in (reduction, PAPER):
            build_part(name, description.bodies[name], each.model_copy(update={"store": fresh}), folder, stem=stem)
        made = sorted(Path(fresh).glob("*.npz"))
        if not made:
            raise PrsError(f"{stem}: the reduced part could not be stored in {store}")
        old = set(store.glob(f"{stem}-*.npz")) - {store / path.name for path in made}
        for path in made:
            path = path.replace(store / path.name)
            logger.info("%s: %s, %.2f MB", stem, path.name, path.stat().st_size / 1e6)
    for path in old:
        path.unlink()
    logger.info("%s: reduced in %.1f s", stem, time.perf_counter() - start)


def _mass_properties(stem: str, source: Path, body: Body) -> MassProperties:
    """Of the whole part, nothing clamped."""
    reducer = plugins.reducer(body.reducer)
    options = reducer.Options.model_validate(body.options)
    units = Units.parse(body.units) if body.units else None
    model = reducer.read(plugins.PartRequest(stem, source, options, units, body))
    return model.mass_properties()


def write_inertia(urdf: Path, links: Sequence[str], inertia: MassProperties) -> None:
    """Replace the <inertial> elements of these links, and nothing else in the file."""
    text = urdf.read_text(encoding="utf-8")
    for link in links:
        pattern = rf'(<link name="{re.escape(link)}">\s*)<inertial>.*?</inertial>'
        text, count = re.subn(pattern, lambda match: match[1] + _inertial(inertia), text, count=1, flags=re.DOTALL)
        if count != 1:
            raise PrsError(f"{urdf.name}: link {link} has no <inertial> element to write to")
    with whole(urdf) as file:
        file.write(text.encode())


def _inertial(inertia: MassProperties) -> str:
    scale = float(abs(inertia.inertia).max())
    centre = " ".join(_number(value, 1.0) for value in inertia.centre)
    moments = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    entries = " ".join(f'{name}="{_number(inertia.inertia[place], scale)}"' for name, place in moments.items())
    return (
        "\n      ".join(
            [
                "<inertial>",
                f'<origin xyz="{centre}"/>',
                f'<mass value="{inertia.mass:.9g}"/>',
                f"<inertia {entries}/>",
            ]
        )
        + "\n    </inertial>"
    )


def _number(value: float, scale: float) -> str:
    """Nine digits, with round-off beside `scale` written as zero."""
    return "0" if abs(value) < 1e-9 * scale else f"{value:.9g}"


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; returns its exit status."""
    parser = argparse.ArgumentParser(prog="python -m prs_machines.head_3prs.rebuild", description=__doc__)
    parser.add_argument("--size", type=float, default=1.0, help="factor on element lengths (1 is the shipped size)")
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS), help="parts to rebuild")
    chosen = parser.parse_args(arguments)
    if not 0.5 <= chosen.size <= 2.5:
        parser.error(f"--size: found {chosen.size:g}, expected a factor from 0.5 to 2.5")
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    try:
        rebuild(chosen.only, chosen.size)
    except PrsError as error:
        logger.error("%s", error)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
