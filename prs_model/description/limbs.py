"""Limbs: the instances of one member of a symmetry group."""

from __future__ import annotations

from collections.abc import Mapping

from .load import MachineDescription


def limbs_of(description: MachineDescription) -> Mapping[str, str]:
    """``limb 2`` for the bodies and joints ``rod_2``, ``S_2``: group and member; others are left out.

    An instance that was given an entry of its own stays with its limb.
    """
    return {
        name: limb
        for name, stem in description.stems.items()
        if name != stem and (limb := _limb(description, name, stem)) is not None
    }


def _limb(description: MachineDescription, name: str, stem: str) -> str | None:
    file, member = description.file, name.removeprefix(f"{stem}_")
    pers = [group[stem].per for group in (file.bodies, file.joints) if stem in group]
    for group, members in file.symmetry.items():
        if member in map(str, members) and (not pers or group in pers):
            return f"{group} {member}"
    return None
