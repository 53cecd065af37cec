"""Cross-sections of beams: round, rectangular, or by their properties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from prs_model.description.quantity import Area, AreaMoment, PositiveLength, PositiveNumber, Pressure
from prs_model.description.schema import Section

from ..solid import MaterialOptions

SHEAR = (0.01, 1.0)  # G / E, along the grain of wood or the fibres of a composite as well
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class CrossSection:
    """What a beam needs to know of its section, per metre, in the axes y, z of the section [SI].

    axial EA, torsion GJ, bending EI about y and about z, shear kGA along y and along z (infinite: none);
    mass [kg/m] and its moments [kg m] about y and z; about the axis it has their sum.
    """

    axial: float
    torsion: float
    bending: tuple[float, float]
    shear: tuple[float, float]
    mass: float
    inertia: tuple[float, float]

    @property
    def radius(self) -> float:
        """The larger radius of gyration [m], from a quarter of the depth (round) to a half (two flanges)."""
        return float(np.sqrt(max(self.bending) / self.axial))


class BeamMaterial(MaterialOptions):
    """Isotropic elasticity; `G` where it is not E / 2 (1 + nu)."""

    G: Pressure | None = None

    @model_validator(mode="after")
    def _shears_as_a_solid(self) -> BeamMaterial:
        share = self.shear_modulus / float(self.E)
        if self.G is not None and not SHEAR[0] <= share <= SHEAR[1]:
            raise PydanticCustomError("G", f"found G = {share:.3g} E, which no solid has; steel's is 0.385 E")
        return self

    @property
    def shear_modulus(self) -> float:
        """G [Pa]."""
        return float(self.E) / 2.0 / (1.0 + float(self.nu)) if self.G is None else float(self.G)

    def section(
        self, area: float, moments: tuple[float, float], torsion: float, shear: tuple[float, float]
    ) -> CrossSection:
        """From area [m^2], second moments about y and z, torsion constant [m^4], shear coefficients along y and z."""
        E, G, density = float(self.E), self.shear_modulus, float(self.density)
        return CrossSection(
            axial=E * area,
            torsion=G * torsion,
            bending=(E * moments[0], E * moments[1]),
            shear=(shear[0] * G * area, shear[1] * G * area),
            mass=density * area,
            inertia=(density * moments[0], density * moments[1]),
        )


class Round(Section):
    """A bar, or a tube when it has a `bore`."""

    kind: Literal["round"]
    material: BeamMaterial
    diameter: PositiveLength
    bore: PositiveLength | None = None

    @model_validator(mode="after")
    def _has_a_wall(self) -> Round:
        if self.bore is not None and self.bore >= self.diameter:
            raise PydanticCustomError("bore", "found a bore as wide as the diameter or wider, expected a smaller one")
        return self

    def properties(self) -> CrossSection:
        """Shear: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Appl. Mech. 33, 1966."""
        outer, inner, nu = float(self.diameter), float(self.bore or 0.0), float(self.material.nu)
        moment, m = np.pi * (outer**4 - inner**4) / 64.0, (1.0 + (inner / outer) ** 2) ** 2
        shear = 6.0 * (1.0 + nu) * m / ((7.0 + 6.0 * nu) * m + (20.0 + 12.0 * nu) * (inner / outer) ** 2)
        area = np.pi * (outer**2 - inner**2) / 4.0
        return self.material.section(area, (moment, moment), 2.0 * moment, (shear, shear))


class Rectangle(Section):
    """A solid rectangle with sides along the local y and z axes."""

    kind: Literal["rectangle"]
    material: BeamMaterial
    y: PositiveLength
    z: PositiveLength

    def properties(self) -> CrossSection:
        """Cowper's shear coefficient, Saint-Venant's torsion."""
        y, z, nu = float(self.y), float(self.z), float(self.material.nu)
        shear = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
        moments = (y * z**3 / 12.0, y**3 * z / 12.0)
        return self.material.section(y * z, moments, rectangle_torsion(y, z), (shear, shear))


class Properties(Section):
    """Any section in its principal axes: moments about y and z, torsion constant, shear coefficients along y and z.

    Left out, a shear coefficient is infinite: the beam does not shear in that direction. The torsion constant of a
    section is at most its polar moment Iy + Iz, which only round ones reach, and a shear coefficient at most 1.
    """

    kind: Literal["properties"]
    material: BeamMaterial
    A: Area
    Iy: AreaMoment
    Iz: AreaMoment
    J: AreaMoment
    ky: PositiveNumber | None = None
    kz: PositiveNumber | None = None

    @model_validator(mode="after")
    def _belong_to_a_section(self) -> Properties:
        share = float(self.J) / (float(self.Iy) + float(self.Iz))
        if share > 1.0 + ROUND_OFF:
            expected = "expected at most Iy + Iz, which a round section has"
            raise PydanticCustomError("J", f"found J = {share:.4g} (Iy + Iz), {expected}")
        for name, factor in (("ky", self.ky), ("kz", self.kz)):
            if factor is not None and factor > 1.0:
                raise PydanticCustomError(name, f"found {name} = {factor:.4g}, expected at most 1, such as 5/6")
        return self

    def properties(self) -> CrossSection:
        """As given."""
        shear = tuple(np.inf if each is None else float(each) for each in (self.ky, self.kz))
        return self.material.section(
            float(self.A), (float(self.Iy), float(self.Iz)), float(self.J), (shear[0], shear[1])
        )


BeamSection = Annotated[Round | Rectangle | Properties, Field(discriminator="kind")]


def may_taper(one: BeamSection, other: BeamSection) -> bool:
    """Whether a beam can change from one section to another: same kind, material and entries."""
    return type(one) is type(other) and one.material == other.material and _given(one) == _given(other)


def tapered(one: BeamSection, other: BeamSection, share: float) -> CrossSection:
    """The section at `share` (0 .. 1) of the way from one to another, their dimensions changing linearly."""
    between = {name: (1.0 - share) * getattr(one, name) + share * getattr(other, name) for name in _given(one)}
    return one.model_copy(update=between).properties()


def _given(section: BeamSection) -> set[str]:
    """Names of the dimensions that are given."""
    dimensions = set(type(section).model_fields) - {"kind", "material"}
    return {name for name in dimensions if getattr(section, name) is not None}


def rectangle_torsion(a: float, b: float) -> float:
    """J [m^4] of a solid rectangle (Saint-Venant; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, art. 109)."""
    long, short = max(a, b), min(a, b)
    odd = np.arange(1, 100, 2)
    series = np.sum(np.tanh(odd * np.pi * long / 2.0 / short) / odd**5)
    return float(long * short**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * short / long * series))
