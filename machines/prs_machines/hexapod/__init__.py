"""Stewart platform of six UPS limbs, rigid bodies on axial springs (see README.md)."""
